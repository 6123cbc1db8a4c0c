// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <span>
#include <vector>

#include "formats/core/mesh.hpp"
#include "formats/core/result.hpp"
#include "tools/geometry/triangle_bvh.hpp"

namespace souple {

/// Refuses (surface_invalid, _no_triangles, _too_far) what is no surface to converge to; it may be
/// open.
Status check_target(const TriangleMesh& target);

/// The surface a hierarchy converges to, with its normals, for queries.
class TargetSurface {
 public:
  /// Indices in range, vertices finite.
  explicit TargetSurface(TriangleMesh mesh);

  const TriangleMesh& mesh() const { return mesh_; }
  const TriangleBvh& triangles() const { return bvh_; }
  /// Unit normal of a triangle; zero if it has no area.
  const Point& normal(Index triangle) const { return normals_[static_cast<std::size_t>(triangle)]; }

  /// The closest point whose triangle does not face away from `outward`, so that a node of a thin limb
  /// does not jump to its other side; of all points where none such is found within `reach` (m).
  ClosestPoint closest_facing(const Point& p, const Point& outward, double reach) const;

 private:
  TriangleMesh mesh_;
  TriangleBvh bvh_;
  std::vector<Point> normals_;
};

}  // namespace souple
