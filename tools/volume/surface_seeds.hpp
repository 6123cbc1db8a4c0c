// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <vector>

#include "formats/core/mesh.hpp"

namespace souple {

/// Points on the surface, far from one another: in every shell the middle of the first triangle, then
/// always the triangle farthest from all points so far, until none is farther than `spacing`, at least
/// `fewest` and at most `most` points a shell (fewer if it has fewer triangles).
std::vector<Point> spread_surface_seeds(const TriangleMesh& surface, double spacing, std::size_t fewest,
                                        std::size_t most);

}  // namespace souple
