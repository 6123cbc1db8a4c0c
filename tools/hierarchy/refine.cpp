// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/hierarchy/refine.hpp"

#include <algorithm>

#include "tools/geometry/vector.hpp"
#include "tools/hierarchy/tet_shape.hpp"

namespace souple {
namespace {

using Edge = std::array<Index, 2>;

/// Ends of the edges whose midpoints are local nodes 4 … 9.
constexpr int edge_ends[6][2] = {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}};
constexpr int corner_children[4][4] = {{0, 4, 5, 6}, {1, 8, 7, 4}, {2, 7, 9, 5}, {3, 6, 9, 8}};
/// Per diagonal its two ends, then the other four midpoints around it, so that (first, second, c[i],
/// c[i + 1]) is positive.
constexpr int diagonals[3][6] = {{6, 7, 4, 5, 9, 8}, {4, 9, 5, 6, 8, 7}, {5, 8, 4, 7, 9, 6}};

Edge edge_of(const Tet& tet, int e) {
  const Index a = tet[static_cast<std::size_t>(edge_ends[e][0])];
  const Index b = tet[static_cast<std::size_t>(edge_ends[e][1])];
  return {std::min(a, b), std::max(a, b)};
}

std::vector<Edge> sorted_edges(const std::vector<Tet>& tets) {
  std::vector<Edge> edges;
  edges.reserve(6 * tets.size());
  for (const Tet& tet : tets)
    for (int e = 0; e < 6; ++e) edges.push_back(edge_of(tet, e));
  std::ranges::sort(edges);
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  return edges;
}

/// The four inner children of a diagonal.
std::array<Tet, 4> inner_children(const std::array<Index, 10>& node, int diagonal) {
  const auto& d = diagonals[diagonal];
  const auto at = [&](int local) { return node[static_cast<std::size_t>(local)]; };
  std::array<Tet, 4> children;
  for (int i = 0; i < 4; ++i)
    children[static_cast<std::size_t>(i)] = {at(d[0]), at(d[1]), at(d[2 + i]), at(d[2 + (i + 1) % 4])};
  return children;
}

/// The greater the better.
double merit(const std::array<Index, 10>& node, const std::vector<Point>& x, int diagonal,
             DiagonalRule rule) {
  if (rule == DiagonalRule::best_quality) {
    double worst = 1;
    for (const Tet& child : inner_children(node, diagonal))
      worst = std::min(worst, mean_ratio(child, x));
    return worst;
  }
  const auto end = [&](int k) {
    const Index i = node[static_cast<std::size_t>(diagonals[diagonal][k])];
    return x[static_cast<std::size_t>(i)];
  };
  return -squared_norm(subtract(end(1), end(0)));
}

/// The first of equals. The thesis's diagonal is the first; of its children as printed, the sixth and
/// the eighth are inverted (METHOD 3.2), and `diagonals` winds them right.
int chosen_diagonal(const std::array<Index, 10>& node, const std::vector<Point>& x, DiagonalRule rule) {
  if (rule == DiagonalRule::fixed) return 0;
  int best = 0;
  double most = merit(node, x, 0, rule);
  for (int d = 1; d < 3; ++d) {
    const double value = merit(node, x, d, rule);
    if (value > most) {
      best = d;
      most = value;
    }
  }
  return best;
}

void append_children(const std::array<Index, 10>& node, const std::vector<Point>& x, DiagonalRule rule,
                     std::vector<Tet>& children) {
  const auto at = [&](int local) { return node[static_cast<std::size_t>(local)]; };
  for (const auto& c : corner_children) children.push_back({at(c[0]), at(c[1]), at(c[2]), at(c[3])});
  for (const Tet& child : inner_children(node, chosen_diagonal(node, x, rule)))
    children.push_back(child);
}

}  // namespace

RefinedMesh refine_red(const TetMesh& coarse, DiagonalRule rule) {
  RefinedMesh fine;
  fine.mesh.nodes = coarse.nodes;
  for (std::size_t i = 0; i < coarse.nodes.size(); ++i)
    fine.parents.push_back({static_cast<Index>(i), static_cast<Index>(i)});
  const std::vector<Edge> edges = sorted_edges(coarse.tets);
  for (const Edge& e : edges) {
    const Point& a = coarse.nodes[static_cast<std::size_t>(e[0])];
    const Point& b = coarse.nodes[static_cast<std::size_t>(e[1])];
    fine.mesh.nodes.push_back(scaled(add(a, b), 0.5));
    fine.parents.push_back(e);
  }
  fine.mesh.tets.reserve(8 * coarse.tets.size());
  for (const Tet& tet : coarse.tets) {
    std::array<Index, 10> node{tet[0], tet[1], tet[2], tet[3]};
    for (int e = 0; e < 6; ++e) {
      const auto rank = std::ranges::lower_bound(edges, edge_of(tet, e)) - edges.begin();
      node[static_cast<std::size_t>(4 + e)] =
          static_cast<Index>(coarse.nodes.size()) + static_cast<Index>(rank);
    }
    append_children(node, fine.mesh.nodes, rule, fine.mesh.tets);
  }
  return fine;
}

}  // namespace souple
