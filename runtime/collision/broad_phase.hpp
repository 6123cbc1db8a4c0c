// SPDX-License-Identifier: MIT
#pragma once
#include <compare>
#include <cstdint>
#include <span>
#include <vector>

#include "runtime/fem/linear_algebra.hpp"
#include "runtime/world/settings.hpp"

namespace souple {

struct BodyPair {
  std::uint32_t a = 0, b = 0;  ///< a < b
  friend auto operator<=>(const BodyPair&, const BodyPair&) = default;
};

/// Which bodies' boxes overlap: sort and sweep along the axis on which they spread most, the order kept
/// from step to step. Allocates nothing while the number of bodies and of pairs does not grow.
class BroadPhase {
 public:
  /// Bodies are 0 to count - 1; new ones have an empty box, which overlaps nothing.
  void resize(std::size_t body_count);
  void set_filter(std::uint32_t body, const CollisionFilter& filter) { filters_[body] = filter; }
  /// Infinite sides are allowed (a plane); NaN counts as empty.
  void set_box(std::uint32_t body, const Eigen::AlignedBox3d& box);
  /// Pairs with overlapping (closed) boxes whose groups and masks let them meet, ascending.
  std::span<const BodyPair> find_pairs();

 private:
  void sort_along(Eigen::Index axis);

  std::vector<Eigen::AlignedBox3d> boxes_;
  std::vector<CollisionFilter> filters_;
  std::vector<std::uint32_t> order_;
  std::vector<BodyPair> pairs_;
};

}  // namespace souple
