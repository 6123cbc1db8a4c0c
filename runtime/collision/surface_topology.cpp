// SPDX-License-Identifier: MIT
#include "runtime/collision/surface_topology.hpp"

#include <algorithm>
#include <tuple>
#include <utility>

namespace souple {
namespace {

struct SidedEdge {
  Index low, high;
  bool reversed;  // the triangle runs from high to low
  Index triangle;
  int corner;
};

// Offsets from counts: start[k] becomes the sum of the counts before k.
void accumulate(std::vector<Index>& start) {
  Index total = 0;
  for (Index& entry : start) total += std::exchange(entry, total);
}

}  // namespace

CollisionTopology::CollisionTopology(std::span<const Triangle> triangles) {
  nodes = used_nodes({triangles.begin(), triangles.end()});
  vertex_of_node.assign(nodes.empty() ? 0 : std::size_t(nodes.back()) + 1, -1);
  for (std::size_t v = 0; v < nodes.size(); ++v) vertex_of_node[nodes[v]] = static_cast<Index>(v);
  for (const Triangle& t : triangles)
    corners.push_back({vertex_of_node[t[0]], vertex_of_node[t[1]], vertex_of_node[t[2]]});
  join_edges();
  find_rings();
  find_components();
}

// Two triangles that run along an edge in opposite directions share it; more of them, at an edge that
// is not manifold, are paired in the order of their numbers.
void CollisionTopology::join_edges() {
  std::vector<SidedEdge> sides;
  for (std::size_t t = 0; t < corners.size(); ++t)
    for (int k = 0; k < 3; ++k) {
      const Index from = corners[t][k], to = corners[t][(k + 1) % 3];
      sides.push_back({std::min(from, to), std::max(from, to), from > to, static_cast<Index>(t), k});
    }
  std::ranges::sort(
      sides, {}, [](const SidedEdge& s) { return std::tuple(s.low, s.high, s.reversed, s.triangle); });
  triangle_edges.resize(corners.size());
  for (std::size_t first = 0; first < sides.size();) {
    std::size_t last = first, middle = first;
    while (last < sides.size() && sides[last].low == sides[first].low &&
           sides[last].high == sides[first].high) {
      middle += !sides[last].reversed;
      ++last;
    }
    for (std::size_t f = first, r = middle; f < middle || r < last; ++f, ++r) {
      Edge edge{{sides[first].low, sides[first].high}, {-1, -1}};
      int count = 0;
      for (const std::size_t side : {f < middle ? f : last, r < last ? r : last}) {
        if (side == last) continue;
        edge.triangle[count++] = sides[side].triangle;
        triangle_edges[sides[side].triangle][sides[side].corner] = edge_count();
      }
      edges.push_back(edge);
    }
    first = last;
  }
}

void CollisionTopology::find_rings() {
  ring_start.assign(nodes.size() + 1, 0);
  fan_start.assign(nodes.size() + 1, 0);
  for (const Edge& e : edges)
    for (const Index v : e.vertex) ++ring_start[v];
  for (const auto& t : corners)
    for (const Index v : t) ++fan_start[v];
  accumulate(ring_start);
  accumulate(fan_start);
  ring_vertices.resize(std::size_t(ring_start.back()));
  fan_triangles.resize(std::size_t(fan_start.back()));
  std::vector<Index> ring_at = ring_start, fan_at = fan_start;
  for (const Edge& e : edges)
    for (int k = 0; k < 2; ++k) ring_vertices[ring_at[e.vertex[k]]++] = e.vertex[1 - k];
  for (std::size_t t = 0; t < corners.size(); ++t)
    for (const Index v : corners[t]) fan_triangles[fan_at[v]++] = static_cast<Index>(t);
}

void CollisionTopology::find_components() {
  component.assign(nodes.size(), -1);
  std::vector<Index> open;
  for (Index v = 0; v < vertex_count(); ++v) {
    if (component[v] >= 0) continue;
    const auto number = static_cast<Index>(component_first.size());
    component_first.push_back(v);
    component[v] = number;
    open.assign(1, v);
    while (!open.empty()) {
      const Index from = open.back();
      open.pop_back();
      for (const Index to : ring(from))
        if (component[to] < 0) {
          component[to] = number;
          open.push_back(to);
        }
    }
  }
}

std::size_t CollisionTopology::bytes() const {
  const std::size_t indices = nodes.size() + vertex_of_node.size() + 3 * corners.size() +
                              3 * triangle_edges.size() + ring_start.size() + ring_vertices.size() +
                              fan_start.size() + fan_triangles.size() + component.size() +
                              component_first.size();
  return indices * sizeof(Index) + edges.size() * sizeof(Edge);
}

}  // namespace souple
