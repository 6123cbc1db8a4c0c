// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/cli/exit_codes.hpp"

namespace souple {

std::string exit_codes_text() {
  std::string text = "Exit codes:\n";
  for (const auto& entry : exit_code_table)
    text +=
        "  " + std::to_string(static_cast<int>(entry.code)) + "  " + std::string(entry.meaning) + "\n";
  return text;
}

}  // namespace souple
