// SPDX-License-Identifier: MIT
#pragma once
#include <span>
#include <vector>

#include "runtime/fem/block_matrix.hpp"

namespace souple {

/// An order of elimination in pieces, the supernodes: a piece couples only to pieces that are its
/// ancestors, and comes before them.
struct EliminationTree {
  std::vector<Index> order;   ///< the nodes, piece by piece
  std::vector<Index> begin;   ///< [pieces + 1] in `order`
  std::vector<Index> parent;  ///< [pieces], -1: a root; parents come after their children

  Index piece_count() const { return static_cast<Index>(parent.size()); }
};

/// Nested dissection by geometry: the nodes are halved again and again across the best of their box's
/// axes; of the pairs that couple across the cut, a smallest set of nodes that covers all (König) is
/// the separator. Parts of at most `leaf_nodes` are not cut. Depends on the input alone.
EliminationTree nested_dissection(const BlockPattern& pattern, std::span<const Point> positions,
                                  std::span<const Index> nodes, Index leaf_nodes);

}  // namespace souple
