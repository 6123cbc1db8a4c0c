// SPDX-License-Identifier: MIT
#include "runtime/solve/direct_solver.hpp"

namespace souple {

DirectSolver::DirectSolver(const CorotationalModel& model, std::span<const Index> free_nodes)
    : free_nodes_(free_nodes.begin(), free_nodes.end()) {
  factor_.analyze(model.pattern(), model.rest_positions(), free_nodes);
  x_.setZero(factor_.size());
  work_.setZero(factor_.size());
  work_units_ =
      2 * double(factor_.factor_bytes()) / double(9 * sizeof(double) * model.pattern().block_count());
}

bool DirectSolver::update(const StepSystem& system) { return factor_.factorize(*system.tangent); }

void DirectSolver::apply(const Eigen::VectorXd& r, Eigen::VectorXd& z) {
  z = r;  // fixed nodes have identity rows
  for (std::size_t k = 0; k < free_nodes_.size(); ++k)
    node_entry(x_, Index(k)) = node_entry(r, free_nodes_[k]);
  factor_.solve(x_, work_);
  for (std::size_t k = 0; k < free_nodes_.size(); ++k)
    node_entry(z, free_nodes_[k]) = node_entry(x_, Index(k));
}

std::size_t DirectSolver::bytes() const {
  return factor_.bytes() + free_nodes_.size() * sizeof(Index) +
         std::size_t(x_.size() + work_.size()) * sizeof(double);
}

}  // namespace souple
