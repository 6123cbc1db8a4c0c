// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/surface/clean_soup.hpp"

#include <algorithm>
#include <numeric>
#include <vector>

#include "tools/geometry/surface_measure.hpp"
#include "tools/geometry/vector.hpp"

namespace souple {
namespace {

std::size_t at(Index i) { return static_cast<std::size_t>(i); }

/// Twice the area is zero to the last bit, with the mesh brought to unit size so that nothing
/// underflows.
bool has_area(const Triangle& t, const std::vector<Point>& x, double unit) {
  const Point u = scaled(subtract(x[at(t[1])], x[at(t[0])]), unit);
  const Point v = scaled(subtract(x[at(t[2])], x[at(t[0])]), unit);
  return squared_norm(cross(u, v)) > 0;
}

void keep_used_vertices(const std::vector<Point>& points, TriangleMesh& mesh) {
  std::vector<Index> number(points.size(), -1);
  for (Triangle& t : mesh.triangles)
    for (Index& i : t) {
      if (number[at(i)] < 0) {
        number[at(i)] = static_cast<Index>(mesh.vertices.size());
        mesh.vertices.push_back(points[at(i)]);
      }
      i = number[at(i)];
    }
}

}  // namespace

std::vector<Index> first_at_position(const std::vector<Point>& points) {
  std::vector<Index> order(points.size()), first(points.size());
  std::iota(order.begin(), order.end(), 0);
  std::ranges::sort(order, [&](Index a, Index b) {
    return points[at(a)] != points[at(b)] ? points[at(a)] < points[at(b)] : a < b;
  });
  for (std::size_t k = 0; k < order.size(); ++k) {
    const bool repeats = k > 0 && points[at(order[k])] == points[at(order[k - 1])];
    first[at(order[k])] = repeats ? first[at(order[k - 1])] : order[k];
  }
  return first;
}

std::vector<bool> repeated_triangles(const std::vector<Triangle>& triangles) {
  std::vector<std::pair<Triangle, std::size_t>> keys;
  keys.reserve(triangles.size());
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    Triangle key = triangles[t];
    std::ranges::sort(key);
    keys.emplace_back(key, t);
  }
  std::ranges::sort(keys);
  std::vector<bool> result(triangles.size(), false);
  for (std::size_t k = 1; k < keys.size(); ++k)
    if (keys[k].first == keys[k - 1].first) result[keys[k].second] = true;
  return result;
}

CleanedSoup clean_soup(const TriangleMesh& soup) {
  CleanedSoup cleaned;
  const std::vector<Index> first = first_at_position(soup.vertices);
  for (std::size_t i = 0; i < first.size(); ++i)
    if (at(first[i]) == i) ++cleaned.merged_vertex_count;
  const double size = longest_side(bounding_box(soup.vertices));
  std::vector<Triangle> triangles;
  for (const Triangle& t : soup.triangles) {
    const Triangle merged{first[at(t[0])], first[at(t[1])], first[at(t[2])]};
    if (size > 0 && has_area(merged, soup.vertices, 1 / size)) triangles.push_back(merged);
  }
  const std::vector<bool> repeats = repeated_triangles(triangles);
  for (std::size_t t = 0; t < triangles.size(); ++t)
    if (!repeats[t]) cleaned.mesh.triangles.push_back(triangles[t]);
  cleaned.dropped_triangle_count = soup.triangles.size() - cleaned.mesh.triangles.size();
  keep_used_vertices(soup.vertices, cleaned.mesh);
  return cleaned;
}

}  // namespace souple
