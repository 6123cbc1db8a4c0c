// SPDX-License-Identifier: MIT
#pragma once
#include <span>
#include <vector>

#include "runtime/fem/linear_algebra.hpp"

namespace souple {

/// Anderson's acceleration of a fixed-point iteration x <- g(x) (Anderson 1965; Walker and Ni 2011,
/// type II): the next x is the combination of the last iterates whose residual g(x) - x is least.
/// Nothing is allocated once its memory has grown.
class AndersonMixer {
 public:
  static constexpr int history = 20;

  void restart();  ///< forgets the iterates
  /// `before` is x; `after` is g(x), and is replaced by the next x.
  void mix(std::span<const double> before, std::span<double> after);

 private:
  void remember(std::span<const double> residual, std::span<const double> after);
  double product(int a, std::span<const double> residual) const;

  int count_ = 0, next_ = 0;  // differences that are kept, and the place of the next
  bool has_last_ = false;
  std::vector<double> last_after_, last_residual_, residual_;
  std::vector<double> after_change_[history], residual_change_[history];
  Eigen::Matrix<double, history, history> gram_;  ///< of the residual changes
};

}  // namespace souple
