// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <span>
#include <vector>

#include "formats/core/asset.hpp"

namespace souple {

/// Boxes around tets in a binary tree: finds the tet that holds a point.
class TetTree {
 public:
  /// Tets positive, indices in range; the mesh is kept by reference.
  explicit TetTree(const TetMesh& mesh);

  /// The lowest tet that contains p, its boundary included; tet -1 if there is none.
  Embedding containing(const Point& p) const;

 private:
  struct Node {
    Point low, high;
    Index first = 0;  ///< leaf: first entry of order_; else the right child (the left one follows)
    Index count = 0;  ///< tets of a leaf, 0 for an inner node
  };
  Index build(std::span<Index> range, std::size_t offset);
  void bound(Node& node, std::span<const Index> range) const;

  const TetMesh& mesh_;
  std::vector<Point> centroids_;
  std::vector<Index> order_;
  std::vector<Node> nodes_;
};

}  // namespace souple
