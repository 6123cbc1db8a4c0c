// SPDX-License-Identifier: MIT
#pragma once
#include <cstddef>
#include <filesystem>
#include <span>
#include <string>

#include "formats/fclib/fclib_problem.hpp"

namespace souple {

/// Reads a local problem in three dimensions, its matrix in any of the three storages. Everything is
/// checked; guesses and solutions of a wrong length or with values that are not usable are left out.
/// HDF5 itself is not proof against every damage of a file that has no checksums, as those of FCLIB:
/// read files of unknown origin in a process of their own.
/// Issues: io_file_missing, io_cannot_read, io_out_of_memory, contact_file_damaged,
/// contact_problem_invalid, contact_problem_too_large; unsupported_feature for problems in two
/// dimensions, global and rolling ones, and those with equality constraints.
Result<FclibProblem> read_fclib(const std::filesystem::path& file);
/// `where` names the bytes in issues.
Result<FclibProblem> read_fclib_memory(std::span<const std::byte> bytes, const std::string& where);

}  // namespace souple
