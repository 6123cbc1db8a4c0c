// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/hierarchy/tet_tree.hpp"

#include <algorithm>
#include <array>

#include "tools/geometry/vector.hpp"
#include "tools/hierarchy/tet_weights.hpp"

namespace souple {
namespace {

/// A point with no weight below this lies on the boundary of the tet, as far as rounding can tell.
constexpr double on_the_boundary = -1e-10;
/// Room for points that on_the_boundary still takes in.
constexpr double room = 1e-9;

std::size_t at(Index i) { return static_cast<std::size_t>(i); }

BoxTree tree_of(const TetMesh& mesh) {
  std::vector<Box> boxes;
  std::vector<Point> centroids;
  boxes.reserve(mesh.tets.size());
  centroids.reserve(mesh.tets.size());
  for (const Tet& t : mesh.tets) {
    const std::array corners{mesh.nodes[at(t[0])], mesh.nodes[at(t[1])], mesh.nodes[at(t[2])],
                             mesh.nodes[at(t[3])]};
    boxes.push_back(bounding_box(corners));
    Point sum{};
    for (const Point& c : corners) sum = add(sum, c);
    centroids.push_back(scaled(sum, 0.25));
  }
  return {boxes, centroids, room};
}

}  // namespace

TetTree::TetTree(const TetMesh& mesh) : mesh_(mesh), tree_(tree_of(mesh)) {}

Embedding TetTree::containing(const Point& p) const {
  Embedding best;
  best.tet = -1;
  const auto nodes = tree_.nodes();
  if (nodes.empty()) return best;
  const auto inside = [&](const Box& box) {
    for (std::size_t k = 0; k < 3; ++k)
      if (!(box.low[k] <= p[k] && p[k] <= box.high[k])) return false;
    return true;
  };
  std::array<Index, BoxTree::deepest_walk> stack;
  std::size_t height = 0;
  stack[height++] = 0;
  while (height > 0) {
    const Index index = stack[--height];
    const BoxTree::Node& node = nodes[at(index)];
    if (!inside(node.box)) continue;
    for (Index i = 0; i < node.count; ++i) {
      const Index t = tree_.order()[at(node.first + i)];
      if (best.tet >= 0 && t > best.tet) continue;
      const auto weights = barycentric_weights(p, mesh_.tets[at(t)], mesh_.nodes);
      if (std::ranges::min(weights) >= on_the_boundary) best = {t, weights};
    }
    if (node.count > 0) continue;
    stack[height++] = node.first;
    stack[height++] = index + 1;
  }
  return best;
}

}  // namespace souple
