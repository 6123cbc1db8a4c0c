// SPDX-License-Identifier: GPL-3.0-or-later
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/border.h>
#include <CGAL/Polygon_mesh_processing/manifoldness.h>
#include <CGAL/Polygon_mesh_processing/orientation.h>
#include <CGAL/Polygon_mesh_processing/repair.h>
#include <CGAL/Polygon_mesh_processing/repair_degeneracies.h>
#include <CGAL/Polygon_mesh_processing/repair_self_intersections.h>
#include <CGAL/Polygon_mesh_processing/stitch_borders.h>
#include <CGAL/Polygon_mesh_processing/triangulate_hole.h>
#include <CGAL/Surface_mesh.h>

#include <algorithm>
#include <iterator>
#include <set>
#include <utility>

#include "tools/surface/canonical_flips.hpp"
#include "tools/surface/mend_steps.hpp"
#include "tools/surface/orient_soup.hpp"
#include "tools/surface/pull_apart.hpp"
#include "tools/surface/self_intersections.hpp"
#include "tools/surface/surface_conversion.hpp"

namespace souple {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Surface = CGAL::Surface_mesh<Kernel::Point_3>;
using Halfedge = Surface::Halfedge_index;
namespace pmp = CGAL::Polygon_mesh_processing;

std::size_t at(Index i) { return static_cast<std::size_t>(i); }

TriangleMesh without_lone_vertices(Surface& surface) {
  pmp::remove_isolated_vertices(surface);
  return to_plain(surface);
}

struct Rim {
  Halfedge halfedge;
  std::size_t edge_count = 0;
  double perimeter = 0;
};

std::vector<Rim> find_rims(const Surface& surface) {
  std::vector<Halfedge> cycles;
  pmp::extract_boundary_cycles(surface, std::back_inserter(cycles));
  std::vector<Rim> rims;
  for (const Halfedge first : cycles) {
    Rim rim{first};
    for (const Halfedge h : surface.halfedges_around_face(first)) {
      ++rim.edge_count;
      rim.perimeter += std::sqrt(
          CGAL::squared_distance(surface.point(surface.source(h)), surface.point(surface.target(h))));
    }
    rims.push_back(rim);
  }
  return rims;
}

/// Edges of a rim up to which a patch is sought among all triangulations of the rim: it takes the same
/// one always, in a time that grows with the cube of the edges. The search within the Delaunay
/// triangulation of the rim cuts other triangles less often where holes are wide, but among equally
/// good patches it takes one by memory addresses.
constexpr std::size_t full_search_of_holes = 8, full_search_of_cuts = 200;

std::set<Surface::Edge_index> edges_within(const Surface& surface,
                                           const std::vector<Surface::Face_index>& faces) {
  const std::set<Surface::Face_index> chosen(faces.begin(), faces.end());
  std::set<Surface::Edge_index> edges;
  for (const Surface::Face_index f : faces)
    for (const Halfedge h : surface.halfedges_around_face(surface.halfedge(f)))
      if (chosen.contains(surface.face(surface.opposite(h)))) edges.insert(surface.edge(h));
  return edges;
}

bool close_rim(Surface& surface, const Rim& rim, std::size_t most_of_full_search) {
  const bool is_small = rim.edge_count <= most_of_full_search;
  const auto how =
      CGAL::parameters::use_2d_constrained_delaunay_triangulation(false).use_delaunay_triangulation(
          !is_small);
  std::vector<Surface::Face_index> faces;
  pmp::triangulate_hole(surface, rim.halfedge, std::back_inserter(faces), how);
  if (!is_small) CanonicalFlips<Kernel, Surface>(surface, edges_within(surface, faces)).run();
  return !faces.empty();
}

std::size_t close_rims(Surface& surface, std::size_t most_edges, double longest,
                       std::size_t full_search) {
  std::size_t closed = 0;
  for (const Rim& rim : find_rims(surface))
    if (rim.edge_count <= most_edges && rim.perimeter <= longest &&
        close_rim(surface, rim, full_search))
      ++closed;
  return closed;
}

/// The triangles, grown by rings over common vertices.
std::vector<bool> grown(const TriangleMesh& mesh, std::vector<bool> chosen, std::size_t rings) {
  for (std::size_t ring = 0; ring < rings; ++ring) {
    std::vector<bool> touched(mesh.vertices.size(), false);
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
      if (chosen[t])
        for (const Index i : mesh.triangles[t]) touched[at(i)] = true;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
      for (const Index i : mesh.triangles[t])
        if (touched[at(i)]) chosen[t] = true;
  }
  return chosen;
}

}  // namespace

MendStep orient_and_cut(const TriangleMesh& mesh) {
  Surface surface = to_surface<Surface>(orient_soup(mesh));
  pmp::stitch_borders(surface, CGAL::parameters::apply_per_connected_component(true));
  pmp::stitch_borders(surface);
  pmp::merge_reversible_connected_components(surface);
  pmp::duplicate_non_manifold_vertices(surface);
  TriangleMesh sewn = without_lone_vertices(surface);
  const std::size_t added = sewn.vertices.size() - std::min(sewn.vertices.size(), mesh.vertices.size());
  return {std::move(sewn), added};
}

MendStep remove_slivers(const TriangleMesh& mesh) {
  Surface surface = to_surface<Surface>(mesh);
  pmp::remove_degenerate_faces(surface);
  TriangleMesh less = without_lone_vertices(surface);
  const std::size_t removed =
      mesh.triangles.size() - std::min(mesh.triangles.size(), less.triangles.size());
  return {std::move(less), removed};
}

MendStep fill_holes(const TriangleMesh& mesh, std::size_t most_edges, double longest) {
  Surface surface = to_surface<Surface>(mesh);
  const std::size_t closed = close_rims(surface, most_edges, longest, full_search_of_holes);
  return {without_lone_vertices(surface), closed};
}

MendStep remove_intersections(const TriangleMesh& mesh) {
  Surface surface = to_surface<Surface>(mesh);
  pmp::experimental::remove_self_intersections(surface, CGAL::parameters::preserve_genus(false));
  TriangleMesh mended = without_lone_vertices(surface);
  const auto before = mesh.triangles.size(), after = mended.triangles.size();
  return {std::move(mended), before > after ? before - after : after - before};
}

MendStep cut_out_intersections(const TriangleMesh& mesh, std::size_t rings) {
  std::vector<bool> chosen(mesh.triangles.size(), false);
  for (const auto& [a, b] : find_self_intersections(mesh).pairs) chosen[at(a)] = chosen[at(b)] = true;
  const std::vector<bool> crowded = vertices_at_crowded_edges(mesh);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    if (std::ranges::count_if(mesh.triangles[t], [&](Index i) { return crowded[at(i)]; }) > 1)
      chosen[t] = true;
  chosen = grown(mesh, std::move(chosen), rings);
  TriangleMesh rest{mesh.vertices, {}};
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    if (!chosen[t]) rest.triangles.push_back(mesh.triangles[t]);
  const std::size_t removed = mesh.triangles.size() - rest.triangles.size();
  Surface surface = to_surface<Surface>(orient_soup(rest));
  pmp::duplicate_non_manifold_vertices(surface);
  close_rims(surface, 1000, 10, full_search_of_cuts);
  return {without_lone_vertices(surface), removed};
}

}  // namespace souple
