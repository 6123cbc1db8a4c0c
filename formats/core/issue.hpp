// SPDX-License-Identifier: MIT
// What went wrong, where, and how to mend it: the only error type of the libraries.
#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace souple {

/// Stable number of every refusal. The thousands digit is the exit code of the command line
/// (1 usage, 2 I/O, 3 invalid input or asset, 4 computation failed, 5 unsupported, 7 difference).
enum class IssueCode : std::uint16_t {
#define SOUPLE_ISSUE(number, name, title, explanation, mend) name = number,
#include "formats/core/issue_codes.def"
#undef SOUPLE_ISSUE
};

enum class Severity : std::uint8_t { note, warning, error };

struct Issue {
  IssueCode code{};
  Severity severity = Severity::error;
  std::string what;   ///< this case, with its numbers
  std::string where;  ///< file, group, option, body or element; may be empty
  std::string mend;   ///< empty: the catalogue's general mend applies
};

/// One row of the catalogue behind `souple explain CODE`.
struct IssueEntry {
  IssueCode code;
  std::string_view name;         ///< e.g. "surface_not_finite"
  std::string_view title;        ///< one line
  std::string_view explanation;  ///< what it means and why it is refused
  std::string_view mend;         ///< what to do
};

/// All codes, in ascending order.
std::span<const IssueEntry> issue_catalogue();
const IssueEntry& issue_entry(IssueCode code);
/// nullptr when the text (e.g. "S3001" or "3001") names no code.
const IssueEntry* find_issue_entry(std::string_view text);
/// "S3001".
std::string issue_code_text(IssueCode code);
/// The exit code of the command line for this issue: the code's thousands digit.
int exit_code(IssueCode code);
/// One or two lines for people: "error S3001: what (where)\n  mend: …".
std::string format_issue(const Issue& issue);
/// The mend of this issue: its own, or the catalogue's.
std::string_view mend_of(const Issue& issue);

inline Issue make_issue(IssueCode code, std::string what, std::string where = {},
                        std::string mend = {}) {
  return {code, Severity::error, std::move(what), std::move(where), std::move(mend)};
}

}  // namespace souple
