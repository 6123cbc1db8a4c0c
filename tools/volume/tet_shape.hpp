// SPDX-License-Identifier: GPL-3.0-or-later
// Shape measures of one tet.
#pragma once
#include <array>

#include "formats/core/mesh.hpp"

namespace souple {

using TetCorners = std::array<Point, 4>;

inline TetCorners corners_of(const TetMesh& mesh, const Tet& tet) {
  const auto node = [&](std::size_t k) { return mesh.nodes[static_cast<std::size_t>(tet[k])]; };
  return {node(0), node(1), node(2), node(3)};
}

/// 0 for a flat or inverted tet.
double smallest_dihedral_deg(const TetCorners& x);
/// 3 r_in / r_circ; 0 for a flat or inverted tet.
double radius_ratio(const TetCorners& x);
/// Longest edge over least height, over that of the regular tet, sqrt(3/2); huge for a flat one.
double aspect(const TetCorners& x);

}  // namespace souple
