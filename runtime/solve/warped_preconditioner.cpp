// SPDX-License-Identifier: MIT
#include "runtime/solve/warped_preconditioner.hpp"

namespace souple {

WarpedPreconditioner::WarpedPreconditioner(std::unique_ptr<Preconditioner> rest, Index node_count)
    : rest_(std::move(rest)),
      turned_(3 * Eigen::Index{node_count}),
      answer_(3 * Eigen::Index{node_count}) {}

bool WarpedPreconditioner::update(const StepSystem& system) {
  rotations_ = system.node_rotations;
  return 3 * Eigen::Index(rotations_.size()) == turned_.size();
}

void WarpedPreconditioner::apply(const Eigen::VectorXd& r, Eigen::VectorXd& z) {
  for (std::size_t node = 0; node < rotations_.size(); ++node)
    node_entry(turned_, Index(node)).noalias() =
        rotations_[node].transpose() * node_entry(r, Index(node));
  rest_->apply(turned_, answer_);
  for (std::size_t node = 0; node < rotations_.size(); ++node)
    node_entry(z, Index(node)).noalias() = rotations_[node] * node_entry(answer_, Index(node));
}

std::size_t WarpedPreconditioner::bytes() const {
  return rest_->bytes() + 2 * std::size_t(turned_.size()) * sizeof(double);
}

}  // namespace souple
