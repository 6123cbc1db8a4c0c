// SPDX-License-Identifier: MIT
#include "runtime/collision/broad_phase.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace souple {

void BroadPhase::resize(std::size_t body_count) {
  boxes_.resize(body_count);
  filters_.resize(body_count);
  order_.resize(body_count);
  std::iota(order_.begin(), order_.end(), 0U);
}

void BroadPhase::set_box(std::uint32_t body, const Eigen::AlignedBox3d& box) {
  boxes_[body] = box;
  if (!(box.min().array() <= box.max().array()).all()) boxes_[body].setEmpty();
}

// By insertion: nearly sorted from the last step. Infinite sides come first, empty boxes last.
void BroadPhase::sort_along(Eigen::Index axis) {
  const auto before = [&](std::uint32_t p, std::uint32_t q) {
    const double x = boxes_[p].min()[axis], y = boxes_[q].min()[axis];
    return x != y ? x < y : p < q;
  };
  for (std::size_t k = 1; k < order_.size(); ++k) {
    const std::uint32_t body = order_[k];
    std::size_t to = k;
    for (; to > 0 && before(body, order_[to - 1]); --to) order_[to] = order_[to - 1];
    order_[to] = body;
  }
}

std::span<const BodyPair> BroadPhase::find_pairs() {
  pairs_.clear();
  Vec3 sum = Vec3::Zero(), squares = Vec3::Zero();
  double count = 0;
  for (const auto& box : boxes_) {
    const Vec3 centre = 0.5 * (box.min() + box.max());
    if (box.isEmpty() || !centre.allFinite()) continue;
    sum += centre;
    squares += centre.cwiseAbs2();
    ++count;
  }
  Eigen::Index axis = 0;
  if (count > 0) (squares / count - (sum / count).cwiseAbs2()).maxCoeff(&axis);
  sort_along(axis);
  for (std::size_t i = 0; i < order_.size(); ++i) {
    const auto& box = boxes_[order_[i]];
    if (box.isEmpty()) continue;
    const CollisionFilter& filter = filters_[order_[i]];
    for (std::size_t j = i + 1; j < order_.size(); ++j) {
      const auto& other = boxes_[order_[j]];
      if (other.min()[axis] > box.max()[axis]) break;
      const CollisionFilter& theirs = filters_[order_[j]];
      if ((filter.groups & theirs.mask) == 0 || (theirs.groups & filter.mask) == 0) continue;
      if (other.isEmpty() || !box.intersects(other)) continue;
      pairs_.push_back({std::min(order_[i], order_[j]), std::max(order_[i], order_[j])});
    }
  }
  std::ranges::sort(pairs_);
  return pairs_;
}

}  // namespace souple
