// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <span>
#include <vector>

#include "tools/geometry/box.hpp"

namespace souple {

/// Boxes in a binary tree, split at the median of their centres along the longest side: the depth is
/// logarithmic whatever the input. Whoever asks walks the nodes.
class BoxTree {
 public:
  struct Node {
    Box box;
    Index first = 0;  ///< leaf: first entry of order(); else the right child (the left one follows)
    Index count = 0;  ///< boxes of a leaf, 0 for an inner node
  };
  /// A stack of so many nodes holds any walk: twice the depth of 2^31 boxes.
  static constexpr std::size_t deepest_walk = 128;

  /// `room`: part of its own sides by which every node is wider than its boxes.
  BoxTree(std::span<const Box> boxes, const std::vector<Point>& centres, double room);

  std::span<const Node> nodes() const { return nodes_; }  ///< the first is the root
  std::span<const Index> order() const { return order_; }

 private:
  Index build(std::span<Index> range, std::size_t offset, std::span<const Box> boxes,
              const std::vector<Point>& centres, double room);

  std::vector<Index> order_;
  std::vector<Node> nodes_;
};

}  // namespace souple
