// SPDX-License-Identifier: GPL-3.0-or-later
// From an imported surface to one that encloses a volume. Repair (hole filling, wrapping, resolving
// self-intersections) belongs before orient_closed_surface, which is the check that its result must
// pass.
#pragma once
#include <cstddef>

#include "formats/core/mesh.hpp"
#include "formats/core/result.hpp"

namespace souple {

struct OrientReport {
  std::size_t shell_count = 0;
  std::size_t turned_triangle_count = 0;    ///< of which the orientation was changed
  std::size_t split_vertex_count = 0;       ///< added where several fans met in one vertex
  std::size_t self_intersection_count = 0;  ///< pairs of triangles of one shell that cut each other
  double volume_m3 = 0;
};

struct OrientedSurface {
  TriangleMesh mesh;  ///< closed, manifold, outward: cavities face inward
  OrientReport report;
};

/// Merges vertices by exact position, orients the triangles consistently and outward (a shell inside
/// another one bounds a cavity) and checks the result. Refuses what is open, not manifold, one-sided,
/// without volume, or made of shells that cross; self-intersections within one shell are only counted.
/// The order of triangles is kept.
Result<OrientedSurface> orient_closed_surface(const TriangleMesh& surface);

}  // namespace souple
