// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstddef>
#include <utility>
#include <vector>

#include "formats/core/mesh.hpp"

namespace souple {

using BoundaryEdge = std::pair<Index, Index>;  ///< the lower vertex first

/// Edges of one triangle, ascending.
std::vector<BoundaryEdge> boundary_edges(const TriangleMesh& mesh);

/// Edges of one triangle each that hang together over vertices: the rim of a hole.
struct BoundaryLoop {
  std::size_t edge_count = 0;
  double perimeter_m = 0;
  double lid_area_m2 = 0;  ///< of its shadow in the direction where that is largest
};

/// In the order of their lowest vertices. Vertices must be merged by position.
std::vector<BoundaryLoop> find_boundary_loops(const TriangleMesh& mesh);

}  // namespace souple
