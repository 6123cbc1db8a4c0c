// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <cstddef>
#include <vector>

#include "formats/core/mesh.hpp"
#include "tools/hierarchy/tet_shape.hpp"

namespace souple {

/// Symmetric 3x3: xx, yy, zz, xy, xz, yz.
using Symmetric = std::array<double, 6>;
Point times(const Symmetric& m, const Point& v);

/// Adds (x - goal) . stiffness (x - goal) to the energy of a node: stiff across the surface, soft along
/// it.
struct Attraction {
  Point goal{};           ///< m
  Symmetric stiffness{};  ///< 1/m^2, positive semi-definite
};

/// Finds places for single nodes that make the sum over their tets of (parent quality / quality)^6
/// least: a smooth stand-in for the worst child of all, which no inverted tet can enter. Newton steps
/// with backtracking; the energy is convex in every single node.
class ShapeOptimizer {
 public:
  /// All tets positive; `parent_quality` per tet, > 0. Both are kept by reference.
  ShapeOptimizer(const TetMesh& mesh, const std::vector<double>& parent_quality);

  /// Quality of a tet over that of its parent.
  double kept(std::size_t tet) const;
  /// A better place of the node, or the old one if no step gains anything.
  Point improved(std::size_t node, const Attraction& attraction) const;
  const NodeTets& node_tets() const { return node_tets_; }

 private:
  double energy_at(std::size_t node, const Point& x, const Attraction& attraction) const;

  const TetMesh& mesh_;
  const std::vector<double>& parent_quality_;
  std::vector<double> weights_;  ///< parent quality^3
  NodeTets node_tets_;
};

}  // namespace souple
