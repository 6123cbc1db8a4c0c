// SPDX-License-Identifier: MIT
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "formats/core/contact_problem.hpp"

namespace souple::fclib {

/// A sparse matrix as FCLIB stores it, not checked.
struct SparseMatrix {
  std::int64_t nzmax = 0, rows = 0, columns = 0, nz = 0;
  std::vector<std::int64_t> p, i;
  std::vector<double> x;
};

/// Blocks of a square matrix of 3x3 blocks; entries of one place add up. Checks everything. `where`
/// names it in issues: contact_file_damaged, contact_problem_invalid, contact_problem_too_large.
Result<BlockColumns> blocks_of(const SparseMatrix& matrix, const std::string& where);

/// In compressed columns, without the zeros of the blocks.
SparseMatrix compressed_columns_of(const BlockColumns& blocks);

}  // namespace souple::fclib
