// SPDX-License-Identifier: MIT
#include "runtime/fem/conjugate_gradient.hpp"

namespace souple {

ConjugateGradient::ConjugateGradient(Index node_count)
    : inverse_diagonal_(node_count),
      residual_(3 * Eigen::Index{node_count}),
      direction_(residual_.size()),
      product_(residual_.size()),
      preconditioned_(residual_.size()) {}

std::size_t ConjugateGradient::bytes() const {
  return inverse_diagonal_.size() * sizeof(Mat3) + 4 * std::size_t(residual_.size()) * sizeof(double);
}

void ConjugateGradient::invert_diagonal(const BlockMatrix& a) {
  for (Index row = 0; row < a.pattern->node_count(); ++row)
    inverse_diagonal_[row] = Mat3(a.block(a.pattern->diagonal[row])).inverse();
}

void ConjugateGradient::precondition(const BlockMatrix& a, const Eigen::VectorXd& r,
                                     Eigen::VectorXd& z) const {
  const BlockPattern& pattern = *a.pattern;
  const Index rows = pattern.node_count();
  for (Index row = 0; row < rows; ++row) {  // (D + L) y = r
    Vec3 sum = node_entry(r, row);
    for (Index b = pattern.row_begin[row]; b < pattern.diagonal[row]; ++b)
      sum.noalias() -= a.block(b) * node_entry(z, pattern.column[b]);
    node_entry(z, row).noalias() = inverse_diagonal_[row] * sum;
  }
  for (Index row = rows - 1; row >= 0; --row) {  // (D + L)^T z = D y
    Vec3 sum = Vec3::Zero();
    for (Index b = pattern.diagonal[row] + 1; b < pattern.row_begin[row + 1]; ++b)
      sum.noalias() += a.block(b) * node_entry(z, pattern.column[b]);
    node_entry(z, row).noalias() -= inverse_diagonal_[row] * sum;
  }
}

ConjugateGradientReport ConjugateGradient::solve(const BlockMatrix& a, const Eigen::VectorXd& b,
                                                 double tolerance, double reference, int max_iterations,
                                                 Eigen::VectorXd& x) {
  ConjugateGradientReport report;
  const double target = tolerance * reference;
  multiply(a, x, product_);
  residual_ = b - product_;
  double norm = residual_.norm();
  if (norm > target) invert_diagonal(a);
  double previous = 0;
  while (norm > target && report.iterations < max_iterations) {
    precondition(a, residual_, preconditioned_);
    const double rho = residual_.dot(preconditioned_);
    if (report.iterations == 0)
      direction_ = preconditioned_;
    else
      direction_ = preconditioned_ + (rho / previous) * direction_;
    previous = rho;
    multiply(a, direction_, product_);
    const double curvature = direction_.dot(product_);
    if (!(curvature > 0)) break;  // round-off has been reached, or A is not positive definite
    const double step = rho / curvature;
    x += step * direction_;
    residual_ -= step * product_;
    norm = residual_.norm();
    ++report.iterations;
  }
  report.relative_residual = reference > 0 ? norm / reference : norm;
  report.converged = norm <= target;
  return report;
}

}  // namespace souple
