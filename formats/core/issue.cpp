// SPDX-License-Identifier: MIT
#include "formats/core/issue.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <charconv>

namespace souple {
namespace {

constexpr auto catalogue = std::to_array<IssueEntry>({
#define SOUPLE_ISSUE(number, name, title, explanation, mend) \
  {IssueCode::name, #name, title, explanation, mend},
#include "formats/core/issue_codes.def"
#undef SOUPLE_ISSUE
});

static_assert(std::ranges::adjacent_find(catalogue, std::ranges::greater_equal{}, &IssueEntry::code) ==
                  catalogue.end(),
              "codes ascend and none stands twice");

}  // namespace

std::span<const IssueEntry> issue_catalogue() { return catalogue; }

const IssueEntry& issue_entry(IssueCode code) {
  const auto found = std::ranges::lower_bound(catalogue, code, {}, &IssueEntry::code);
  assert(found != catalogue.end() && found->code == code);
  return *found;
}

const IssueEntry* find_issue_entry(std::string_view text) {
  if (!text.empty() && (text.front() == 'S' || text.front() == 's')) text.remove_prefix(1);
  std::uint16_t number = 0;
  const auto parsed = std::from_chars(text.data(), text.data() + text.size(), number);
  if (parsed.ec != std::errc{} || parsed.ptr != text.data() + text.size()) return nullptr;
  const auto code = static_cast<IssueCode>(number);
  const auto found = std::ranges::lower_bound(catalogue, code, {}, &IssueEntry::code);
  return found != catalogue.end() && found->code == code ? &*found : nullptr;
}

std::string issue_code_text(IssueCode code) {
  return "S" + std::to_string(static_cast<unsigned>(code));
}

int exit_code(IssueCode code) { return static_cast<int>(code) / 1000; }

std::string_view mend_of(const Issue& issue) {
  return issue.mend.empty() ? issue_entry(issue.code).mend : std::string_view(issue.mend);
}

std::string format_issue(const Issue& issue) {
  static constexpr std::array<std::string_view, 3> words{"note", "warning", "error"};
  std::string text(words[static_cast<std::size_t>(issue.severity)]);
  text += " " + issue_code_text(issue.code) + ": " + issue.what;
  if (!issue.where.empty()) text += " (" + issue.where + ")";
  text += "\n  mend: ";
  text += mend_of(issue);
  return text;
}

}  // namespace souple
