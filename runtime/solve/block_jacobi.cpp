// SPDX-License-Identifier: MIT
#include "runtime/solve/block_jacobi.hpp"

namespace souple {

bool BlockJacobi::update(const StepSystem& system) {
  const BlockMatrix& a = *system.tangent;
  bool is_finite = true;
  for (Index row = 0; row < a.pattern->node_count(); ++row) {
    Mat3& inverse = inverse_[std::size_t(row)];
    inverse = Mat3(a.block(a.pattern->diagonal[std::size_t(row)])).inverse();
    is_finite = is_finite && inverse.allFinite();
  }
  work_units_ = double(inverse_.size()) / double(a.pattern->block_count());
  return is_finite;
}

void BlockJacobi::apply(const Eigen::VectorXd& r, Eigen::VectorXd& z) {
  for (std::size_t node = 0; node < inverse_.size(); ++node)
    node_entry(z, Index(node)).noalias() = inverse_[node] * node_entry(r, Index(node));
}

}  // namespace souple
