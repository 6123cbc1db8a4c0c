// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/geometry/surface_measure.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <tuple>

#include "tools/geometry/vector.hpp"

namespace souple {
namespace {

const Point& vertex(const TriangleMesh& mesh, Index i) {
  return mesh.vertices[static_cast<std::size_t>(i)];
}

/// Union-find over 0 … n-1; the root is the smallest member.
class Groups {
 public:
  explicit Groups(std::size_t n) {
    parent_.reserve(n);
    for (std::size_t i = 0; i < n; ++i) parent_.push_back(i);
  }
  std::size_t root(std::size_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void join(std::size_t a, std::size_t b) {
    a = root(a);
    b = root(b);
    if (a != b) parent_[std::max(a, b)] = std::min(a, b);
  }

 private:
  std::vector<std::size_t> parent_;
};

/// A side of a triangle: `corner` is 3 t + k for the side from vertex k to vertex k + 1.
struct Side {
  Index low, high;
  std::size_t corner;
  bool ascending;
};

std::vector<Side> sorted_sides(const std::vector<Triangle>& triangles) {
  std::vector<Side> sides;
  sides.reserve(3 * triangles.size());
  for (std::size_t t = 0; t < triangles.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k) {
      const Index a = triangles[t][k], b = triangles[t][(k + 1) % 3];
      sides.push_back({std::min(a, b), std::max(a, b), 3 * t + k, a < b});
    }
  std::ranges::sort(sides, [](const Side& a, const Side& b) {
    return std::tie(a.low, a.high, a.corner) < std::tie(b.low, b.high, b.corner);
  });
  return sides;
}

/// Joins the corners that two neighbouring triangles have at the two ends of their common side.
void join_fans(Groups& corners, const std::vector<Triangle>& triangles, const Side& a, const Side& b) {
  const std::size_t ta = a.corner / 3, tb = b.corner / 3;
  for (const Index end : {a.low, a.high}) {
    const auto ka =
        static_cast<std::size_t>(std::ranges::find(triangles[ta], end) - triangles[ta].begin());
    const auto kb =
        static_cast<std::size_t>(std::ranges::find(triangles[tb], end) - triangles[tb].begin());
    corners.join(3 * ta + ka, 3 * tb + kb);
  }
}

std::size_t count_vertices_with_several_fans(Groups& corners, const std::vector<Triangle>& triangles,
                                             std::size_t vertex_count) {
  std::vector<std::size_t> fans(vertex_count, 0);
  for (std::size_t c = 0; c < 3 * triangles.size(); ++c)
    if (corners.root(c) == c) ++fans[static_cast<std::size_t>(triangles[c / 3][c % 3])];
  return static_cast<std::size_t>(std::ranges::count_if(fans, [](std::size_t n) { return n > 1; }));
}

}  // namespace

double signed_volume(const TriangleMesh& mesh) {
  const Box box = bounding_box(mesh.vertices);
  const Point middle = scaled(add(box.low, box.high), 0.5);
  double six = 0;
  for (const Triangle& t : mesh.triangles)
    six += signed_volume6(middle, vertex(mesh, t[0]), vertex(mesh, t[1]), vertex(mesh, t[2]));
  return six / 6;
}

double surface_area(const TriangleMesh& mesh) {
  double twice = 0;
  for (const Triangle& t : mesh.triangles)
    twice += norm(cross(subtract(vertex(mesh, t[1]), vertex(mesh, t[0])),
                        subtract(vertex(mesh, t[2]), vertex(mesh, t[0]))));
  return twice / 2;
}

SurfaceTopology measure_topology(const std::vector<Triangle>& triangles, std::size_t vertex_count) {
  SurfaceTopology topology;
  const std::vector<Side> sides = sorted_sides(triangles);
  Groups corners(3 * triangles.size());
  for (std::size_t i = 0; i < sides.size();) {
    std::size_t j = i + 1;
    while (j < sides.size() && sides[j].low == sides[i].low && sides[j].high == sides[i].high) {
      join_fans(corners, triangles, sides[i], sides[j]);
      ++j;
    }
    if (j - i == 1) ++topology.boundary_edge_count;
    if (j - i == 2 && sides[i].ascending == sides[i + 1].ascending) ++topology.opposed_edge_count;
    if (j - i > 2) ++topology.nonmanifold_edge_count;
    i = j;
  }
  topology.nonmanifold_vertex_count =
      count_vertices_with_several_fans(corners, triangles, vertex_count);
  const std::vector<Index> shells = shell_of_triangles(triangles, vertex_count);
  if (!shells.empty()) topology.shell_count = static_cast<std::size_t>(std::ranges::max(shells)) + 1;
  return topology;
}

Status check_triangle_mesh(const TriangleMesh& mesh) {
  if (mesh.triangles.empty()) return make_issue(IssueCode::surface_no_triangles, "no triangles");
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i)
    if (!is_finite(mesh.vertices[i]))
      return make_issue(IssueCode::surface_invalid, "vertex " + std::to_string(i) + " is not finite");
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const Triangle& v = mesh.triangles[t];
    const auto [low, high] = std::ranges::minmax(v);
    if (low < 0 || static_cast<std::size_t>(high) >= mesh.vertices.size())
      return make_issue(IssueCode::surface_invalid,
                        "triangle " + std::to_string(t) + " names a vertex outside the mesh");
    if (v[0] == v[1] || v[1] == v[2] || v[2] == v[0])
      return make_issue(IssueCode::surface_invalid,
                        "triangle " + std::to_string(t) + " names a vertex twice");
  }
  return {};
}

Status check_closed_oriented_manifold(const TriangleMesh& mesh) {
  if (const Status valid = check_triangle_mesh(mesh); !valid) return valid;
  const SurfaceTopology found = measure_topology(mesh.triangles, mesh.vertices.size());
  if (found.nonmanifold_edge_count > 0)
    return make_issue(IssueCode::surface_not_manifold, std::to_string(found.nonmanifold_edge_count) +
                                                           " edges have more than two triangles");
  if (found.boundary_edge_count > 0)
    return make_issue(IssueCode::surface_not_closed,
                      std::to_string(found.boundary_edge_count) + " open edges");
  if (found.opposed_edge_count > 0)
    return make_issue(IssueCode::surface_not_orientable,
                      std::to_string(found.opposed_edge_count) +
                          " edges lie between triangles of opposite orientation");
  if (found.nonmanifold_vertex_count > 0)
    return make_issue(IssueCode::surface_not_manifold, std::to_string(found.nonmanifold_vertex_count) +
                                                           " vertices join several fans of triangles");
  return {};
}

std::vector<Index> shell_of_triangles(const std::vector<Triangle>& triangles,
                                      std::size_t vertex_count) {
  Groups vertices(vertex_count);
  for (const Triangle& t : triangles)
    for (const std::size_t k : {1, 2})
      vertices.join(static_cast<std::size_t>(t[0]), static_cast<std::size_t>(t[k]));
  std::vector<Index> number(vertex_count, -1), shells;
  shells.reserve(triangles.size());
  Index next = 0;
  for (const Triangle& t : triangles) {
    Index& shell = number[vertices.root(static_cast<std::size_t>(t[0]))];
    if (shell < 0) shell = next++;
    shells.push_back(shell);
  }
  return shells;
}

SurfaceDistance distance_from_surface(const std::vector<Point>& points, const TriangleBvh& surface) {
  SurfaceDistance distance;
  double sum = 0;
  for (const Point& p : points) {
    const double squared = surface.closest(p).squared_distance;
    distance.largest = std::max(distance.largest, squared);
    sum += squared;
  }
  distance.largest = std::sqrt(distance.largest);
  if (!points.empty()) distance.root_mean_square = std::sqrt(sum / static_cast<double>(points.size()));
  return distance;
}

std::vector<Point> sample_surface(const TriangleMesh& mesh) {
  std::vector<Point> samples = mesh.vertices;
  samples.reserve(mesh.vertices.size() + 4 * mesh.triangles.size());
  for (const Triangle& t : mesh.triangles) {
    const Point &a = vertex(mesh, t[0]), &b = vertex(mesh, t[1]), &c = vertex(mesh, t[2]);
    samples.push_back(scaled(add(a, b), 0.5));
    samples.push_back(scaled(add(b, c), 0.5));
    samples.push_back(scaled(add(c, a), 0.5));
    samples.push_back(scaled(add(add(a, b), c), 1.0 / 3.0));
  }
  return samples;
}

}  // namespace souple
