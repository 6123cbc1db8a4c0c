// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/surface/obj_text.hpp"

#include <charconv>
#include <cmath>
#include <cstdint>
#include <vector>

#include "tools/surface/surface_format.hpp"

namespace souple {
namespace {

constexpr std::string_view blanks = " \t\v\f\r";

/// Takes the next word off the front of `line`; empty at its end.
std::string_view take_word(std::string_view& line) {
  const std::size_t start = line.find_first_not_of(blanks);
  if (start == line.npos) return line = {};
  line.remove_prefix(start);
  const std::string_view word = line.substr(0, line.find_first_of(blanks));
  line.remove_prefix(word.size());
  return word;
}

class ObjText {
 public:
  Result<std::string> reduce(std::string_view text) {
    std::string joined;  // a line continued by a backslash at its end
    while (!text.empty()) {
      const std::size_t end = text.find_first_of("\r\n");
      std::string_view line = text.substr(0, end);
      const bool is_crlf = end != text.npos && text.substr(end).starts_with("\r\n");
      text.remove_prefix(end == text.npos ? text.size() : end + (is_crlf ? 2 : 1));
      ++line_;
      if (line.ends_with('\\')) {
        joined.append(line.substr(0, line.size() - 1)).push_back(' ');
        continue;
      }
      if (!joined.empty()) line = joined.append(line);
      if (const Status taken = take(line); !taken) return taken.issue();
      joined.clear();
    }
    if (largest_index_ > vertex_count_)
      return make_issue(IssueCode::surface_bad_index,
                        "line " + std::to_string(largest_index_line_) + " names vertex " +
                            std::to_string(largest_index_) + " of " + std::to_string(vertex_count_));
    return std::move(out_);
  }

 private:
  Status take(std::string_view line) {
    if (const std::size_t comment = line.find('#'); comment != line.npos)
      line = line.substr(0, comment);
    const std::string_view keyword = take_word(line);
    if (keyword == "v") return take_vertex(line);
    if (keyword == "f" || keyword == "fo") return take_face(line);
    return {};
  }

  Issue refuse(IssueCode code, std::string_view what, std::string_view word) const {
    return make_issue(code, "line " + std::to_string(line_) + ": " + std::string(what) + " '" +
                                std::string(word.substr(0, 40)) + "'");
  }

  Status take_vertex(std::string_view line) {
    out_ += 'v';
    for (int k = 0; k < 3; ++k) {
      const std::string_view word = take_word(line);
      // from_chars knows no plus sign.
      const std::string_view digits = word.starts_with('+') ? word.substr(1) : word;
      double value = 0;
      const auto parsed = std::from_chars(digits.data(), digits.data() + digits.size(), value);
      if (parsed.ec == std::errc::result_out_of_range && is_small(digits)) {
        value = 0;
      } else if (parsed.ec == std::errc::result_out_of_range || !std::isfinite(value)) {
        return refuse(IssueCode::surface_not_finite, "coordinate", word);
      } else if (parsed.ec != std::errc{} || parsed.ptr != digits.data() + digits.size()) {
        return refuse(IssueCode::surface_malformed, "not a coordinate:", word);
      }
      out_ += ' ';
      out_ += value == 0 ? std::string_view("0") : digits;
    }
    out_ += '\n';
    ++vertex_count_;
    return {};
  }

  /// Out of range below, not above.
  static bool is_small(std::string_view digits) {
    return digits.find("e-") != digits.npos || digits.find("E-") != digits.npos;
  }

  Status take_face(std::string_view line) {
    out_ += 'f';
    for (std::string_view word = take_word(line); !word.empty(); word = take_word(line)) {
      const std::string_view digits = word.substr(0, word.find('/'));
      std::int64_t index = 0;
      const auto parsed = std::from_chars(digits.data(), digits.data() + digits.size(), index);
      if (parsed.ec != std::errc{} || parsed.ptr != digits.data() + digits.size())
        return refuse(IssueCode::surface_malformed, "not a corner of a face:", word);
      if (index < 0) index += vertex_count_ + 1;
      if (index < 1) return refuse(IssueCode::surface_bad_index, "corner", word);
      if (index > largest_index_) {
        largest_index_ = index;
        largest_index_line_ = line_;
      }
      out_ += ' ';
      out_ += std::to_string(index);
    }
    out_ += '\n';
    return {};
  }

  std::string out_;
  std::size_t line_ = 0;
  std::int64_t vertex_count_ = 0;
  std::int64_t largest_index_ = 0;
  std::size_t largest_index_line_ = 0;
};

}  // namespace

Result<std::string> plain_obj_text(std::string_view text) {
  return ObjText().reduce(without_byte_order_mark(text));
}

}  // namespace souple
