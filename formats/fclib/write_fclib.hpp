// SPDX-License-Identifier: MIT
#pragma once
#include <cstddef>
#include <filesystem>
#include <vector>

#include "formats/fclib/fclib_problem.hpp"

namespace souple {

/// Writes the local layout, W in compressed columns without the zeros of its blocks, for any program
/// that reads FCLIB: to a temporary file, then renamed. Texts are cut at 64 KiB. Issues:
/// contact_problem_invalid, contact_problem_too_large, io_cannot_write, io_out_of_memory.
Status write_fclib(const FclibProblem& problem, const std::filesystem::path& file);
Result<std::vector<std::byte>> write_fclib_memory(const FclibProblem& problem);

}  // namespace souple
