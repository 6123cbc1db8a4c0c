// SPDX-License-Identifier: GPL-3.0-or-later
// What makes tets of unknown origin fit to be simulated.
#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

#include "formats/core/mesh.hpp"
#include "formats/core/result.hpp"

namespace souple {

struct SortedTets {
  std::vector<Point> nodes;          ///< as given, and copies of split ones behind
  std::vector<Tet> tets;             ///< positive
  std::vector<std::int64_t> labels;  ///< as given: one per tet, or empty
  std::size_t turned_count = 0;
  std::size_t dropped_count = 0;
  std::size_t split_node_count = 0;
};

/// A tet is flat if six times its volume is below 1e-12 of the cube of its longest edge. Tets that are
/// all negative are turned: a convention. Refuses, or with `mend` mends:
/// - flat tets, tets with a node twice, tets of the same four nodes (tet_degenerate): left out;
/// - tets of the other orientation than the rest (tet_inverted): turned;
/// - tets that touch along an edge or a node only (tet_not_manifold), which makes a hinge without
///   stiffness: of the pieces that hang together over faces, each that touches a larger one (by volume)
///   is left out; where a piece touches itself at a node, the node is split. A piece that touches
///   itself along an edge, and faces of more than two tets, are refused all the same.
/// Pieces that touch nowhere are fine. Indices must be in range and nodes finite.
Result<SortedTets> sort_out_tets(std::vector<Point> nodes, std::vector<Tet> tets,
                                 std::vector<std::int64_t> labels, bool mend);

}  // namespace souple
