// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "formats/core/asset.hpp"
#include "tools/geometry/box_tree.hpp"

namespace souple {

/// Boxes around tets in a binary tree: finds the tet that holds a point.
class TetTree {
 public:
  /// Tets positive, indices in range; the mesh is kept by reference.
  explicit TetTree(const TetMesh& mesh);

  /// The lowest tet that contains p, its boundary included; tet -1 if there is none.
  Embedding containing(const Point& p) const;

 private:
  const TetMesh& mesh_;
  BoxTree tree_;
};

}  // namespace souple
