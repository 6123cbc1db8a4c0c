// SPDX-License-Identifier: MIT
#include "formats/core/mesh.hpp"

#include <algorithm>

namespace souple {

std::vector<Triangle> boundary_triangles(const std::vector<Tet>& tets) {
  // Face k is opposite node k; wound outward for a positive tet.
  static constexpr int faces[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};
  struct Face {
    Triangle key;
    std::size_t order;
  };
  std::vector<Face> all;
  all.reserve(4 * tets.size());
  for (std::size_t t = 0; t < tets.size(); ++t)
    for (std::size_t k = 0; k < 4; ++k) {
      const auto& f = faces[k];
      Triangle key{tets[t][f[0]], tets[t][f[1]], tets[t][f[2]]};
      std::ranges::sort(key);
      all.push_back({key, 4 * t + k});
    }
  std::ranges::sort(all, [](const Face& a, const Face& b) {
    return a.key != b.key ? a.key < b.key : a.order < b.order;
  });
  std::vector<std::size_t> single;
  for (std::size_t i = 0; i < all.size();) {
    std::size_t j = i + 1;
    while (j < all.size() && all[j].key == all[i].key) ++j;
    if (j == i + 1) single.push_back(all[i].order);
    i = j;
  }
  std::ranges::sort(single);
  std::vector<Triangle> boundary;
  boundary.reserve(single.size());
  for (const std::size_t order : single) {
    const auto& tet = tets[order / 4];
    const auto& f = faces[order % 4];
    boundary.push_back({tet[f[0]], tet[f[1]], tet[f[2]]});
  }
  return boundary;
}

std::vector<Index> used_nodes(const std::vector<Triangle>& triangles) {
  std::vector<Index> nodes;
  nodes.reserve(3 * triangles.size());
  for (const auto& t : triangles) nodes.insert(nodes.end(), t.begin(), t.end());
  std::ranges::sort(nodes);
  nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
  return nodes;
}

double signed_volume6(const Point& a, const Point& b, const Point& c, const Point& d) {
  const double u[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]};
  const double v[3] = {c[0] - a[0], c[1] - a[1], c[2] - a[2]};
  const double w[3] = {d[0] - a[0], d[1] - a[1], d[2] - a[2]};
  return u[0] * (v[1] * w[2] - v[2] * w[1]) + u[1] * (v[2] * w[0] - v[0] * w[2]) +
         u[2] * (v[0] * w[1] - v[1] * w[0]);
}

}  // namespace souple
