// SPDX-License-Identifier: GPL-3.0-or-later
// Where benchmarks find data, and how they end when they cannot go on.
#pragma once
#include <filesystem>
#include <utility>

#include "formats/core/result.hpp"

namespace souple::bench {

/// SOUPLE_DATA_DIR, or the default beside the checkout.
std::filesystem::path data_folder();

/// Ends the program with the issue on stderr.
[[noreturn]] void exit_with(const Issue& issue);

/// The value, or the end of the program with the issue on stderr.
template <class T>
T value_or_exit(Result<T> result) {
  if (!result) exit_with(result.issue());
  return std::move(*result);
}

}  // namespace souple::bench
