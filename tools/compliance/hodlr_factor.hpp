// SPDX-License-Identifier: GPL-3.0-or-later
// Whether a HODLR matrix is positive definite, and its inverse: by Woodbury's formula from the leaves
// up (Ambikasaran, Darve 2013), without forming it.
#pragma once
#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <optional>
#include <vector>

#include "tools/compliance/hodlr_product.hpp"

namespace souple {

/// The inverse of A = `matrix` + shift I. Costs about as many sums as (sum of ranks on a path)^2 times
/// the rows; memory as much as `matrix` itself.
class HodlrFactor {
 public:
  /// Nothing if A is not positive definite (to double precision). `matrix` must outlive the factor.
  static std::optional<HodlrFactor> create(const ScaledHodlr& matrix, double shift, WorkerPool& pool);

  /// x := A^-1 x, 3n x k.
  void solve(Eigen::Ref<Eigen::MatrixXd> x) const;

 private:
  // Of a block [A1, U V^T; V U^T, A2]: G1 = U^T A1^-1 U and I - G1 G2, G2 = V^T A2^-1 V.
  struct Coupling {
    Eigen::MatrixXd left_gram;
    Eigen::MatrixXd right_gram;
    Eigen::PartialPivLU<Eigen::MatrixXd> difference;
  };

  explicit HodlrFactor(const ScaledHodlr& matrix);
  bool factor_leaf(Index leaf, double shift);
  bool factor_block(int depth, Index cluster);
  // y := A_b^-1 of (diag(A1, A2) y), rows of the cluster of block `b`.
  void couple(std::size_t b, Eigen::Ref<Eigen::MatrixXd> y) const;

  const ScaledHodlr* matrix_;
  std::vector<Eigen::LLT<Eigen::MatrixXd>> leaves_;
  std::vector<ScaledHodlr::Block> solved_;  ///< A1^-1 U and A2^-1 V of every block
  std::vector<Coupling> couplings_;
};

/// The least shift >= 0, to within about `resolution` (> 0), that makes `matrix` + shift I positive
/// definite, as a factorisation has shown. Infinite if none does.
double least_positive_shift(const ScaledHodlr& matrix, double resolution, WorkerPool& pool);

}  // namespace souple
