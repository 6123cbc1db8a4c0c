// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <span>
#include <vector>

#include "formats/core/mesh.hpp"

namespace souple {

/// Generalised winding number (Jacobson et al. 2013) of a copy of the triangles: 1 inside and 0 outside
/// a closed outward surface, whole numbers where shells overlap, the solid angle over 4 pi where the
/// surface is open. Clusters far from the query count as one dipole (Barill et al. 2018). Queries may
/// run from several threads.
class WindingNumber {
 public:
  /// Indices must be in range and vertices finite.
  explicit WindingNumber(const TriangleMesh& mesh);

  /// Off by less than 0.1 at points that do not lie on the surface.
  double at(const Point& p) const;

 private:
  struct Node {
    Point centre{};          ///< area-weighted centroid
    Point area{};            ///< sum of the area vectors
    double squared_far = 0;  ///< squared distance from the centre beyond which the dipole is used
    Index first = 0;         ///< leaf: first entry of corners_; else the right child (the left follows)
    Index count = 0;         ///< triangles of a leaf, 0 for an inner node
  };
  Index build(std::span<std::array<Point, 3>> range, std::size_t offset);

  std::vector<std::array<Point, 3>> corners_;  ///< in the order of the leaves
  std::vector<Node> nodes_;
};

}  // namespace souple
