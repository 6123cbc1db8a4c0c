// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/bench/bench_data.hpp"

#include <cstdio>
#include <cstdlib>

namespace souple::bench {

std::filesystem::path data_folder() {
  const char* folder = std::getenv("SOUPLE_DATA_DIR");
  return folder ? folder : SOUPLE_DEFAULT_DATA_DIR;
}

void exit_with(const Issue& issue) {
  std::fprintf(stderr, "%s\n", format_issue(issue).c_str());
  std::exit(exit_code(issue.code));
}

}  // namespace souple::bench
