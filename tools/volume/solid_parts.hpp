// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstddef>

#include "formats/core/mesh.hpp"

namespace souple {

/// Where the boundary touches itself at an edge or a node, the tets there hang together in several
/// groups over common faces: all but the largest group are removed, until the boundary is manifold.
void remove_pinches(TetMesh& mesh);

/// Keeps the `count` largest parts (by number of tets) that hang together over faces; returns how many
/// parts there were.
std::size_t keep_largest_parts(TetMesh& mesh, std::size_t count);

/// Drops nodes that no tet uses.
void drop_unused_nodes(TetMesh& mesh);

}  // namespace souple
