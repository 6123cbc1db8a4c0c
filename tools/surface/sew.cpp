// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/surface/sew.hpp"

#include <algorithm>
#include <numeric>
#include <set>
#include <utility>

#include "tools/geometry/vector.hpp"
#include "tools/surface/boundary_loops.hpp"
#include "tools/surface/clean_soup.hpp"

namespace souple {
namespace {

std::size_t at(Index i) { return static_cast<std::size_t>(i); }

/// Vertices of the edges, sorted by x.
std::vector<Index> ends_by_x(const TriangleMesh& mesh, const std::vector<BoundaryEdge>& edges) {
  std::vector<Index> ends;
  for (const auto& [a, b] : edges) ends.insert(ends.end(), {a, b});
  std::ranges::sort(ends, [&](Index a, Index b) {
    return std::pair(mesh.vertices[at(a)], a) < std::pair(mesh.vertices[at(b)], b);
  });
  ends.erase(std::unique(ends.begin(), ends.end()), ends.end());
  return ends;
}

/// Those with x in [low, high].
std::pair<std::size_t, std::size_t> range_in_x(const TriangleMesh& mesh, const std::vector<Index>& by_x,
                                               double low, double high) {
  const auto x = [&](Index i) { return mesh.vertices[at(i)][0]; };
  return {static_cast<std::size_t>(std::ranges::lower_bound(by_x, low, {}, x) - by_x.begin()),
          static_cast<std::size_t>(std::ranges::upper_bound(by_x, high, {}, x) - by_x.begin())};
}

/// Candidates strictly between a and b on their segment, in order from a.
std::vector<Index> vertices_on_segment(const TriangleMesh& mesh, const std::vector<Index>& by_x,
                                       Index a, Index b, double tolerance) {
  const Point &p = mesh.vertices[at(a)], &q = mesh.vertices[at(b)];
  const Point along = subtract(q, p);
  const double length = norm(along);
  std::vector<std::pair<double, Index>> found;
  const auto [low, high] = std::minmax(p[0], q[0]);
  const auto [begin, end] = range_in_x(mesh, by_x, low - tolerance, high + tolerance);
  for (std::size_t k = begin; k < end; ++k) {
    const Index i = by_x[k];
    if (i == a || i == b) continue;
    const Point offset = subtract(mesh.vertices[at(i)], p);
    const double s = dot(offset, along) / length;
    if (s <= tolerance || s >= length - tolerance) continue;
    if (norm(add_scaled(offset, -s / length, along)) <= tolerance) found.emplace_back(s, i);
  }
  std::ranges::sort(found);
  std::vector<Index> on;
  for (const auto& [s, i] : found) on.push_back(i);
  return on;
}

}  // namespace

MendStep split_at_t_junctions(const TriangleMesh& mesh, double tolerance) {
  const std::vector<BoundaryEdge> edges = boundary_edges(mesh);
  const std::set<BoundaryEdge> open(edges.begin(), edges.end());
  const std::vector<Index> by_x = ends_by_x(mesh, edges);
  MendStep step{{mesh.vertices, {}}, 0};
  for (const Triangle& t : mesh.triangles) {
    // One side a pass; the next pass of the caller finds the other sides.
    bool is_split = false;
    for (std::size_t k = 0; k < 3 && !is_split; ++k) {
      const Index a = t[k], b = t[(k + 1) % 3], c = t[(k + 2) % 3];
      if (!open.contains(std::minmax(a, b))) continue;
      std::vector<Index> chain = vertices_on_segment(mesh, by_x, a, b, tolerance);
      std::erase(chain, c);
      if (chain.empty()) continue;
      is_split = true;
      ++step.count;
      chain.push_back(b);
      Index from = a;
      for (const Index to : chain) {
        step.mesh.triangles.push_back({from, to, c});
        from = to;
      }
    }
    if (!is_split) step.mesh.triangles.push_back(t);
  }
  return step;
}

MendStep merge_rim_vertices(const TriangleMesh& mesh, double tolerance) {
  const std::vector<Index> by_x = ends_by_x(mesh, boundary_edges(mesh));
  std::vector<Index> target(mesh.vertices.size());
  std::iota(target.begin(), target.end(), 0);
  MendStep step{mesh, 0};
  for (std::size_t k = 0; k < by_x.size(); ++k) {
    if (target[at(by_x[k])] != by_x[k]) continue;
    const Point& p = mesh.vertices[at(by_x[k])];
    for (std::size_t l = k + 1; l < by_x.size(); ++l) {
      const Point& q = mesh.vertices[at(by_x[l])];
      if (q[0] > p[0] + tolerance) break;
      if (target[at(by_x[l])] != by_x[l] || norm(subtract(q, p)) > tolerance) continue;
      target[at(by_x[l])] = by_x[k];
      ++step.count;
    }
  }
  for (Triangle& t : step.mesh.triangles)
    for (Index& i : t) i = target[at(i)];
  step.mesh = clean_soup(step.mesh).mesh;
  return step;
}

}  // namespace souple
