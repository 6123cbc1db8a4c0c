// SPDX-License-Identifier: MIT
#pragma once
#include <vector>

#include "runtime/solve/preconditioner.hpp"

namespace souple {

/// P = (D+L) D^-1 (D+L)^T of 3x3 blocks (METHOD 3), in double. Where it is all that is used, a sweep
/// in each direction reads A once.
class SymmetricGaussSeidel final : public Preconditioner {
 public:
  explicit SymmetricGaussSeidel(Index node_count) : inverse_(static_cast<std::size_t>(node_count)) {}

  bool update(const StepSystem& system) override;
  void apply(const Eigen::VectorXd& r, Eigen::VectorXd& z) override;
  double work_units() const override { return 1; }
  std::size_t bytes() const override { return inverse_.size() * sizeof(Mat3); }

 private:
  const BlockMatrix* a_ = nullptr;
  std::vector<Mat3> inverse_;  ///< of the diagonal blocks
};

}  // namespace souple
