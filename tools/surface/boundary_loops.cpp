// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/surface/boundary_loops.hpp"

#include <algorithm>
#include <map>
#include <numeric>

#include "tools/geometry/vector.hpp"

namespace souple {
namespace {

std::size_t at(Index i) { return static_cast<std::size_t>(i); }

/// As the triangles run through them.
std::vector<BoundaryEdge> directed_boundary_edges(const TriangleMesh& mesh) {
  std::vector<std::pair<BoundaryEdge, bool>> sides;  // whether it descends
  sides.reserve(3 * mesh.triangles.size());
  for (const Triangle& t : mesh.triangles)
    for (std::size_t k = 0; k < 3; ++k)
      sides.push_back({std::minmax({t[k], t[(k + 1) % 3]}), t[k] > t[(k + 1) % 3]});
  std::ranges::sort(sides);
  std::vector<BoundaryEdge> single;
  for (std::size_t i = 0; i < sides.size();) {
    std::size_t j = i + 1;
    while (j < sides.size() && sides[j].first == sides[i].first) ++j;
    const auto& [edge, descends] = sides[i];
    if (j - i == 1) single.push_back(descends ? BoundaryEdge{edge.second, edge.first} : edge);
    i = j;
  }
  return single;
}

}  // namespace

std::vector<BoundaryEdge> boundary_edges(const TriangleMesh& mesh) {
  std::vector<BoundaryEdge> edges = directed_boundary_edges(mesh);
  for (BoundaryEdge& edge : edges) edge = std::minmax({edge.first, edge.second});
  return edges;
}

std::vector<BoundaryLoop> find_boundary_loops(const TriangleMesh& mesh) {
  const std::vector<BoundaryEdge> edges = directed_boundary_edges(mesh);
  std::vector<Index> group(mesh.vertices.size());
  std::iota(group.begin(), group.end(), 0);
  const auto root = [&](Index i) {
    while (group[at(i)] != i) i = group[at(i)] = group[at(group[at(i)])];
    return i;
  };
  for (const auto& [a, b] : edges) {
    const auto [low, high] = std::minmax({root(a), root(b)});
    group[at(high)] = low;
  }
  std::map<Index, std::vector<BoundaryEdge>> rims;
  for (const BoundaryEdge& edge : edges) rims[root(edge.first)].push_back(edge);
  std::vector<BoundaryLoop> loops;
  for (const auto& [first, rim] : rims) {
    BoundaryLoop& loop = loops.emplace_back();
    loop.edge_count = rim.size();
    Point middle{};
    for (const auto& [a, b] : rim)
      middle = add_scaled(middle, 0.5 / static_cast<double>(rim.size()),
                          add(mesh.vertices[at(a)], mesh.vertices[at(b)]));
    Point shadow{};
    for (const auto& [a, b] : rim) {
      const Point p = subtract(mesh.vertices[at(a)], middle),
                  q = subtract(mesh.vertices[at(b)], middle);
      loop.perimeter_m += norm(subtract(q, p));
      shadow = add(shadow, cross(p, q));
    }
    loop.lid_area_m2 = norm(shadow) / 2;
  }
  return loops;
}

}  // namespace souple
