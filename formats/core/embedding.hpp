// SPDX-License-Identifier: MIT
#pragma once
#include <span>

#include "formats/core/asset.hpp"

namespace souple {

/// The point with these weights among the nodes `tet` of `x`: x_0 + sum_k w_k (x_k - x_0), which is
/// sum_k w_k x_k where the weights sum to 1, and moves with the nodes exactly even where their sum is
/// rounded or the tet is far from the origin. Serves velocities as well. Indices are not checked.
inline Point embedded_point(const Tet& tet, const std::array<double, 4>& weights,
                            std::span<const Point> x) {
  const Point& first = x[static_cast<std::size_t>(tet[0])];
  Point point = first;
  for (std::size_t k = 1; k < 4; ++k) {
    const Point& other = x[static_cast<std::size_t>(tet[k])];
    for (std::size_t axis = 0; axis < 3; ++axis)
      point[axis] += weights[k] * (other[axis] - first[axis]);
  }
  return point;
}

}  // namespace souple
