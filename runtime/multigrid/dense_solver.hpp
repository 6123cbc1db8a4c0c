// SPDX-License-Identifier: MIT
#pragma once
#include "runtime/fem/block_matrix.hpp"
#include "runtime/multigrid/padded_transfer.hpp"

namespace souple {

/// Dense Cholesky factor of a small positive semi-definite block matrix in double: unknowns that depend
/// on those before them are left at 0, which is a solution as good as any. update and solve allocate
/// nothing.
class DenseSolver {
 public:
  explicit DenseSolver(Index node_count);

  /// Reads what is on and right of the diagonal. False if that is not finite.
  bool update(const BlockMatrixF& a);
  /// x = A^-1 b; the fourth entries of x become 0.
  void solve(const PaddedVector& b, PaddedVector& x);

  std::size_t bytes() const { return std::size_t(factor_.size() + y_.size()) * sizeof(double); }

 private:
  void load(const BlockMatrixF& a);
  bool factorize_panel(Eigen::Index first, Eigen::Index last);

  Eigen::MatrixXd
      factor_;  ///< lower triangle: L of A = L L^T, with the reciprocals of its diagonal or 0
  Eigen::VectorXd y_;
};

}  // namespace souple
