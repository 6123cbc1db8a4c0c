// SPDX-License-Identifier: GPL-3.0-or-later
// Nearest triangles of a surface. CGAL's AABB tree gives only the single closest one; the fitting of
// METHOD 3.2 needs three.
#pragma once
#include <array>
#include <cstddef>
#include <limits>
#include <span>
#include <vector>

#include "formats/core/mesh.hpp"
#include "tools/geometry/box_tree.hpp"

namespace souple {

struct ClosestPoint {
  Point point{};  ///< on the triangle, m
  double squared_distance = std::numeric_limits<double>::infinity();
  Index triangle = -1;
};

/// Closest point of triangle (a, b, c), which may be degenerate, to p (Ericson 2005, 5.1.5).
Point closest_point_on_triangle(const Point& p, const Point& a, const Point& b, const Point& c);

/// Bounding-volume hierarchy over a copy of the triangles; queries may run from several threads.
class TriangleBvh {
 public:
  /// Indices must be in range and vertices finite.
  explicit TriangleBvh(const TriangleMesh& mesh);

  /// Fills `out` with the out.size() nearest triangles, nearest first, equal distances by index;
  /// returns how many there were (fewer only if the surface has fewer).
  std::size_t nearest(const Point& p, std::span<ClosestPoint> out) const;
  /// The single nearest; triangle -1 if the surface is empty.
  ClosestPoint closest(const Point& p) const;

 private:
  std::vector<std::array<Point, 3>> corners_;
  BoxTree tree_;
};

}  // namespace souple
