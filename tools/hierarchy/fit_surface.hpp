// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstddef>
#include <vector>

#include "formats/core/mesh.hpp"
#include "tools/geometry/triangle_bvh.hpp"

namespace souple {

/// Mean-ratio quality of a tet, 12 (3 V)^(2/3) / sum of squared edge lengths: 1 for the regular tet, 0
/// for a flat one, negative for an inverted one.
double mean_ratio(const Point& a, const Point& b, const Point& c, const Point& d);

/// Moves the boundary nodes to the barycentre of their closest points on the 3 nearest triangles of the
/// target (METHOD 3.2), weighted by nearness and brought back onto the surface. A node goes only as far
/// as its tets keep a sound shape; inner nodes beside tets that suffered are then smoothed, and what
/// was held back tries again. Returns how many nodes ended short of their goal. Deterministic.
std::size_t fit_to_surface(TetMesh& mesh, const std::vector<Triangle>& boundary,
                           const TriangleBvh& target);

}  // namespace souple
