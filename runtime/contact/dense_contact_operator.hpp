// SPDX-License-Identifier: MIT
#pragma once
#include <span>
#include <vector>

#include "runtime/contact/padded_columns.hpp"

namespace souple {

/// A dense W in single precision as a RefreshableOperator: u = base + increment, the base in double,
/// what the forces changed since it was made in single. With W as it is stored, its own rounding
/// (6e-8) apart, any residual can be reached by refreshing. Memory is kept between solves.
class DenseContactOperator {
 public:
  /// W (3m x 3m, column-major) rounded, and q (3m).
  void assign(std::span<const double> delassus, std::span<const double> free_gap);
  /// W = 0 and q; blocks are then added to columns().
  void reset(std::span<const double> free_gap);
  /// q with which W force + q is this gap (3m); both are then current.
  void anchor(std::span<const double> force, std::span<const double> gap);
  PaddedColumns& columns() { return columns_; }
  const PaddedColumns& columns() const { return columns_; }

  std::size_t size() const { return columns_.width() / 3; }
  Mat3 diagonal_block(std::size_t i) const { return columns_.block(i, i); }
  void start(std::span<const double> force) { refresh(force); }
  void refresh(std::span<const double> force);
  Vec3 gap(std::size_t i) const {
    const double* b = base_.data() + 3 * i;
    const float* d = increment_.data() + offset_ + 3 * i;
    return {b[0] + double(d[0]), b[1] + double(d[1]), b[2] + double(d[2])};
  }
  void add_influence(std::size_t i, const Vec3& force_change) {
    columns_.add_product(i, force_change, increment_.data() + offset_);
  }

 private:
  PaddedColumns columns_;
  std::vector<double> free_gap_, base_;  ///< padded
  std::vector<float> increment_;
  std::size_t offset_ = 0;
};

}  // namespace souple
