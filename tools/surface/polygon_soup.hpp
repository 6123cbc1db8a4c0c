// SPDX-License-Identifier: GPL-3.0-or-later
// What the readers hand over before anything is trusted.
#pragma once
#include <cstddef>
#include <vector>

#include "formats/core/mesh.hpp"
#include "formats/core/result.hpp"

namespace souple {

using Polygon = std::vector<std::size_t>;  ///< vertices in order; any count

struct PolygonSoup {
  std::vector<Point> points;  ///< units of the file, node transforms applied
  std::vector<Polygon> polygons;
};

struct TriangleSoup {
  TriangleMesh mesh;                 ///< units of the file
  std::size_t raw_vertex_count = 0;  ///< as stored in the file
  std::size_t raw_polygon_count = 0;
  std::size_t lost_triangle_count = 0;  ///< of polygons that no triangulation covers
};

/// Refuses indices out of range, coordinates that are not finite or beyond 1e15, and no polygons at
/// all.
Status check_polygon_soup(const PolygonSoup& soup);

}  // namespace souple
