// SPDX-License-Identifier: MIT
#pragma once
#include <span>
#include <vector>

#include "runtime/fem/block_matrix.hpp"
#include "runtime/multigrid/prolongation.hpp"

namespace souple {

/// A cubic lattice whose cells are cut into six tets along their diagonal (Freudenthal): one of twice
/// the spacing and the same origin holds it, so that its points hang on one or two points of that.
struct Lattice {
  Point origin{};      ///< m, not above any point of the body
  double spacing = 0;  ///< m
};

/// A coarser level made of positions and couplings alone: the points of the lattice around the body.
struct LatticeLevel {
  std::vector<Point> positions;  ///< m
  Prolongation prolongation;     ///< linear in every tet of the lattice: rigid motions are carried
};

/// Every node but those `at_rest` (ascending; their rows of P are empty) hangs on the four corners of
/// the lattice's tet that holds it. Where the nodes at a point of the lattice do not hang together by
/// couplings, each part has a point of its own, so that limbs move apart, however narrow the gap. Nodes
/// outside of the body keep its thin parts from collapsing to lines; some depend on each other, and the
/// Galerkin matrix is then only semi-definite.
LatticeLevel lattice_level(const BlockPattern& pattern, std::span<const Point> positions,
                           std::span<const Index> at_rest, const Lattice& lattice);

}  // namespace souple
