// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/hierarchy/tet_tree.hpp"

#include <algorithm>
#include <array>

#include "tools/geometry/vector.hpp"
#include "tools/hierarchy/tet_weights.hpp"

namespace souple {
namespace {

constexpr std::size_t leaf_size = 4;
/// A point with no weight below this lies on the boundary of the tet, as far as rounding can tell.
constexpr double on_the_boundary = -1e-10;

std::size_t at(Index i) { return static_cast<std::size_t>(i); }

}  // namespace

TetTree::TetTree(const TetMesh& mesh) : mesh_(mesh) {
  centroids_.reserve(mesh.tets.size());
  order_.reserve(mesh.tets.size());
  for (const Tet& t : mesh.tets) {
    Point sum{};
    for (const Index i : t) sum = add(sum, mesh.nodes[at(i)]);
    centroids_.push_back(scaled(sum, 0.25));
    order_.push_back(static_cast<Index>(order_.size()));
  }
  if (!order_.empty()) build(order_, 0);
}

void TetTree::bound(Node& node, std::span<const Index> range) const {
  node.low = node.high = centroids_[at(range[0])];
  for (const Index t : range)
    for (const Index i : mesh_.tets[at(t)])
      for (std::size_t k = 0; k < 3; ++k) {
        node.low[k] = std::min(node.low[k], mesh_.nodes[at(i)][k]);
        node.high[k] = std::max(node.high[k], mesh_.nodes[at(i)][k]);
      }
  // Room for points that on_the_boundary still takes in.
  for (std::size_t k = 0; k < 3; ++k) {
    const double room = 1e-9 * (node.high[k] - node.low[k]);
    node.low[k] -= room;
    node.high[k] += room;
  }
}

// Median split along the longest side: the depth is logarithmic whatever the input.
Index TetTree::build(std::span<Index> range, std::size_t offset) {
  const auto self = static_cast<Index>(nodes_.size());
  Node node;
  bound(node, range);
  nodes_.push_back(node);
  if (range.size() <= leaf_size) {
    nodes_.back().first = static_cast<Index>(offset);
    nodes_.back().count = static_cast<Index>(range.size());
    return self;
  }
  const Point side = subtract(node.high, node.low);
  const auto axis = static_cast<std::size_t>(std::ranges::max_element(side) - side.begin());
  const std::size_t half = range.size() / 2;
  std::ranges::nth_element(range, range.begin() + static_cast<std::ptrdiff_t>(half),
                           [&](Index a, Index b) {
                             const double ca = centroids_[at(a)][axis], cb = centroids_[at(b)][axis];
                             return ca != cb ? ca < cb : a < b;
                           });
  build(range.first(half), offset);
  const Index right = build(range.subspan(half), offset + half);
  nodes_[at(self)].first = right;
  return self;
}

Embedding TetTree::containing(const Point& p) const {
  Embedding best;
  best.tet = -1;
  if (nodes_.empty()) return best;
  const auto inside = [&](const Node& node) {
    for (std::size_t k = 0; k < 3; ++k)
      if (!(node.low[k] <= p[k] && p[k] <= node.high[k])) return false;
    return true;
  };
  std::array<Index, 128> stack;  // twice the depth of 2^31 tets
  std::size_t height = 0;
  stack[height++] = 0;
  while (height > 0) {
    const Index index = stack[--height];
    const Node& node = nodes_[at(index)];
    if (!inside(node)) continue;
    for (Index i = 0; i < node.count; ++i) {
      const Index t = order_[at(node.first + i)];
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
