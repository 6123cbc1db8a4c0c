// SPDX-License-Identifier: MIT
#pragma once
#include <memory>
#include <span>

#include "runtime/solve/preconditioner.hpp"

namespace souple {

/// R A0^-1 R^T with R = blockdiag(node rotations): the nodal corotational operator (METHOD 4.1), good
/// at any rotation where A0^-1 alone is good at none.
class WarpedPreconditioner final : public Preconditioner {
 public:
  /// `rest` applies A0^-1, or what resembles it. It is never updated here: A0 does not change.
  WarpedPreconditioner(std::unique_ptr<Preconditioner> rest, Index node_count);

  bool update(const StepSystem& system) override;
  void apply(const Eigen::VectorXd& r, Eigen::VectorXd& z) override;
  double work_units() const override { return rest_->work_units(); }
  std::size_t bytes() const override;

 private:
  std::unique_ptr<Preconditioner> rest_;
  std::span<const Mat3> rotations_;
  Eigen::VectorXd turned_, answer_;
};

}  // namespace souple
