// SPDX-License-Identifier: GPL-3.0-or-later
// The one table of exit codes: what main returns, what --help prints and what the schemas name.
#pragma once
#include <array>
#include <string>
#include <string_view>

#include "formats/core/issue.hpp"

namespace souple {

enum class ExitCode : int {
  ok = 0,
  usage = 1,
  io = 2,
  invalid = 3,
  computation = 4,
  unsupported = 5,
  difference = 7,
};

struct ExitCodeEntry {
  ExitCode code;
  std::string_view meaning;
};

inline constexpr std::array<ExitCodeEntry, 7> exit_code_table{{
    {ExitCode::ok, "done"},
    {ExitCode::usage, "usage: an option, a recipe or a scene cannot be understood"},
    {ExitCode::io, "I/O: a file is missing, unreadable or cannot be written"},
    {ExitCode::invalid, "invalid input or asset"},
    {ExitCode::computation, "a computation failed"},
    {ExitCode::unsupported, "not supported by this version"},
    {ExitCode::difference, "a difference was found"},
}};

/// The thousands digit of the issue's code.
constexpr ExitCode exit_code_of(IssueCode code) {
  return static_cast<ExitCode>(static_cast<int>(code) / 1000);
}

constexpr bool every_issue_has_an_exit_code() {
  constexpr int numbers[] = {
#define SOUPLE_ISSUE(number, name, title, explanation, mend) number,
#include "formats/core/issue_codes.def"
#undef SOUPLE_ISSUE
  };
  for (const int number : numbers) {
    bool found = false;
    for (const auto& entry : exit_code_table)
      found = found || (entry.code != ExitCode::ok && static_cast<int>(entry.code) == number / 1000);
    if (!found) return false;
  }
  return true;
}
static_assert(every_issue_has_an_exit_code());

/// "Exit codes:" and a line each, for --help.
std::string exit_codes_text();

}  // namespace souple
