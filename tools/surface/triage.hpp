// SPDX-License-Identifier: GPL-3.0-or-later
// What is wrong with a surface, before anything is done to it.
#pragma once
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "formats/core/mesh.hpp"
#include "formats/core/result.hpp"

namespace souple {

enum class SurfaceGrade {
  good,        ///< closed, oriented, manifold, free of self-intersection: meshed as it is
  repairable,  ///< orientation, small holes, stitches, duplicates, few self-intersections
  wrap,        ///< only a wrap gives a solid: large holes, soup, heavy self-intersection
  hopeless,    ///< encloses nothing and nothing plausible can be wrapped: flat, one triangle, no extent
};

/// "good", "repairable", "wrap", "hopeless".
std::string_view surface_grade_name(SurfaceGrade grade);

/// Counts after vertices at the same position were merged.
struct SurfaceTriage {
  std::size_t vertex_count = 0;
  std::size_t triangle_count = 0;
  std::size_t component_count = 0;       ///< pieces connected over vertices
  std::size_t nested_shell_count = 0;    ///< closed components inside another one
  std::size_t inverted_shell_count = 0;  ///< closed components whose volume has the wrong sign
  std::size_t boundary_edge_count = 0;
  std::size_t hole_count = 0;  ///< loops of boundary edges
  std::size_t nonmanifold_edge_count = 0;
  std::size_t nonmanifold_vertex_count = 0;
  std::size_t opposed_edge_count = 0;         ///< both triangles run through in the same direction
  std::size_t degenerate_triangle_count = 0;  ///< no area, or a corner twice
  std::size_t duplicate_triangle_count = 0;
  std::size_t self_intersection_count = 0;  ///< pairs of triangles
  bool self_intersections_capped = false;   ///< the search stopped at the cap
  Point box_min{}, box_max{};               ///< m
  double area_m2 = 0;
  double volume_m3 = 0;     ///< signed, of what is there; meaningful if closed and oriented
  double largest_hole = 0;  ///< longest hole's perimeter over the diagonal of the box
  SurfaceGrade grade = SurfaceGrade::hopeless;
  std::vector<std::string> findings;  ///< in words, worst first
};

/// Looks only. Issues: surface_invalid (indices out of range, NaN).
Result<SurfaceTriage> triage_surface(const TriangleMesh& surface);

}  // namespace souple
