// SPDX-License-Identifier: MIT
#pragma once
#include <vector>

#include "runtime/solve/preconditioner.hpp"

namespace souple {

/// The inverted diagonal blocks.
class BlockJacobi final : public Preconditioner {
 public:
  explicit BlockJacobi(Index node_count) : inverse_(static_cast<std::size_t>(node_count)) {}

  bool update(const StepSystem& system) override;
  void apply(const Eigen::VectorXd& r, Eigen::VectorXd& z) override;
  double work_units() const override { return work_units_; }
  std::size_t bytes() const override { return inverse_.size() * sizeof(Mat3); }

 private:
  std::vector<Mat3> inverse_;
  double work_units_ = 0;
};

}  // namespace souple
