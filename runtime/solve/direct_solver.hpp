// SPDX-License-Identifier: MIT
#pragma once
#include <span>

#include "runtime/fem/corotational_model.hpp"
#include "runtime/fem/sparse_factor.hpp"
#include "runtime/solve/preconditioner.hpp"

namespace souple {

/// z = A^-1 r by a Cholesky factor of the present A on the nodes that move.
class DirectSolver final : public Preconditioner {
 public:
  DirectSolver(const CorotationalModel& model, std::span<const Index> free_nodes);

  bool update(const StepSystem& system) override;
  void apply(const Eigen::VectorXd& r, Eigen::VectorXd& z) override;
  /// Two readings of the factor; factorising costs far more and is done once a step.
  double work_units() const override { return work_units_; }
  std::size_t bytes() const override;
  const SparseFactor* factor() const override { return &factor_; }

 private:
  SparseFactor factor_;
  std::vector<Index> free_nodes_;
  Eigen::VectorXd x_, work_;
  double work_units_ = 0;
};

}  // namespace souple
