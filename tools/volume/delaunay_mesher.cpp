// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>

#include "tools/geometry/surface_measure.hpp"
#include "tools/geometry/vector.hpp"
#include "tools/volume/boundary_slivers.hpp"
#include "tools/volume/sharp_edges.hpp"
#include "tools/volume/solid_parts.hpp"
#include "tools/volume/surface_seeds.hpp"
#include "tools/volume/volume_checks.hpp"
#include "tools/volume/volume_draft.hpp"

namespace souple {
namespace {

constexpr int most_retries = 4;
constexpr double retry_step = 0.015;
/// How near the goal the mesh must come once the slivers are gone.
constexpr double near_enough = 0.12;
/// After two tries, a penalty that is let pass: on shapes with slits every try takes seconds.
constexpr double tolerable = 0.1;
/// Degrees: what a mesh shall have, with room above the 10 (smooth) and 5 (sharp edges) promised.
constexpr double good_dihedral_smooth = 10, good_dihedral_sharp = 6;
constexpr double good_aspect = 20;
/// A mesh below it is refused: such tets do not survive refinement.
constexpr double least_dihedral = 1;
/// Of the mean edge. Refinement may run into a corner of near-touching sheets (edges of 5e-8 of the
/// size on a wrap of Spider_ascii.stl).
constexpr double least_edge = 1e-3;
/// Flat tets on flat boundaries are peeled below this.
constexpr double peel_dihedral = 8;
/// In cell radii. Wide seeds miss legs and tails thinner than a tet: with 3, 2, 1.4, 1 the farthest
/// vertex of a dinosaur's surface lay 18, 18, 6, 10 % of its size from a mesh of 1000 tets. One shape,
/// not a law: hence the denser seeds where a limb was missed.
constexpr double seed_spacing = 1.4;
constexpr std::size_t fewest_seeds = 8, most_seeds = 5000;
/// With sharp edges, a result this far off the goal means that they dictate the size.
constexpr double exploded = 0.2;
/// So many times the tets asked for: the shape is thinner than tets of the size asked for.
constexpr double too_many = 2;

/// Mean edges between a vertex of the surface and the mesh that tell of a lost limb.
constexpr double limb_missed = 0.6;
/// Beyond it denser seeds are not tried: what is missed there (camel.off, 4 edges) takes many seconds a
/// try.
constexpr double slit_closed = 3;

double shortest_edge_of(const TetMesh& mesh) {
  double least = HUGE_VAL;
  for (const Tet& tet : mesh.tets)
    for (std::size_t a = 0; a < 4; ++a)
      for (std::size_t b = a + 1; b < 4; ++b)
        least = std::min(least, squared_norm(subtract(mesh.nodes[static_cast<std::size_t>(tet[a])],
                                                      mesh.nodes[static_cast<std::size_t>(tet[b])])));
  return std::sqrt(least);
}

std::string rounded(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.2f", value);
  return text;
}

/// 0 for a mesh that is as asked for.
double penalty(const TetMesh& mesh, const SizeGoal& goal, bool sharp) {
  const double off = goal.miss(static_cast<double>(mesh.tets.size()), mean_edge_of(mesh));
  const TetQuality quality = measure_tet_quality(mesh);
  const double good = sharp ? good_dihedral_sharp : good_dihedral_smooth;
  return std::max(0.0, off - near_enough) + std::max(0.0, 1 - quality.min_dihedral_deg / good) +
         (quality.worst_aspect > good_aspect ? 1 : 0);
}

/// Perturbs and exudes, and mends the few places where that leaves the boundary touching itself.
Result<TetMesh> optimised(VolumeMesher& mesher, const UnitSurface& unit) {
  Result<TetMesh> mesh = mesher.optimise();
  if (!mesh) return mesh;
  peel_boundary_slivers(*mesh, peel_dihedral);
  if (!check_boundary(*mesh)) remove_pinches(*mesh);
  drop_unused_nodes(*mesh);
  if (const Status sound = check_against_surface(*mesh, unit.mesh); !sound) return sound.issue();
  if (const double shortest = shortest_edge_of(*mesh); shortest < least_edge * mean_edge_of(*mesh))
    return make_issue(IssueCode::meshing_failed, "refinement ran into a point: edges of " +
                                                     std::to_string(1e9 * shortest) +
                                                     "e-9 of the body's size");
  return mesh;
}

/// What perturbing and exuding leave differs from one triangulation to the next: slightly other cell
/// radii, on either side, are tried until a mesh is sound, good and near the goal; else the best is
/// taken.
Result<VolumeDraft> optimise_soundly(VolumeMesher& mesher, const UnitSurface& unit,
                                     const Sizing& sizing, const SizeGoal& goal,
                                     const std::vector<SizeAttempt>& attempts, bool sharp) {
  VolumeDraft best;
  best.attempts = static_cast<int>(attempts.size());
  double least = HUGE_VAL;
  std::optional<Issue> refusal;
  for (int retry = 0; retry <= most_retries && least > (retry < 2 ? 0 : tolerable); ++retry) {
    if (retry > 0) {
      const int sign = retry % 2 == 1 ? 1 : -1;
      const double radius = attempts.back().radius * (1 + sign * retry_step * ((retry + 1) / 2));
      const Result<RefinedMesh> refined = mesher.refine(sizing.sizes(radius), goal.most_vertices());
      if (!refined) return refined.issue();
      ++best.attempts;
    }
    Result<TetMesh> mesh = optimised(mesher, unit);
    if (!mesh) {
      refusal = mesh.issue();
      if (refusal->code != IssueCode::meshing_boundary_not_manifold) return *refusal;
      continue;
    }
    const double found = penalty(*mesh, goal, sharp);
    if (found < least) {
      least = found;
      best.mesh = std::move(*mesh);
    }
  }
  if (best.mesh.tets.empty()) return *refusal;
  const double flattest = measure_tet_quality(best.mesh).min_dihedral_deg;
  if (flattest < least_dihedral)
    return make_issue(IssueCode::meshing_failed,
                      "the flattest dihedral angle left is " + rounded(flattest) + " degrees");
  return best;
}

Result<VolumeDraft> mesh_once(const UnitSurface& unit, const Sizing& sizing, const SizeGoal& goal,
                              const std::vector<std::vector<Point>>& polylines, double seeds_apart) {
  const double spacing = seeds_apart * goal.expected_radius();
  VolumeMesher mesher(unit.mesh,
                      {spread_surface_seeds(unit.mesh, spacing, fewest_seeds, most_seeds), polylines});
  const auto attempts = refine_to_goal(mesher, sizing, goal);
  if (!attempts) return attempts.issue();
  if (goal.kind == SizeGoal::Kind::tet_count && attempts->back().measure > too_many * goal.target)
    return make_issue(IssueCode::meshing_failed,
                      "thin parts of the shape take " +
                          std::to_string(static_cast<std::size_t>(attempts->back().measure)) +
                          " tets at the least");
  return optimise_soundly(mesher, unit, sizing, goal, *attempts, !polylines.empty());
}

/// Largest distance of a vertex of the surface from the mesh, in mean edges.
double missed(const VolumeDraft& draft, const UnitSurface& unit) {
  const TriangleBvh boundary({draft.mesh.nodes, boundary_triangles(draft.mesh.tets)});
  return distance_from_surface(unit.mesh.vertices, boundary).largest / mean_edge_of(draft.mesh);
}

/// Without sharp edges. Where a limb was missed, once more from denser seeds, which find it unless
/// there are too few tets for it.
Result<VolumeDraft> mesh_smooth(const UnitSurface& unit, const Sizing& sizing, const SizeGoal& goal) {
  auto draft = mesh_once(unit, sizing, goal, {}, seed_spacing);
  if (!draft) return draft;
  double left = missed(*draft, unit);
  for (const double denser : {0.7, 0.5}) {
    if (left < limb_missed || left > slit_closed) break;
    auto again = mesh_once(unit, sizing, goal, {}, denser * seed_spacing);
    if (!again) continue;
    again->attempts += draft->attempts;
    const double still = missed(*again, unit);
    if (still < left && penalty(again->mesh, goal, false) <= penalty(draft->mesh, goal, false)) {
      left = still;
      draft = std::move(again);
    } else {
      draft->attempts = again->attempts;
    }
  }
  if (left >= limb_missed)
    draft->notes.push_back("a part thinner than a tet is missing: the surface reaches " +
                           rounded(left) + " mean edges beyond the mesh");
  return draft;
}

void note_missed_goal(VolumeDraft& draft, const SizeGoal& goal) {
  constexpr double promised = 0.15;
  const auto count = static_cast<double>(draft.mesh.tets.size());
  const double edge = mean_edge_of(draft.mesh);
  if (goal.miss(count, edge) <= promised) return;
  const bool counting = goal.kind == SizeGoal::Kind::tet_count;
  draft.notes.push_back("the size asked for was missed: the " +
                        std::string(counting ? "count" : "mean edge") + " is " +
                        rounded((counting ? count : edge) / goal.target) + " times what was asked for");
}

}  // namespace

double mean_edge_of(const TetMesh& mesh) {
  double sum = 0;
  for (const Tet& tet : mesh.tets)
    for (std::size_t a = 0; a < 4; ++a)
      for (std::size_t b = a + 1; b < 4; ++b)
        sum += norm(subtract(mesh.nodes[static_cast<std::size_t>(tet[a])],
                             mesh.nodes[static_cast<std::size_t>(tet[b])]));
  return mesh.tets.empty() ? 0 : sum / (6 * static_cast<double>(mesh.tets.size()));
}

Result<VolumeDraft> mesh_by_delaunay(const UnitSurface& unit, const Sizing& sizing,
                                     const SizeGoal& goal, FeatureMode mode) {
  const SharpEdges edges = find_sharp_edges(unit.mesh);
  FeatureReport features = decide_on_features(edges, mode, edge_per_radius * goal.expected_radius(),
                                              goal.expected_node_count());
  std::vector<std::string> notes;
  if (features.kept) {
    auto draft = mesh_once(unit, sizing, goal, edges.polylines, seed_spacing);
    if (draft && penalty(draft->mesh, goal, true) < exploded) {
      draft->features = features;
      note_missed_goal(*draft, goal);
      return draft;
    }
    features.kept = false;
    features.reason +=
        ", but with them " +
        (draft ? std::to_string(draft->mesh.tets.size()) + " tets came out, the flattest angle " +
                     rounded(measure_tet_quality(draft->mesh).min_dihedral_deg)
               : "meshing failed: " + draft.issue().what);
    notes.push_back("sharp edges were not kept: " + features.reason);
  }
  auto draft = mesh_smooth(unit, sizing, goal);
  if (!draft) return draft;
  draft->features = features;
  draft->notes.insert(draft->notes.begin(), notes.begin(), notes.end());
  note_missed_goal(*draft, goal);
  return draft;
}

}  // namespace souple
