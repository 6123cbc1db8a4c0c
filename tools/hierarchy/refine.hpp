// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <vector>

#include "formats/core/mesh.hpp"

namespace souple {

struct RefinedMesh {
  TetMesh mesh;  ///< the coarse nodes with their indices, then the midpoints of the edges in ascending
                 ///< order
  std::vector<std::array<Index, 2>> parents;  ///< {i, i} or {a, b} with a < b, one pair per node
};

/// Red refinement: every tet is split into 8 of the same volume; the octahedron in its middle along the
/// shortest of its three diagonals (METHOD 3.2). The result must fit Index: 8 tets and, for every edge,
/// one node.
RefinedMesh refine_red(const TetMesh& coarse);

}  // namespace souple
