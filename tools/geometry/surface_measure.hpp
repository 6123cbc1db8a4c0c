// SPDX-License-Identifier: GPL-3.0-or-later
// What can be measured of a triangle mesh without repairing it.
#pragma once
#include <cstddef>
#include <vector>

#include "formats/core/mesh.hpp"
#include "formats/core/result.hpp"
#include "tools/geometry/box.hpp"
#include "tools/geometry/triangle_bvh.hpp"

namespace souple {

/// Signed volume by the divergence theorem, about the middle of the box: positive if closed and
/// outward.
double signed_volume(const TriangleMesh& mesh);
double surface_area(const TriangleMesh& mesh);

struct SurfaceTopology {
  std::size_t shell_count = 0;               ///< pieces connected over vertices
  std::size_t boundary_edge_count = 0;       ///< edges of one triangle
  std::size_t nonmanifold_edge_count = 0;    ///< edges of more than two triangles
  std::size_t opposed_edge_count = 0;        ///< edges both triangles run through in the same direction
  std::size_t nonmanifold_vertex_count = 0;  ///< vertices whose triangles form several fans

  bool closed() const { return boundary_edge_count == 0 && nonmanifold_edge_count == 0; }
  bool closed_oriented_manifold() const {
    return closed() && opposed_edge_count == 0 && nonmanifold_vertex_count == 0;
  }
};

/// By index, not by position. Indices must be in range, no vertex twice in a triangle.
SurfaceTopology measure_topology(const std::vector<Triangle>& triangles, std::size_t vertex_count);

/// Refuses (surface_invalid, _no_triangles) indices out of range, a vertex twice in a triangle, NaN,
/// Inf and a mesh without triangles.
Status check_triangle_mesh(const TriangleMesh& mesh);
/// The same, and (surface_not_closed, _not_manifold, _not_orientable) what is open, not manifold or not
/// oriented. Counts stand in the message.
Status check_closed_oriented_manifold(const TriangleMesh& mesh);

/// Shell (0, 1, …; in the order of first appearance) of every triangle.
std::vector<Index> shell_of_triangles(const std::vector<Triangle>& triangles, std::size_t vertex_count);

struct SurfaceDistance {
  double largest = 0;           ///< m
  double root_mean_square = 0;  ///< m
};

/// One-sided distance of the points from the surface.
SurfaceDistance distance_from_surface(const std::vector<Point>& points, const TriangleBvh& surface);

/// Vertices, middles of the sides and barycentres: the points at which a surface is compared.
std::vector<Point> sample_surface(const TriangleMesh& mesh);

}  // namespace souple
