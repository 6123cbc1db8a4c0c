// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/geometry/box.hpp"

#include <algorithm>

#include "tools/geometry/vector.hpp"

namespace souple {

Box bounding_box(std::span<const Point> points) {
  if (points.empty()) return {};
  Box box{points[0], points[0]};
  for (const Point& p : points)
    for (std::size_t k = 0; k < 3; ++k) {
      box.low[k] = std::min(box.low[k], p[k]);
      box.high[k] = std::max(box.high[k], p[k]);
    }
  return box;
}

double longest_side(const Box& box) { return std::ranges::max(subtract(box.high, box.low)); }

}  // namespace souple
