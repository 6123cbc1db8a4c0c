// SPDX-License-Identifier: MIT
#pragma once
#include <cstddef>
#include <vector>

#include "runtime/fem/linear_algebra.hpp"

namespace souple {

/// Where the non-zero 3x3 blocks of a symmetric matrix over nodes stand; columns ascend in each row and
/// the diagonal is always present.
struct BlockPattern {
  std::vector<Index> row_begin;  ///< node_count + 1
  std::vector<Index> column;     ///< node of every block
  std::vector<Index> diagonal;   ///< position of the diagonal block of every row

  Index node_count() const { return static_cast<Index>(diagonal.size()); }
  std::size_t block_count() const { return column.size(); }
  /// Position of block (row, col), which must be in the pattern.
  Index find(Index row, Index col) const;
};

/// Nodes couple if a tet holds both.
BlockPattern build_block_pattern(Index node_count, const std::vector<Tet>& tets);

/// Values on a pattern: block b is row-major at values[9 b]. Both triangles are stored.
template <class Scalar>
struct BasicBlockMatrix {
  const BlockPattern* pattern = nullptr;
  std::vector<Scalar> values;

  explicit BasicBlockMatrix(const BlockPattern& p) : pattern(&p), values(9 * p.block_count()) {}

  using Block = Eigen::Matrix<Scalar, 3, 3, Eigen::RowMajor>;
  auto block(Index position) { return Eigen::Map<Block>(values.data() + 9 * std::size_t(position)); }
  auto block(Index position) const {
    return Eigen::Map<const Block>(values.data() + 9 * std::size_t(position));
  }
};

using BlockMatrix = BasicBlockMatrix<double>;
using BlockMatrixF = BasicBlockMatrix<float>;

/// y = A x, x and y of length 3n. Where a block is not finite, neither is what its row gives.
void multiply(const BlockMatrix& a, const Eigen::VectorXd& x, Eigen::VectorXd& y);
void multiply(const BlockMatrixF& a, const Eigen::VectorXf& x, Eigen::VectorXf& y);
/// Some rows of it only. Rows are independent and give the same bits in any range.
void multiply_rows(const BlockMatrix& a, const double* x, IndexRange rows, double* y);
void multiply_rows(const BlockMatrixF& a, const float* x, IndexRange rows, float* y);

}  // namespace souple
