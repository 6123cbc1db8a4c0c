// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/hierarchy/nested_hierarchy.hpp"

#include <algorithm>
#include <new>
#include <string>

#include "tools/geometry/surface_measure.hpp"
#include "tools/geometry/triangle_bvh.hpp"
#include "tools/geometry/unit_frame.hpp"
#include "tools/hierarchy/fit_surface.hpp"
#include "tools/hierarchy/level_embedding.hpp"
#include "tools/hierarchy/level_report.hpp"
#include "tools/hierarchy/refine.hpp"
#include "tools/hierarchy/target_surface.hpp"
#include "tools/hierarchy/tet_shape.hpp"
#include "tools/hierarchy/tet_weights.hpp"

namespace souple {
namespace {

constexpr int most_levels = 5;
constexpr std::size_t most_tets = 40'000'000;

Status check_every_node_is_used(const TetMesh& mesh) {
  std::vector<bool> used(mesh.nodes.size(), false);
  for (const Tet& tet : mesh.tets)
    for (const Index i : tet) used[static_cast<std::size_t>(i)] = true;
  const auto unused = std::ranges::find(used, false);
  if (unused == used.end()) return {};
  return make_issue(IssueCode::mesh_element_invalid,
                    "node " + std::to_string(unused - used.begin()) + " belongs to no tet");
}

Status check_options(const TetMesh& coarse, const TriangleMesh& target,
                     const NestedHierarchyOptions& options) {
  if (options.level_count < 1 || options.level_count > most_levels)
    return make_issue(IssueCode::usage_bad_value, std::to_string(options.level_count) +
                                                      " levels; 1 to " + std::to_string(most_levels) +
                                                      " are possible");
  if (const Status valid = check_tet_mesh(coarse); !valid) return valid;
  if (const Status valid = check_every_node_is_used(coarse); !valid) return valid;
  if (const Status valid = check_target(target); !valid) return valid;
  const std::size_t finest = coarse.tets.size() << (3 * (options.level_count - 1));
  if (coarse.tets.size() > most_tets || finest > most_tets)
    return make_issue(IssueCode::hierarchy_too_large,
                      std::to_string(coarse.tets.size()) + " tets would become " +
                          std::to_string(finest) + ", the limit is " + std::to_string(most_tets));
  return {};
}

/// Eight times the quality of every tet, once for each child.
std::vector<double> qualities_for_children(const TetMesh& coarse) {
  std::vector<double> qualities;
  qualities.reserve(8 * coarse.tets.size());
  for (const Tet& tet : coarse.tets)
    qualities.insert(qualities.end(), 8, mean_ratio(tet, coarse.nodes));
  return qualities;
}

/// What refinement and fit gave, in units of the frame.
struct FittedLevel {
  RefinedMesh fine;
  std::vector<Triangle> boundary;
  std::size_t held_back_count = 0;
};

FittedLevel next_level(const TetMesh& coarser, const TargetSurface& target,
                       const NestedHierarchyOptions& options) {
  FittedLevel level{refine_red(coarser, options.diagonal), {}, 0};
  level.boundary = boundary_triangles(level.fine.mesh.tets);
  level.held_back_count = fit_to_surface(level.fine.mesh, level.boundary,
                                         qualities_for_children(coarser), target, options.fit);
  return level;
}

/// Where nothing is fitted, midpoints are taken in metres: exact.
TetMesh in_metres(const FittedLevel& level, const MeshLevel& coarser, const UnitFrame& frame,
                  FitRule rule) {
  if (rule != FitRule::none) return {frame.to_metres(level.fine.mesh.nodes), level.fine.mesh.tets};
  TetMesh mesh{{}, level.fine.mesh.tets};
  mesh.nodes.reserve(level.fine.parents.size());
  for (const auto& [a, b] : level.fine.parents) {
    const Point& p = coarser.mesh.nodes[static_cast<std::size_t>(a)];
    const Point& q = coarser.mesh.nodes[static_cast<std::size_t>(b)];
    mesh.nodes.push_back({0.5 * (p[0] + q[0]), 0.5 * (p[1] + q[1]), 0.5 * (p[2] + q[2])});
  }
  return mesh;
}

}  // namespace

Result<Hierarchy> build_nested_hierarchy(const TetMesh& coarse, const TriangleMesh& target,
                                         const NestedHierarchyOptions& options) try {
  if (const Status valid = check_options(coarse, target, options); !valid) return valid.issue();
  const UnitFrame frame(coarse.nodes);
  TetMesh unit{frame.to_unit(coarse.nodes), coarse.tets};
  if (const Status valid = check_tet_mesh(unit); !valid) return valid.issue();
  const TargetSurface unit_target({frame.to_unit(target.vertices), target.triangles});
  const TriangleBvh target_triangles(target);
  Hierarchy hierarchy;
  hierarchy.levels.push_back({coarse, boundary_triangles(coarse.tets), {}, {}, {}});
  hierarchy.reports.push_back(report_of(hierarchy.levels.front(), target, target_triangles));
  for (int l = 1; l < options.level_count; ++l) {
    FittedLevel fitted = next_level(unit, unit_target, options);
    const MeshLevel& coarser = hierarchy.levels.back();
    MeshLevel level;
    level.mesh = in_metres(fitted, coarser, frame, options.fit);
    if (const Status positive = check_tet_mesh(level.mesh); !positive) return positive.issue();
    level.boundary = std::move(fitted.boundary);
    level.parents = std::move(fitted.fine.parents);
    level.embedding = embed_children(level.mesh.nodes, level.parents, coarser.mesh);
    level.rigid_motion_error = measure_rigid_motion(level, coarser.mesh);
    LevelReport report = report_of(level, target, target_triangles);
    report.held_back_count = fitted.held_back_count;
    report.children = child_quality(level.mesh, qualities_for_children(coarser.mesh));
    hierarchy.levels.push_back(std::move(level));
    hierarchy.reports.push_back(report);
    unit = std::move(fitted.fine.mesh);
  }
  return hierarchy;
} catch (const std::bad_alloc&) {
  return make_issue(IssueCode::hierarchy_too_large, "not enough memory");
}

}  // namespace souple
