// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/surface/pull_apart.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "tools/geometry/surface_measure.hpp"
#include "tools/geometry/unit_frame.hpp"
#include "tools/geometry/vector.hpp"
#include "tools/surface/clean_soup.hpp"
#include "tools/surface/self_intersections.hpp"

namespace souple {
namespace {

constexpr double widest_gap = 0x1p-13;
/// Of the shortest edge at the vertex.
constexpr double gap_over_edge = 0.2;

std::size_t at(Index i) { return static_cast<std::size_t>(i); }

struct Surroundings {
  Point area{};  ///< sum of the area vectors of the triangles around
  double shortest_edge = std::numeric_limits<double>::infinity();
};

std::vector<Surroundings> surroundings_of(const TriangleMesh& mesh) {
  std::vector<Surroundings> around(mesh.vertices.size());
  for (const Triangle& t : mesh.triangles) {
    const Point &a = mesh.vertices[at(t[0])], &b = mesh.vertices[at(t[1])],
                &c = mesh.vertices[at(t[2])];
    const Point area = cross(subtract(b, a), subtract(c, a));
    for (std::size_t k = 0; k < 3; ++k) {
      Surroundings& here = around[at(t[k])];
      here.area = add(here.area, area);
      const double edge = norm(subtract(mesh.vertices[at(t[(k + 1) % 3])], mesh.vertices[at(t[k])]));
      here.shortest_edge = std::min(here.shortest_edge, edge);
      Surroundings& there = around[at(t[(k + 1) % 3])];
      there.shortest_edge = std::min(there.shortest_edge, edge);
    }
  }
  return around;
}

/// `sense` -1: into the solid.
MendStep moved(const TriangleMesh& mesh, double sense) {
  MendStep step{mesh, 0};
  const std::vector<bool> chosen = vertices_at_crowded_edges(mesh);
  const std::vector<Surroundings> around = surroundings_of(mesh);
  for (std::size_t v = 0; v < chosen.size(); ++v) {
    const double area = norm(around[v].area);
    if (!chosen[v] || !(area > 0)) continue;
    const double gap = std::min(widest_gap, gap_over_edge * around[v].shortest_edge);
    step.mesh.vertices[v] =
        on_unit_grid(add_scaled(mesh.vertices[v], sense * gap / area, around[v].area));
    ++step.count;
  }
  return step;
}

}  // namespace

std::size_t crowded_edge_count(const TriangleMesh& mesh) {
  const TriangleMesh merged = clean_soup(mesh).mesh;
  return measure_topology(merged.triangles, merged.vertices.size()).nonmanifold_edge_count;
}

std::vector<bool> vertices_at_crowded_edges(const TriangleMesh& mesh) {
  const std::vector<Index> first = first_at_position(mesh.vertices);
  std::vector<std::pair<Index, Index>> sides;
  for (const Triangle& t : mesh.triangles)
    for (std::size_t k = 0; k < 3; ++k)
      sides.push_back(std::minmax({first[at(t[k])], first[at(t[(k + 1) % 3])]}));
  std::ranges::sort(sides);
  std::vector<bool> crowded(mesh.vertices.size(), false);  // first vertices only
  for (std::size_t i = 0; i + 2 < sides.size(); ++i)
    if (sides[i] == sides[i + 2]) crowded[at(sides[i].first)] = crowded[at(sides[i].second)] = true;
  std::vector<bool> result(mesh.vertices.size());
  for (std::size_t v = 0; v < result.size(); ++v) result[v] = crowded[at(first[v])];
  return result;
}

MendStep pull_apart_touching_edges(const TriangleMesh& mesh) {
  if (crowded_edge_count(mesh) == 0) return {mesh, 0};
  const std::size_t cuts = find_self_intersections(mesh).pairs.size();
  for (const double sense : {-1.0, 1.0}) {
    MendStep step = moved(mesh, sense);
    if (crowded_edge_count(step.mesh) == 0 && find_self_intersections(step.mesh).pairs.size() <= cuts)
      return step;
  }
  return {mesh, 0};
}

}  // namespace souple
