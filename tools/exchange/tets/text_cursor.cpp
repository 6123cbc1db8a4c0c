// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/exchange/tets/text_cursor.hpp"

#include <algorithm>

#include "tools/exchange/numbers.hpp"

namespace souple {

void TextCursor::stop(IssueCode code, const std::string& what) {
  if (issue_) return;
  const auto line = 1 + std::ranges::count(text_.substr(0, at_), '\n');
  issue_ = make_issue(code, "line " + std::to_string(line) + ": " + what);
}

void TextCursor::fail(const std::string& what) { stop(IssueCode::tet_file_malformed, what); }
void TextCursor::refuse(const std::string& what) { stop(IssueCode::tet_file_unsupported, what); }

void TextCursor::skip_blanks() {
  while (at_ < text_.size()) {
    if (syntax_.hash_comments && text_[at_] == '#')
      at_ = std::min(text_.find('\n', at_), text_.size());
    else if (is_blank(text_[at_]))
      ++at_;
    else
      return;
  }
}

bool TextCursor::at_end() {
  skip_blanks();
  return !ok() || at_ == text_.size();
}

std::string_view TextCursor::peek() {
  skip_blanks();
  if (!ok()) return {};
  std::size_t end = at_;
  while (end < text_.size() && !is_blank(text_[end])) ++end;
  return text_.substr(at_, end - at_);
}

std::string_view TextCursor::word() {
  const std::string_view found = peek();
  if (found.empty()) fail("the file ends too early");
  at_ += found.size();
  return found;
}

bool TextCursor::expect(std::string_view wanted) {
  const std::string_view found = peek();
  if (found != wanted) fail("found " + quoted(found) + " instead of " + std::string(wanted));
  if (ok()) at_ += found.size();
  return ok();
}

double TextCursor::number() {
  const std::string_view found = peek();
  const auto value = parse_number(found);
  if (!value)
    fail(found.empty() ? "the file ends too early" : quoted(found) + " is not a finite number");
  if (!ok()) return 0;
  at_ += found.size();
  return *value;
}

std::int64_t TextCursor::integer() {
  const std::string_view found = peek();
  const auto value = parse_integer(found);
  if (!value) fail(found.empty() ? "the file ends too early" : quoted(found) + " is not an integer");
  if (!ok()) return 0;
  at_ += found.size();
  return *value;
}

std::size_t TextCursor::count(std::size_t least_bytes, std::size_t most) {
  return checked_count(integer(), least_bytes, most);
}

std::size_t TextCursor::checked_count(std::int64_t value, std::size_t least_bytes, std::size_t most) {
  if (!ok()) return 0;
  if (value < 0) {
    fail("the count " + std::to_string(value) + " is negative");
  } else if (static_cast<std::uint64_t>(value) > most) {
    fail("the count " + std::to_string(value) + " is beyond the limit of " + std::to_string(most));
  } else if (static_cast<std::uint64_t>(value) * least_bytes > left() + 1) {  // the last separator
    fail("the count " + std::to_string(value) + " is more than the " + std::to_string(left()) +
         " bytes left can hold");
  }
  return ok() ? static_cast<std::size_t>(value) : 0;
}

std::string_view TextCursor::rest_of_line() {
  if (!ok()) return {};
  const std::size_t end = std::min(text_.find('\n', at_), text_.size());
  std::string_view line = text_.substr(at_, end - at_);
  at_ = std::min(end + 1, text_.size());
  if (line.ends_with('\r')) line.remove_suffix(1);
  return line;
}

void TextCursor::end_line() {
  while (at_ < text_.size() && (text_[at_] == ' ' || text_[at_] == '\t')) ++at_;
  if (at_ < text_.size() && text_[at_] == '\r') ++at_;
  if (at_ == text_.size() || text_[at_] != '\n')
    fail("a line should end here");
  else
    ++at_;
}

std::string_view TextCursor::take(std::uint64_t bytes) {
  if (bytes > left()) fail("the data ends too early");
  if (!ok()) return {};
  const std::string_view taken = text_.substr(at_, bytes);
  at_ += taken.size();
  return taken;
}

void TextCursor::skip_past(std::string_view text) {
  const std::size_t found = text_.find(text, at_);
  if (found == text_.npos)
    fail("the end " + std::string(text) + " is missing");
  else
    at_ = found + text.size();
}

std::string quoted(std::string_view word) {
  std::string text(word.substr(0, 40));
  std::ranges::replace_if(
      text, [](unsigned char c) { return c < 32 || c > 126; }, '?');
  return "\"" + text + (word.size() > 40 ? "…\"" : "\"");
}

std::string lower_case(std::string_view text) {
  std::string lower(text);
  for (char& c : lower)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return lower;
}

}  // namespace souple
