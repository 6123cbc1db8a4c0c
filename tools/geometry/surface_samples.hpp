// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <algorithm>
#include <vector>

#include "formats/core/mesh.hpp"
#include "tools/geometry/surface_measure.hpp"

namespace souple {

/// Points of a surface, each for a piece of its area.
struct SurfaceSamples {
  std::vector<Point> points;
  std::vector<double> areas;  ///< m2
};

/// In rows along the longest side of every triangle, no farther apart than `spacing` (m, > 0) in either
/// direction, at most 200 a row; at least one a triangle. A long thin triangle costs one row only.
SurfaceSamples sample_evenly(const TriangleMesh& mesh, double spacing);

struct TwoSidedDistance {
  SurfaceDistance forth;  ///< of the first surface's samples from the second
  SurfaceDistance back;   ///< of the second surface's samples from the first
  double hausdorff() const { return std::max(forth.largest, back.largest); }
  double root_mean_square() const { return std::max(forth.root_mean_square, back.root_mean_square); }
};

/// Between the vertices that triangles use and samples of one surface and the other; the samples lie
/// `samples_per_side` to the longest side of both.
TwoSidedDistance two_sided_distance(const TriangleMesh& a, const TriangleMesh& b,
                                    double samples_per_side = 100);
/// The same with the trees of both at hand.
TwoSidedDistance two_sided_distance(const TriangleMesh& a, const TriangleBvh& a_triangles,
                                    const TriangleMesh& b, const TriangleBvh& b_triangles,
                                    double samples_per_side = 100);

}  // namespace souple
