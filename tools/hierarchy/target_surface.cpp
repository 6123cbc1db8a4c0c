// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/hierarchy/target_surface.hpp"

#include <array>
#include <string>
#include <utility>

#include "tools/geometry/surface_measure.hpp"
#include "tools/geometry/vector.hpp"
#include "tools/hierarchy/tet_weights.hpp"

namespace souple {

Status check_target(const TriangleMesh& target) {
  if (const Status valid = check_triangle_mesh(target); !valid) return valid;
  for (std::size_t i = 0; i < target.vertices.size(); ++i)
    if (!is_within_reach(target.vertices[i]))
      return make_issue(IssueCode::surface_too_far,
                        "vertex " + std::to_string(i) + " of the target is too far out");
  return {};
}

TargetSurface::TargetSurface(TriangleMesh mesh) : mesh_(std::move(mesh)), bvh_(mesh_) {
  normals_.reserve(mesh_.triangles.size());
  const auto vertex = [&](Index i) { return mesh_.vertices[static_cast<std::size_t>(i)]; };
  for (const Triangle& t : mesh_.triangles) {
    const Point a = vertex(t[0]);
    const Point area = cross(subtract(vertex(t[1]), a), subtract(vertex(t[2]), a));
    const double length = norm(area);
    normals_.push_back(length > 0 ? scaled(area, 1 / length) : Point{});
  }
}

ClosestPoint TargetSurface::closest_facing(const Point& p, const Point& outward, double reach) const {
  const ClosestPoint closest = bvh_.closest(p);
  const auto faces = [&](const ClosestPoint& c) { return dot(normal(c.triangle), outward) > 0; };
  if (closest.triangle < 0 || faces(closest)) return closest;
  // A limb's other side is rarely more than a few triangles away; the second look is for fine targets.
  std::array<ClosestPoint, 64> candidates;
  for (const std::size_t look : {std::size_t{12}, candidates.size()}) {
    const std::span<ClosestPoint> some(candidates.data(), look);
    const std::size_t found = bvh_.nearest(p, some);
    for (const ClosestPoint& c : some.first(found)) {
      if (c.squared_distance > reach * reach) return closest;
      if (faces(c)) return c;
    }
  }
  return closest;
}

}  // namespace souple
