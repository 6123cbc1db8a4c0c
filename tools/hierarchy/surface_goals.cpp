// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/hierarchy/surface_goals.hpp"

#include <array>

#include "tools/geometry/vector.hpp"

namespace souple {

std::vector<Point> nearest_three_goals(const std::vector<Point>& positions,
                                       const TargetSurface& target) {
  std::vector<Point> goals;
  goals.reserve(positions.size());
  for (const Point& p : positions) {
    std::array<ClosestPoint, 3> closest;
    const std::size_t count = target.triangles().nearest(p, closest);
    Point sum{};
    for (std::size_t k = 0; k < count; ++k) sum = add(sum, closest[k].point);
    goals.push_back(count > 0 ? scaled(sum, 1 / static_cast<double>(count)) : p);
  }
  return goals;
}

std::vector<Point> projection_goals(const LevelSurface& surface, const std::vector<Point>& positions,
                                    const TargetSurface& target) {
  std::vector<Point> goals;
  goals.reserve(positions.size());
  for (std::size_t v = 0; v < positions.size(); ++v) {
    const ClosestPoint closest = target.closest_facing(
        positions[v], surface.vertex_normal(positions, v), surface.reach(positions, v));
    goals.push_back(closest.triangle < 0 ? positions[v] : closest.point);
  }
  return goals;
}

}  // namespace souple
