// SPDX-License-Identifier: MIT
#pragma once
#include <vector>

#include "runtime/fem/block_matrix.hpp"
#include "runtime/multigrid/padded_transfer.hpp"

namespace souple {

/// Sweeps of block Gauss-Seidel in single precision with A = U^T + D + U. They read U once a sweep and
/// nothing else of A but D^-1: a block that has been gathered from (row i takes A_ij x_j) is scattered
/// from at once (row j takes A_ij^T x_i), while it is in the cache. So a sweep that also leaves the
/// residual costs half a product with A. In the order of the nodes; the same bits on every run.
class GaussSeidel {
 public:
  explicit GaussSeidel(Index node_count);

  /// Inverts the diagonal blocks. False if one is not positive definite.
  bool update(const BlockMatrixF& a);
  /// x = (D + U)^-1 b and residual = b - A x: the sweep from x = 0, from the last node to the first.
  void forward(const BlockMatrixF& a, const PaddedVector& b, PaddedVector& x,
               PaddedVector& residual) const;
  /// The sweep from x, from the first node to the last. `work` is overwritten.
  void backward(const BlockMatrixF& a, const PaddedVector& b, PaddedVector& x,
                PaddedVector& work) const;

  /// y -= A x, in half the reads, too.
  static void subtract_product(const BlockMatrixF& a, const PaddedVector& x, PaddedVector& y);

  std::size_t bytes() const { return inverse_.size() * sizeof(float); }

 private:
  std::vector<float> inverse_;  ///< of every diagonal block, three padded columns
};

}  // namespace souple
