// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <vector>

#include "formats/core/mesh.hpp"
#include "tools/hierarchy/nested_hierarchy.hpp"

namespace souple {

struct RefinedMesh {
  TetMesh mesh;  ///< the coarse nodes with their indices, then the midpoints of the edges in ascending
                 ///< order; the children of tet t are the tets 8 t … 8 t + 7, the four corners first
  std::vector<std::array<Index, 2>> parents;  ///< {i, i} or {a, b} with a < b, one pair per node
};

/// Red refinement: every tet is split into 8 of the same volume; the octahedron in its middle along one
/// of its three diagonals (METHOD 3.2). The result must fit Index: 8 tets and, for every edge, one
/// node.
RefinedMesh refine_red(const TetMesh& coarse, DiagonalRule rule);

}  // namespace souple
