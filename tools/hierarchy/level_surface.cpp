// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/hierarchy/level_surface.hpp"

#include <algorithm>
#include <cmath>

#include "tools/geometry/vector.hpp"

namespace souple {
namespace {

std::size_t at(Index i) { return static_cast<std::size_t>(i); }

}  // namespace

Point area_vector(const Triangle& t, const std::vector<Point>& x) {
  const Point& a = x[at(t[0])];
  return cross(subtract(x[at(t[1])], a), subtract(x[at(t[2])], a));
}

LevelSurface::LevelSurface(const TetMesh& mesh, const std::vector<Triangle>& boundary)
    : nodes(used_nodes(boundary)), vertex_of(mesh.nodes.size(), -1), first_(nodes.size() + 1, 0) {
  for (std::size_t v = 0; v < nodes.size(); ++v) vertex_of[at(nodes[v])] = static_cast<Index>(v);
  triangles.reserve(boundary.size());
  for (const Triangle& t : boundary)
    triangles.push_back({vertex_of[at(t[0])], vertex_of[at(t[1])], vertex_of[at(t[2])]});
  for (const Triangle& t : triangles)
    for (const Index v : t) ++first_[at(v) + 1];
  for (std::size_t v = 1; v < first_.size(); ++v) first_[v] += first_[v - 1];
  around_.resize(3 * triangles.size());
  std::vector<std::size_t> next(first_.begin(), first_.end() - 1);
  for (std::size_t t = 0; t < triangles.size(); ++t)
    for (const Index v : triangles[t]) around_[next[at(v)]++] = static_cast<Index>(t);
}

std::vector<Point> LevelSurface::positions(const TetMesh& mesh) const {
  std::vector<Point> x;
  x.reserve(nodes.size());
  for (const Index i : nodes) x.push_back(mesh.nodes[at(i)]);
  return x;
}

Point LevelSurface::vertex_normal(const std::vector<Point>& x, std::size_t vertex) const {
  Point sum{};
  for (const Index t : triangles_of(vertex)) sum = add(sum, area_vector(triangles[at(t)], x));
  const double length = norm(sum);
  return length > 0 ? scaled(sum, 1 / length) : Point{};
}

std::vector<Point> LevelSurface::vertex_normals(const std::vector<Point>& x) const {
  std::vector<Point> normals;
  normals.reserve(nodes.size());
  for (std::size_t v = 0; v < nodes.size(); ++v) normals.push_back(vertex_normal(x, v));
  return normals;
}

double LevelSurface::reach(const std::vector<Point>& x, std::size_t vertex) const {
  double longest2 = 0;
  for (const Index t : triangles_of(vertex))
    for (const Index v : triangles[at(t)])
      longest2 = std::max(longest2, squared_norm(subtract(x[at(v)], x[vertex])));
  return std::sqrt(longest2);
}

}  // namespace souple
