// SPDX-License-Identifier: MIT
#include "runtime/contact/dense_contact_operator.hpp"

#include <algorithm>

namespace souple {

void DenseContactOperator::reset(std::span<const double> free_gap) {
  columns_.reset(free_gap.size(), free_gap.size());
  free_gap_.assign(columns_.stride(), 0.0);
  std::ranges::copy(free_gap, free_gap_.begin());
  base_ = free_gap_;
  increment_.assign(columns_.stride() + PaddedColumns::pack - 1, 0.0F);
  offset_ = aligned_offset(increment_);
}

void DenseContactOperator::assign(std::span<const double> delassus, std::span<const double> free_gap) {
  reset(free_gap);
  const std::size_t height = free_gap.size();
  for (std::size_t c = 0; c < height; ++c)
    std::ranges::transform(delassus.subspan(c * height, height), columns_.column(c),
                           [](double value) { return float(value); });
}

void DenseContactOperator::anchor(std::span<const double> force, std::span<const double> gap) {
  std::ranges::fill(free_gap_, 0.0);
  refresh(force);
  for (std::size_t k = 0; k < gap.size(); ++k) free_gap_[k] = gap[k] - base_[k];
  std::ranges::copy(gap, base_.begin());
}

void DenseContactOperator::refresh(std::span<const double> force) {
  std::ranges::copy(free_gap_, base_.begin());
  std::ranges::fill(increment_, 0.0F);
  for (std::size_t i = 0; i < size(); ++i) {
    const Vec3 f = Eigen::Map<const Vec3>(&force[3 * i]);
    if (f != Vec3::Zero()) columns_.add_product(i, f, base_.data());
  }
}

}  // namespace souple
