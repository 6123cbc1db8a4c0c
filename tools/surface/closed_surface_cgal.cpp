// SPDX-License-Identifier: GPL-3.0-or-later
// Orientation and decimation share this file: both need the same heavy CGAL headers.
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/orient_polygon_soup.h>
#include <CGAL/Polygon_mesh_processing/orientation.h>
#include <CGAL/Polygon_mesh_processing/self_intersections.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/Bounded_normal_change_filter.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/Count_stop_predicate.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/LindstromTurk_cost.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/LindstromTurk_placement.h>
#include <CGAL/Surface_mesh_simplification/edge_collapse.h>

#include <algorithm>
#include <exception>
#include <string>
#include <utility>
#include <vector>

#include "tools/geometry/surface_measure.hpp"
#include "tools/geometry/vector.hpp"
#include "tools/surface/clean_soup.hpp"
#include "tools/surface/decimate.hpp"
#include "tools/surface/prepare.hpp"

namespace souple {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Surface = CGAL::Surface_mesh<Kernel::Point_3>;
namespace pmp = CGAL::Polygon_mesh_processing;
namespace sms = CGAL::Surface_mesh_simplification;

/// Of the cube of the longest side; below it there is nothing to mesh.
constexpr double least_volume = 1e-9;

std::size_t at(Index i) { return static_cast<std::size_t>(i); }

/// Faces and vertices keep their order; the mesh must be manifold.
Surface to_cgal(const TriangleMesh& mesh) {
  Surface surface;
  std::vector<Surface::Vertex_index> v;
  for (const Point& p : mesh.vertices) v.push_back(surface.add_vertex({p[0], p[1], p[2]}));
  for (const Triangle& t : mesh.triangles) surface.add_face(v[at(t[0])], v[at(t[1])], v[at(t[2])]);
  return surface;
}

TriangleMesh to_plain(Surface& surface) {
  surface.collect_garbage();
  TriangleMesh mesh;
  for (const auto v : surface.vertices()) {
    const auto& p = surface.point(v);
    mesh.vertices.push_back({p.x(), p.y(), p.z()});
  }
  for (const auto f : surface.faces()) {
    Triangle& triangle = mesh.triangles.emplace_back();
    std::size_t k = 0;
    for (const auto v : surface.vertices_around_face(surface.halfedge(f)))
      triangle[k++] = static_cast<Index>(v.idx());
  }
  return mesh;
}

/// Consistent orientation by neighbourhood; vertices with several fans are split.
TriangleMesh orient_consistently(const TriangleMesh& mesh) {
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

void turn_all(TriangleMesh& mesh) {
  for (Triangle& t : mesh.triangles) std::swap(t[1], t[2]);
}

bool share_a_place(const TriangleMesh& mesh, const Triangle& a, const Triangle& b) {
  for (const Index i : a)
    for (const Index j : b)
      if (mesh.vertices[at(i)] == mesh.vertices[at(j)]) return true;
  return false;
}

/// Pairs within one shell; an issue if triangles of two shells cut each other. Shells that only touch
/// in a common corner are let pass.
Result<std::size_t> count_self_intersections(const TriangleMesh& mesh, const Surface& surface) {
  std::vector<std::pair<Surface::Face_index, Surface::Face_index>> pairs;
  pmp::self_intersections(surface, std::back_inserter(pairs));
  const std::vector<Index> shell = shell_of_triangles(mesh.triangles, mesh.vertices.size());
  std::size_t within = 0, across = 0;
  for (const auto& [f, g] : pairs) {
    const auto a = static_cast<std::size_t>(f.idx()), b = static_cast<std::size_t>(g.idx());
    if (shell[a] == shell[b])
      ++within;
    else if (!share_a_place(mesh, mesh.triangles[a], mesh.triangles[b]))
      ++across;
  }
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
  out.mesh = orient_consistently(merged);
  const SurfaceTopology topology = measure_topology(out.mesh.triangles, out.mesh.vertices.size());
  if (!topology.closed_oriented_manifold())
    return make_issue(IssueCode::surface_not_orientable, "the surface is one-sided");
  out.report.shell_count = topology.shell_count;
  out.report.split_vertex_count = out.mesh.vertices.size() - merged.vertices.size();

  Surface cgal = to_cgal(out.mesh);
  const Result<std::size_t> cuts = count_self_intersections(out.mesh, cgal);
  if (!cuts) return cuts.issue();
  out.report.self_intersection_count = *cuts;
  if (topology.shell_count > 1) {
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

void collapse_edges(Surface& surface, std::size_t faces) {
  // A closed triangle mesh has 3/2 edges a face; the predicate stops below its number.
  const sms::Count_stop_predicate<Surface> stop(faces * 3 / 2 + 1);
  const sms::LindstromTurk_cost<Surface> cost;
  const sms::LindstromTurk_placement<Surface> placement;
  sms::edge_collapse(surface, stop,
                     CGAL::parameters::get_cost(cost).get_placement(placement).filter(
                         sms::Bounded_normal_change_filter<>()));
  if (surface.number_of_faces() > faces)
    sms::edge_collapse(surface, stop, CGAL::parameters::get_cost(cost).get_placement(placement));
}

DecimateReport report_of(const TriangleMesh& before, const TriangleMesh& after) {
  const TriangleBvh original(before);
  return {before.triangles.size(), after.triangles.size(), signed_volume(before), signed_volume(after),
          distance_from_surface(sample_surface(after), original).largest};
}

Result<DecimatedSurface> decimate(const TriangleMesh& surface, std::size_t faces) {
  if (faces < 4)
    return make_issue(IssueCode::usage_bad_value, "a closed surface needs 4 faces or more");
  if (const Status valid = check_closed_oriented_manifold(surface); !valid) return valid.issue();
  if (surface.triangles.size() <= faces) {
    const double volume = signed_volume(surface);
    return DecimatedSurface{surface,
                            {surface.triangles.size(), surface.triangles.size(), volume, volume, 0}};
  }
  // At unit size, so that no tolerance inside depends on the units.
  const Box box = bounding_box(surface.vertices);
  const double size = longest_side(box);
  TriangleMesh unit = surface;
  for (Point& p : unit.vertices) p = scaled(subtract(p, box.low), 1 / size);
  Surface cgal = to_cgal(unit);
  collapse_edges(cgal, faces);
  DecimatedSurface out;
  out.mesh = to_plain(cgal);
  if (out.mesh.triangles.size() > faces)
    return make_issue(
        IssueCode::decimation_failed,
        "no edge can be collapsed below " + std::to_string(out.mesh.triangles.size()) + " faces");
  for (Point& p : out.mesh.vertices) p = add_scaled(box.low, size, p);
  if (const Status sound = check_closed_oriented_manifold(out.mesh); !sound)
    return make_issue(IssueCode::decimation_failed, "the result is not sound: " + sound.issue().what);
  out.report = report_of(surface, out.mesh);
  if (!(out.report.volume_after_m3 > 0))
    return make_issue(IssueCode::decimation_failed, "the result encloses no volume");
  return out;
}

}  // namespace

Result<OrientedSurface> orient_closed_surface(const TriangleMesh& surface) try {
  return orient(surface);
} catch (const std::exception& e) {
  return make_issue(IssueCode::surface_not_orientable, e.what());
}

Result<DecimatedSurface> decimate_surface(const TriangleMesh& surface,
                                          const DecimateOptions& options) try {
  return decimate(surface, options.target_face_count);
} catch (const std::exception& e) {
  return make_issue(IssueCode::decimation_failed, e.what());
}

}  // namespace souple
