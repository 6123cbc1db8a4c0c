// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/volume/tetrahedralize.hpp"

#include <algorithm>
#include <exception>
#include <string>

#include "tools/geometry/surface_measure.hpp"
#include "tools/geometry/surface_samples.hpp"
#include "tools/volume/canonical_order.hpp"
#include "tools/volume/lattice_mesher.hpp"
#include "tools/volume/volume_checks.hpp"
#include "tools/volume/volume_draft.hpp"

namespace souple {
namespace {

/// In order, in metres, checked and measured.
Result<TetrahedralizedVolume> finish(VolumeDraft draft, const UnitSurface& unit, MesherKind mesher) {
  TetrahedralizedVolume volume;
  volume.mesh = in_canonical_order(draft.mesh);
  for (Point& p : volume.mesh.nodes) p = unit.frame.to_metres(p);
  if (const Status positive = check_tets(volume.mesh); !positive) return positive.issue();
  TetrahedralizeReport& report = volume.report;
  report.node_count = volume.mesh.nodes.size();
  report.tet_count = volume.mesh.tets.size();
  report.attempts = draft.attempts;
  report.quality = measure_tet_quality(volume.mesh);
  report.mesher = mesher;
  report.features = std::move(draft.features);
  report.notes = std::move(draft.notes);
  return volume;
}

Result<TetrahedralizedVolume> finish_lattice(const UnitSurface& unit, const Sizing& sizing,
                                             const SizeGoal& goal, const std::string& why) {
  Result<VolumeDraft> draft = mesh_by_lattice(unit, sizing, goal);
  if (!draft) return draft.issue();
  draft->notes.insert(draft->notes.begin(), why);
  return finish(std::move(*draft), unit, MesherKind::lattice);
}

Result<TetrahedralizedVolume> mesh_within(const UnitSurface& unit, const SizeGoal& goal,
                                          const TetrahedralizeOptions& options) {
  const Sizing sizing(unit, options);
  if (options.mesher == MesherKind::lattice)
    return finish_lattice(unit, sizing, goal, "the lattice mesher was asked for");
  Result<VolumeDraft> draft = mesh_by_delaunay(unit, sizing, goal, options.features);
  if (draft) return finish(std::move(*draft), unit, MesherKind::delaunay);
  if (options.mesher == MesherKind::delaunay) return draft.issue();
  return finish_lattice(unit, sizing, goal, "the Delaunay mesher failed: " + draft.issue().what);
}

/// The boundary with its own nodes only.
TriangleMesh boundary_of(const TetMesh& mesh) {
  TriangleMesh boundary{{}, boundary_triangles(mesh.tets)};
  std::vector<Index> rank(mesh.nodes.size());
  for (const Index i : used_nodes(boundary.triangles)) {
    rank[static_cast<std::size_t>(i)] = static_cast<Index>(boundary.vertices.size());
    boundary.vertices.push_back(mesh.nodes[static_cast<std::size_t>(i)]);
  }
  for (Triangle& t : boundary.triangles)
    for (Index& i : t) i = rank[static_cast<std::size_t>(i)];
  return boundary;
}

double error_of(const TetMesh& mesh, const TriangleMesh& surface) {
  return two_sided_distance(boundary_of(mesh), surface).hausdorff();
}

/// The mesher bounds the error at some points of every triangle, and not that of the surface from the
/// mesh: the bound is tightened until the measured one holds.
Result<TetrahedralizedVolume> mesh_to_error(const TriangleMesh& surface, const UnitSurface& unit,
                                            const SizeGoal& goal, TetrahedralizeOptions options) {
  constexpr int most_rounds = 3;
  const double asked = options.max_error_m;
  for (int round = 1;; ++round) {
    auto volume = mesh_within(unit, goal, options);
    if (!volume) return volume;
    const double error = error_of(volume->mesh, surface);
    if (error <= asked) return volume;
    const bool lattice = volume->report.mesher == MesherKind::lattice;
    if (round == most_rounds || lattice) {
      volume->report.notes.push_back("the error asked for was missed: it is " +
                                     std::to_string(error / asked) + " times as large");
      return volume;
    }
    options.max_error_m *= std::clamp(0.9 * asked / error, 0.3, 0.8);
  }
}

}  // namespace

Result<TetrahedralizedVolume> tetrahedralize(const TriangleMesh& surface,
                                             const TetrahedralizeOptions& options) try {
  if (const Status valid = check_sizes(options); !valid) return valid.issue();
  const Result<UnitSurface> unit = to_unit_surface(surface);
  if (!unit) return unit.issue();
  const Result<SizeGoal> goal = goal_of(*unit, options);
  if (!goal) return goal.issue();
  if (options.max_error_m > 0) return mesh_to_error(surface, *unit, *goal, options);
  return mesh_within(*unit, *goal, options);
} catch (const std::exception& e) {
  return make_issue(IssueCode::meshing_failed, e.what());
}

}  // namespace souple
