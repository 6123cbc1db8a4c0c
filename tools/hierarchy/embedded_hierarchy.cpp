// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/hierarchy/embedded_hierarchy.hpp"

#include <algorithm>
#include <new>
#include <string>

#include "tools/geometry/triangle_bvh.hpp"
#include "tools/hierarchy/embed_points.hpp"
#include "tools/hierarchy/level_embedding.hpp"
#include "tools/hierarchy/level_report.hpp"
#include "tools/hierarchy/target_surface.hpp"
#include "tools/hierarchy/tet_weights.hpp"

namespace souple {
namespace {

constexpr std::size_t most_levels = 5;

Status check_meshes(const std::vector<TetMesh>& meshes) {
  if (meshes.empty() || meshes.size() > most_levels)
    return make_issue(IssueCode::usage_bad_value, std::to_string(meshes.size()) + " levels; 1 to " +
                                                      std::to_string(most_levels) + " are possible");
  for (std::size_t l = 0; l < meshes.size(); ++l) {
    if (const Status valid = check_tet_mesh(meshes[l]); !valid) {
      Issue issue = valid.issue();
      issue.where = "level " + std::to_string(l);
      return issue;
    }
    if (l > 0 && meshes[l].nodes.size() <= meshes[l - 1].nodes.size())
      return make_issue(IssueCode::usage_bad_value, "level " + std::to_string(l) + " has " +
                                                        std::to_string(meshes[l].nodes.size()) +
                                                        " nodes, the coarser one " +
                                                        std::to_string(meshes[l - 1].nodes.size()));
  }
  return {};
}

}  // namespace

Result<Hierarchy> build_embedded_hierarchy(const std::vector<TetMesh>& meshes,
                                           const TriangleMesh& target) try {
  if (const Status valid = check_meshes(meshes); !valid) return valid.issue();
  if (const Status valid = check_target(target); !valid) return valid.issue();
  const TriangleBvh target_triangles(target);
  Hierarchy hierarchy;
  for (const TetMesh& mesh : meshes) {
    MeshLevel level{mesh, boundary_triangles(mesh.tets), {}, {}, {}};
    if (!hierarchy.levels.empty()) {
      const TetMesh& coarser = hierarchy.levels.back().mesh;
      Result<EmbeddedPoints> embedded = embed_points(mesh.nodes, coarser);
      if (!embedded) return embedded.issue();
      level.embedding = std::move(embedded->rows);
      level.rigid_motion_error = measure_rigid_motion(level, coarser);
    }
    hierarchy.reports.push_back(report_of(level, target, target_triangles));
    hierarchy.levels.push_back(std::move(level));
  }
  return hierarchy;
} catch (const std::bad_alloc&) {
  return make_issue(IssueCode::hierarchy_too_large, "not enough memory");
}

}  // namespace souple
