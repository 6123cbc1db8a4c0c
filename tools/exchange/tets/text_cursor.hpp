// SPDX-License-Identifier: GPL-3.0-or-later
// Takes words, numbers and raw bytes from the front of a file's content. The first thing wrong is kept,
// with its line; from then on everything taken is empty or zero.
#pragma once
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "formats/core/result.hpp"

namespace souple {

class TextCursor {
 public:
  struct Syntax {
    bool hash_comments = false;  ///< '#' to the end of the line is skipped
    bool comma_is_blank = false;
  };

  explicit TextCursor(std::string_view text) : TextCursor(text, {}) {}
  TextCursor(std::string_view text, Syntax syntax) : text_(text), syntax_(syntax) {}

  bool ok() const { return !issue_.has_value(); }
  const Issue& issue() const { return *issue_; }
  /// tet_file_malformed at this place, unless something was wrong before.
  void fail(const std::string& what);
  void refuse(const std::string& what);  ///< the same, tet_file_unsupported

  /// Only blanks and comments are left, or something was wrong.
  bool at_end();
  std::size_t left() const { return text_.size() - at_; }
  std::size_t position() const { return at_; }

  std::string_view word();             ///< fails at the end
  std::string_view peek();             ///< the next word without taking it; empty at the end
  bool expect(std::string_view word);  ///< takes the next word; fails unless it is this one
  double number();                     ///< finite
  std::int64_t integer();

  /// A count of things that take at least `least_bytes` each, of which no more than `most` may be
  /// there: checked against the bytes that are left before anybody allocates.
  std::size_t count(std::size_t least_bytes, std::size_t most);
  std::size_t checked_count(std::int64_t value, std::size_t least_bytes, std::size_t most);

  std::string_view rest_of_line();  ///< without the line's end, which is taken
  void end_line();                  ///< takes blanks and one line end; fails at anything else
  std::string_view take(std::uint64_t bytes);
  /// Goes behind the next occurrence of `text`; fails if there is none.
  void skip_past(std::string_view text);

 private:
  void skip_blanks();
  bool is_blank(char c) const {
    return c == ' ' || (c >= '\t' && c <= '\r') || (c == ',' && syntax_.comma_is_blank);
  }
  void stop(IssueCode code, const std::string& what);

  std::string_view text_;
  Syntax syntax_;
  std::size_t at_ = 0;
  std::optional<Issue> issue_;
};

/// For messages: at most 40 characters, printable.
std::string quoted(std::string_view word);
/// ASCII only.
std::string lower_case(std::string_view text);

}  // namespace souple
