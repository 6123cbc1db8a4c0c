// SPDX-License-Identifier: GPL-3.0-or-later
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/orient_polygon_soup.h>
#include <CGAL/Polygon_mesh_processing/orientation.h>
#include <CGAL/Surface_mesh.h>

#include <algorithm>
#include <exception>
#include <string>
#include <utility>
#include <vector>

#include "tools/geometry/surface_measure.hpp"
#include "tools/geometry/vector.hpp"
#include "tools/surface/clean_soup.hpp"
#include "tools/surface/orient_soup.hpp"
#include "tools/surface/prepare.hpp"
#include "tools/surface/self_intersections.hpp"
#include "tools/surface/surface_conversion.hpp"

namespace souple {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Surface = CGAL::Surface_mesh<Kernel::Point_3>;
namespace pmp = CGAL::Polygon_mesh_processing;

/// Of the cube of the longest side; below it there is nothing to mesh.
constexpr double least_volume = 1e-9;

std::size_t at(Index i) { return static_cast<std::size_t>(i); }

void turn_all(TriangleMesh& mesh) {
  for (Triangle& t : mesh.triangles) std::swap(t[1], t[2]);
}

/// Pairs within one shell; an issue if triangles of two shells cut each other.
Result<std::size_t> count_self_intersections(const TriangleMesh& mesh) {
  const std::vector<Index> shell = shell_of_triangles(mesh.triangles, mesh.vertices.size());
  std::size_t within = 0, across = 0;
  for (const auto& [a, b] : find_self_intersections(mesh).pairs)
    ++(shell[at(a)] == shell[at(b)] ? within : across);
  if (across > 0)
    return make_issue(IssueCode::surface_shells_cross,
                      std::to_string(across) + " pairs of triangles of different shells intersect");
  return within;
}

std::size_t count_turned(const TriangleMesh& before, const TriangleMesh& after) {
  const auto normal = [](const TriangleMesh& m, const Triangle& t) {
    return cross(subtract(m.vertices[at(t[1])], m.vertices[at(t[0])]),
                 subtract(m.vertices[at(t[2])], m.vertices[at(t[0])]));
  };
  std::size_t turned = 0;
  for (std::size_t t = 0; t < after.triangles.size(); ++t)
    if (dot(normal(before, before.triangles[t]), normal(after, after.triangles[t])) < 0) ++turned;
  return turned;
}

Status check_closed(const TriangleMesh& mesh) {
  if (mesh.triangles.empty()) return make_issue(IssueCode::surface_no_triangles, "no triangles");
  const SurfaceTopology found = measure_topology(mesh.triangles, mesh.vertices.size());
  const std::string counts = std::to_string(found.boundary_edge_count) + " open edges, " +
                             std::to_string(found.nonmanifold_edge_count) +
                             " edges of more than two triangles";
  if (found.nonmanifold_edge_count > 0) return make_issue(IssueCode::surface_not_manifold, counts);
  if (found.boundary_edge_count > 0) return make_issue(IssueCode::surface_not_closed, counts);
  return {};
}

Result<OrientedSurface> orient(const TriangleMesh& surface) {
  if (const Status valid = check_triangle_mesh(surface); !valid) return valid.issue();
  const TriangleMesh merged = clean_soup(surface).mesh;
  if (const Status closed = check_closed(merged); !closed) return closed.issue();
  OrientedSurface out;
  out.mesh = orient_soup(merged);
  const SurfaceTopology topology = measure_topology(out.mesh.triangles, out.mesh.vertices.size());
  if (!topology.closed_oriented_manifold())
    return make_issue(IssueCode::surface_not_orientable, "the surface is one-sided");
  out.report.shell_count = topology.shell_count;
  out.report.split_vertex_count = out.mesh.vertices.size() - merged.vertices.size();

  const Result<std::size_t> cuts = count_self_intersections(out.mesh);
  if (!cuts) return cuts.issue();
  out.report.self_intersection_count = *cuts;
  if (topology.shell_count > 1) {
    Surface cgal = to_surface<Surface>(out.mesh);
    pmp::orient_to_bound_a_volume(cgal);
    out.mesh = to_plain(cgal);
  }
  if (signed_volume(out.mesh) < 0) turn_all(out.mesh);
  out.report.volume_m3 = signed_volume(out.mesh);
  const double size = longest_side(bounding_box(out.mesh.vertices));
  if (!(out.report.volume_m3 > least_volume * size * size * size))
    return make_issue(IssueCode::surface_no_volume,
                      "the enclosed volume is " + std::to_string(out.report.volume_m3) + " m3");
  out.report.turned_triangle_count = count_turned(merged, out.mesh);
  return out;
}

}  // namespace

TriangleMesh orient_soup(const TriangleMesh& mesh) {
  std::vector<Kernel::Point_3> points;
  for (const Point& p : mesh.vertices) points.emplace_back(p[0], p[1], p[2]);
  std::vector<std::vector<std::size_t>> polygons;
  for (const Triangle& t : mesh.triangles) polygons.push_back({at(t[0]), at(t[1]), at(t[2])});
  pmp::orient_polygon_soup(points, polygons);
  TriangleMesh oriented;
  for (const auto& p : points) oriented.vertices.push_back({p.x(), p.y(), p.z()});
  for (const auto& p : polygons)
    oriented.triangles.push_back(
        {static_cast<Index>(p[0]), static_cast<Index>(p[1]), static_cast<Index>(p[2])});
  return oriented;
}

Result<OrientedSurface> orient_closed_surface(const TriangleMesh& surface) try {
  return orient(surface);
} catch (const std::exception& e) {
  return make_issue(IssueCode::surface_not_orientable, e.what());
}

}  // namespace souple
