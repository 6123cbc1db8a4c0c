// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/hierarchy/level_report.hpp"

#include <algorithm>

#include "tools/geometry/surface_samples.hpp"
#include "tools/hierarchy/tet_shape.hpp"
#include "tools/volume/tetrahedralize.hpp"

namespace souple {
namespace {

/// A report costs less than the level itself.
constexpr double samples_per_side = 80;

}  // namespace

LevelReport report_of(const MeshLevel& level, const TriangleMesh& target,
                      const TriangleBvh& triangles) {
  LevelReport report;
  report.node_count = level.mesh.nodes.size();
  report.tet_count = level.mesh.tets.size();
  const TetQuality quality = measure_tet_quality(level.mesh);
  report.min_dihedral_deg = quality.min_dihedral_deg;
  report.worst_radius_ratio = quality.worst_radius_ratio;
  report.worst_aspect = quality.worst_aspect;
  const TriangleMesh own{level.mesh.nodes, level.boundary};
  report.distance = two_sided_distance(own, TriangleBvh(own), target, triangles, samples_per_side);
  report.rigid_motion_error = level.rigid_motion_error;
  return report;
}

ChildQuality child_quality(const TetMesh& mesh, const std::vector<double>& parent_quality) {
  ChildQuality result;
  std::size_t keeping = 0;
  for (std::size_t t = 0; t < mesh.tets.size(); ++t) {
    const double kept = mean_ratio(mesh.tets[t], mesh.nodes) / parent_quality[t];
    if (kept >= 0.7) ++keeping;
    result.worst_kept = std::min(result.worst_kept, kept);
  }
  if (!mesh.tets.empty())
    result.share_keeping_70 = static_cast<double>(keeping) / static_cast<double>(mesh.tets.size());
  return result;
}

}  // namespace souple
