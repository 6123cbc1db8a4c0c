// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/volume/volume_checks.hpp"

#include <string>

#include "tools/geometry/surface_measure.hpp"

namespace souple {
namespace {

/// Below that fraction of the surface's volume, parts of the shape are missing.
constexpr double least_volume_kept = 0.75, most_volume_gained = 1.25;

}  // namespace

double volume_of(const TetMesh& mesh) {
  double sum = 0;
  for (const Tet& t : mesh.tets) {
    const auto node = [&](std::size_t k) { return mesh.nodes[static_cast<std::size_t>(t[k])]; };
    sum += signed_volume6(node(0), node(1), node(2), node(3)) / 6;
  }
  return sum;
}

Status check_tets(const TetMesh& mesh) {
  for (std::size_t t = 0; t < mesh.tets.size(); ++t) {
    const auto node = [&](std::size_t k) {
      return mesh.nodes[static_cast<std::size_t>(mesh.tets[t][k])];
    };
    if (!(signed_volume6(node(0), node(1), node(2), node(3)) > 0))
      return make_issue(IssueCode::meshing_failed, "tet " + std::to_string(t) + " came out flat");
  }
  return {};
}

Status check_boundary(const TetMesh& mesh) {
  if (mesh.tets.empty()) return make_issue(IssueCode::meshing_lost_volume, "the mesh came out empty");
  const SurfaceTopology found = measure_topology(boundary_triangles(mesh.tets), mesh.nodes.size());
  if (!found.closed_oriented_manifold())
    return make_issue(IssueCode::meshing_boundary_not_manifold,
                      std::to_string(found.nonmanifold_edge_count) + " edges and " +
                          std::to_string(found.nonmanifold_vertex_count) + " nodes of the boundary");
  return {};
}

Status check_against_surface(const TetMesh& mesh, const TriangleMesh& surface) {
  if (const Status sound = check_boundary(mesh); !sound) return sound;
  const double kept = volume_of(mesh) / signed_volume(surface);
  if (!(kept >= least_volume_kept && kept <= most_volume_gained))
    return make_issue(IssueCode::meshing_lost_volume,
                      "the tets fill " + std::to_string(100 * kept) + " % of the surface's volume");
  const auto found = measure_topology(boundary_triangles(mesh.tets), mesh.nodes.size()).shell_count;
  const auto asked = measure_topology(surface.triangles, surface.vertices.size()).shell_count;
  if (found < asked)
    return make_issue(IssueCode::meshing_lost_volume, "of " + std::to_string(asked) +
                                                          " shells of the surface " +
                                                          std::to_string(found) + " are left");
  return {};
}

}  // namespace souple
