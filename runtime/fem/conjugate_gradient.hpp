// SPDX-License-Identifier: MIT
#pragma once
#include "runtime/fem/block_matrix.hpp"

namespace souple {

struct ConjugateGradientReport {
  int iterations = 0;
  double relative_residual = 0;  ///< ||b - A x|| / reference
  bool converged = false;
};

/// Conjugate gradients preconditioned by symmetric block Gauss-Seidel, P = (D+L) D^-1 (D+L)^T
/// (METHOD 3). Owns its work vectors: solve allocates nothing.
class ConjugateGradient {
 public:
  explicit ConjugateGradient(Index node_count);

  /// Solves A x = b from the x given; stops at ||b - A x|| <= tolerance * reference.
  /// A symmetric positive definite.
  ConjugateGradientReport solve(const BlockMatrix& a, const Eigen::VectorXd& b, double tolerance,
                                double reference, int max_iterations, Eigen::VectorXd& x);
  std::size_t bytes() const;

 private:
  void invert_diagonal(const BlockMatrix& a);
  void precondition(const BlockMatrix& a, const Eigen::VectorXd& r, Eigen::VectorXd& z) const;

  std::vector<Mat3> inverse_diagonal_;
  Eigen::VectorXd residual_, direction_, product_, preconditioned_;
};

}  // namespace souple
