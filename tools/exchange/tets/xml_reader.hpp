// SPDX-License-Identifier: GPL-3.0-or-later
// As much of XML as VTK writes: elements, attributes, text, comments. A general parser would not do:
// appended raw data make a file that is not XML, and document types are an attack that nobody needs.
#pragma once
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "formats/core/result.hpp"

namespace souple {

enum class XmlEvent : std::uint8_t { open, close, text, end };

/// Pulls one event after another. The first thing wrong is kept; from then on the event is `end`.
class XmlReader {
 public:
  explicit XmlReader(std::string_view text) : text_(text) {}

  XmlEvent next();
  bool ok() const { return !issue_.has_value(); }
  const Issue& issue() const { return *issue_; }
  void fail(const std::string& what);  ///< tet_file_malformed at this place

  /// Of the last event. Names and text are views into the file; text is as it stands there.
  std::string_view name() const { return name_; }
  std::string_view text() const { return content_; }
  std::optional<std::string_view> attribute(std::string_view name) const;
  /// Names of the elements that are open, the outermost first; at `close` without the one that closed.
  const std::vector<std::string_view>& open_elements() const { return open_; }
  /// All behind the last event.
  std::string_view rest() const { return text_.substr(at_); }

 private:
  XmlEvent read_tag();
  XmlEvent read_closing();
  bool skip_markup();
  void read_attributes();
  bool read_value(std::string& value);
  std::string_view take_name();
  void skip_blanks();
  bool starts_with(std::string_view beginning) const { return rest().starts_with(beginning); }

  std::string_view text_;
  std::size_t at_ = 0;
  std::vector<std::string_view> open_;
  std::string_view name_, content_;
  std::vector<std::pair<std::string_view, std::string>> attributes_;
  bool closes_at_once_ = false;  ///< <a/>: its close is the next event
  std::optional<Issue> issue_;
};

}  // namespace souple
