// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstddef>
#include <vector>

#include "formats/core/mesh.hpp"

namespace souple {

/// Tets that hang together over faces.
struct TetPieces {
  std::vector<Index> piece_of_tet;  ///< 0, 1, … in the order of first appearance
  std::size_t piece_count = 0;
  std::size_t crowded_face_count = 0;  ///< faces of more than two tets
};

TetPieces find_tet_pieces(const std::vector<Tet>& tets);

/// Takes the pieces from the largest volume down and marks (1) the tets of each that shares a node with
/// one taken before. Tets must be positive.
std::vector<char> tets_of_smaller_touching_pieces(const std::vector<Point>& nodes,
                                                  const std::vector<Tet>& tets,
                                                  const TetPieces& pieces);

/// Gives every group of tets that hangs together over faces around a node a node of its own: the first
/// keeps the node, the others get copies at the end. Returns how many copies there are.
std::size_t split_pinched_nodes(std::vector<Point>& nodes, std::vector<Tet>& tets);

}  // namespace souple
