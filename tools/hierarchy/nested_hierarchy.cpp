// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/hierarchy/nested_hierarchy.hpp"

#include <new>
#include <string>

#include "tools/geometry/surface_measure.hpp"
#include "tools/geometry/triangle_bvh.hpp"
#include "tools/geometry/vector.hpp"
#include "tools/hierarchy/fit_surface.hpp"
#include "tools/hierarchy/refine.hpp"
#include "tools/volume/tetrahedralize.hpp"

namespace souple {
namespace {

constexpr int most_levels = 5;
constexpr std::size_t most_tets = 40'000'000;

std::size_t at(Index i) { return static_cast<std::size_t>(i); }

Status check_tet_mesh(const TetMesh& mesh) {
  if (mesh.tets.empty()) return make_issue(IssueCode::mesh_element_invalid, "the mesh has no tets");
  for (std::size_t i = 0; i < mesh.nodes.size(); ++i)
    if (!is_finite(mesh.nodes[i]))
      return make_issue(IssueCode::mesh_element_invalid,
                        "node " + std::to_string(i) + " is not finite");
  for (std::size_t t = 0; t < mesh.tets.size(); ++t) {
    const Tet& tet = mesh.tets[t];
    for (const Index i : tet)
      if (i < 0 || at(i) >= mesh.nodes.size())
        return make_issue(IssueCode::mesh_element_invalid,
                          "tet " + std::to_string(t) + " names a node outside the mesh");
    if (!(signed_volume6(mesh.nodes[at(tet[0])], mesh.nodes[at(tet[1])], mesh.nodes[at(tet[2])],
                         mesh.nodes[at(tet[3])]) > 0))
      return make_issue(IssueCode::mesh_element_invalid,
                        "tet " + std::to_string(t) + " is flat or inverted");
  }
  return {};
}

Status check_options(const TetMesh& coarse, const TriangleMesh& target,
                     const NestedHierarchyOptions& options) {
  if (options.level_count < 1 || options.level_count > most_levels)
    return make_issue(IssueCode::usage_bad_value, std::to_string(options.level_count) +
                                                      " levels; 1 to " + std::to_string(most_levels) +
                                                      " are possible");
  if (const Status valid = check_tet_mesh(coarse); !valid) return valid;
  if (const Status valid = check_triangle_mesh(target); !valid) return valid;
  const std::size_t finest = coarse.tets.size() << (3 * (options.level_count - 1));
  if (coarse.tets.size() > most_tets || finest > most_tets)
    return make_issue(IssueCode::hierarchy_too_large,
                      std::to_string(coarse.tets.size()) + " tets would become " +
                          std::to_string(finest) + ", the limit is " + std::to_string(most_tets));
  return {};
}

NestedLevelReport report_of(const MeshLevel& level, const TriangleBvh& target, std::size_t held_back) {
  std::vector<Point> surface;
  for (const Index i : used_nodes(level.boundary)) surface.push_back(level.mesh.nodes[at(i)]);
  const SurfaceDistance distance = distance_from_surface(surface, target);
  return {level.mesh.nodes.size(),
          level.mesh.tets.size(),
          measure_tet_quality(level.mesh).min_dihedral_deg,
          distance.largest,
          distance.root_mean_square,
          held_back};
}

}  // namespace

Result<NestedHierarchy> build_nested_hierarchy(const TetMesh& coarse, const TriangleMesh& target,
                                               const NestedHierarchyOptions& options) try {
  if (const Status valid = check_options(coarse, target, options); !valid) return valid.issue();
  const TriangleBvh target_bvh(target);
  NestedHierarchy hierarchy;
  hierarchy.levels.push_back({coarse, boundary_triangles(coarse.tets), {}});
  hierarchy.reports.push_back(report_of(hierarchy.levels.front(), target_bvh, 0));
  for (int l = 1; l < options.level_count; ++l) {
    RefinedMesh fine = refine_red(hierarchy.levels.back().mesh);
    MeshLevel& level = hierarchy.levels.emplace_back();
    level.mesh = std::move(fine.mesh);
    level.parents = std::move(fine.parents);
    level.boundary = boundary_triangles(level.mesh.tets);
    const std::size_t held_back =
        options.fit_surface ? fit_to_surface(level.mesh, level.boundary, target_bvh) : 0;
    if (const Status positive = check_tet_mesh(level.mesh); !positive) return positive.issue();
    hierarchy.reports.push_back(report_of(level, target_bvh, held_back));
  }
  return hierarchy;
} catch (const std::bad_alloc&) {
  return make_issue(IssueCode::hierarchy_too_large, "not enough memory");
}

}  // namespace souple
