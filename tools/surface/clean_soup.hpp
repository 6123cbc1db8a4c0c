// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstddef>
#include <vector>

#include "formats/core/mesh.hpp"

namespace souple {

struct CleanedSoup {
  TriangleMesh mesh;                       ///< every vertex used, in the order of first appearance
  std::size_t merged_vertex_count = 0;     ///< different positions, unused ones included
  std::size_t dropped_triangle_count = 0;  ///< a corner twice, no area, or the same corners as another
};

/// For every point the first one at its position (0 and -0 are the same).
std::vector<Index> first_at_position(const std::vector<Point>& points);

/// Of triangles with the same three corners, however turned, all but the first.
std::vector<bool> repeated_triangles(const std::vector<Triangle>& triangles);

/// Merges vertices at exactly the same position (0 and -0 are the same) and drops what is no triangle.
/// Indices must be in range, coordinates finite.
CleanedSoup clean_soup(const TriangleMesh& soup);

}  // namespace souple
