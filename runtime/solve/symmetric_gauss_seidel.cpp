// SPDX-License-Identifier: MIT
#include "runtime/solve/symmetric_gauss_seidel.hpp"

namespace souple {

bool SymmetricGaussSeidel::update(const StepSystem& system) {
  a_ = system.tangent;
  bool is_finite = true;
  for (Index row = 0; row < a_->pattern->node_count(); ++row) {
    Mat3& inverse = inverse_[std::size_t(row)];
    inverse = Mat3(a_->block(a_->pattern->diagonal[std::size_t(row)])).inverse();
    is_finite = is_finite && inverse.allFinite();
  }
  return is_finite;
}

void SymmetricGaussSeidel::apply(const Eigen::VectorXd& r, Eigen::VectorXd& z) {
  const BlockPattern& pattern = *a_->pattern;
  const Index rows = pattern.node_count();
  for (Index row = 0; row < rows; ++row) {  // (D + L) y = r
    Vec3 sum = node_entry(r, row);
    for (Index b = pattern.row_begin[row]; b < pattern.diagonal[row]; ++b)
      sum.noalias() -= a_->block(b) * node_entry(z, pattern.column[b]);
    node_entry(z, row).noalias() = inverse_[row] * sum;
  }
  for (Index row = rows - 1; row >= 0; --row) {  // (D + L)^T z = D y
    Vec3 sum = Vec3::Zero();
    for (Index b = pattern.diagonal[row] + 1; b < pattern.row_begin[row + 1]; ++b)
      sum.noalias() += a_->block(b) * node_entry(z, pattern.column[b]);
    node_entry(z, row).noalias() -= inverse_[row] * sum;
  }
}

}  // namespace souple
