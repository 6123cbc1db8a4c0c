// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/volume/lattice_mesher.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "tools/geometry/signed_distance.hpp"
#include "tools/geometry/surface_measure.hpp"
#include "tools/geometry/vector.hpp"
#include "tools/volume/lattice.hpp"
#include "tools/volume/solid_parts.hpp"
#include "tools/volume/volume_checks.hpp"

namespace souple {
namespace {

/// Four short edges of sqrt(3)/2 and two long ones of 1.
constexpr double mean_edge_per_spacing = 0.911;
constexpr double tets_per_cube = 12;
/// Bounds memory and time; a body that fills little of its box is meshed coarser than asked for.
constexpr double most_lattice_nodes = 2e6, fewest_lattice_nodes = 5e4, lattice_nodes_per_tet = 60;
constexpr double coarsest_spacing = 0.6;
constexpr int most_counts = 4;
constexpr double good_enough = 0.07;
/// What the cage may lose or gain before another way is tried.
constexpr double least_volume = 0.85, most_volume = 1.6;

/// In spacings: a vertex of the surface farther from the cage's boundary sits on a part that was
/// missed.
constexpr double most_missed = 0.9;
constexpr std::size_t most_samples = 4000;

/// One way to cut the lattice: how far outside the surface, in spacings, and how much finer.
struct Cutting {
  double offset;
  double refinement;
};
/// Every point lies within sqrt(5)/4 = 0.56 spacings of a lattice node: 0.57 misses nothing.
constexpr Cutting ways[] = {{0, 1}, {0.25, 1}, {0.57, 1}, {0.25, 0.7}, {0.57, 0.7}};

struct Cage {
  TetMesh mesh;
  double spacing = 0;
  std::size_t part_count = 0;  ///< before all but the largest were dropped
  int attempts = 0;
};

/// Shells that face outward; the others bound cavities.
std::size_t solid_count(const TriangleMesh& surface) {
  const auto shells = shell_of_triangles(surface.triangles, surface.vertices.size());
  std::vector<TriangleMesh> parts(static_cast<std::size_t>(std::ranges::max(shells)) + 1);
  for (std::size_t t = 0; t < surface.triangles.size(); ++t)
    parts[static_cast<std::size_t>(shells[t])].triangles.push_back(surface.triangles[t]);
  std::size_t count = 0;
  for (TriangleMesh& part : parts) {
    part.vertices = surface.vertices;
    count += signed_volume(part) > 0 ? 1 : 0;
  }
  return std::max<std::size_t>(count, 1);
}

class Cutter {
 public:
  Cutter(const UnitSurface& unit, const SizeGoal& goal)
      : distance_(unit.mesh),
        box_(bounding_box(unit.mesh.vertices)),
        goal_(goal),
        solids_(solid_count(unit.mesh)),
        volume_(signed_volume(unit.mesh)) {
    const std::size_t count = unit.mesh.vertices.size();
    for (std::size_t i = 0; i < count; i += 1 + count / most_samples)
      samples_.push_back(unit.mesh.vertices[i]);
  }

  std::size_t solids() const { return solids_; }
  double volume() const { return volume_; }

  /// Largest distance of a vertex of the surface from the cage's boundary, in spacings.
  double missed(const Cage& cage) const {
    const TriangleBvh boundary({cage.mesh.nodes, boundary_triangles(cage.mesh.tets)});
    return distance_from_surface(samples_, boundary).largest / cage.spacing;
  }

  double log_size_miss(const Cage& cage) const {
    if (goal_.kind != SizeGoal::Kind::tet_count) return 0;
    return std::abs(std::log(std::max(1.0, static_cast<double>(cage.mesh.tets.size())) / goal_.target));
  }

  /// At the spacing that meets the goal with this cutting, as far as the bounds allow.
  Cage cut_to_goal(const Cutting& way) const {
    if (goal_.kind != SizeGoal::Kind::tet_count) return cut(spacing_for_edge() * way.refinement, way);
    double spacing = std::cbrt(tets_per_cube * volume_ / goal_.target);
    Cage best;
    int attempts = 0;
    while (attempts < most_counts) {
      Cage cage = cut(spacing * way.refinement, way);
      ++attempts;
      const double count = std::max(1.0, static_cast<double>(cage.mesh.tets.size()));
      const bool nearer = best.mesh.tets.empty() || miss(cage) < miss(best);
      if (nearer) best = std::move(cage);
      if (miss(best) <= good_enough || way.refinement < 1) break;
      spacing *= std::clamp(std::pow(count / goal_.target, 1 / 2.7), 0.4, 2.0);
    }
    best.attempts = attempts;
    return best;
  }

 private:
  double miss(const Cage& cage) const {
    return std::abs(static_cast<double>(cage.mesh.tets.size()) / goal_.target - 1);
  }
  double spacing_for_edge() const {
    return goal_.expected_radius() * edge_per_radius / mean_edge_per_spacing;
  }

  Cage cut(double spacing, const Cutting& way) const {
    spacing = std::min(spacing, coarsest_spacing);
    const double most = std::clamp(lattice_nodes_per_tet * goal_.expected_tets(goal_.expected_radius()),
                                   fewest_lattice_nodes, most_lattice_nodes);
    while (lattice_node_count(grown(way.offset * spacing), spacing) > most) spacing *= 1.1;
    const double offset = way.offset * spacing;
    Cage cage;
    cage.spacing = spacing;
    cage.attempts = 1;
    // Neighbours nearer than the surface lie on the same side of it: the costly winding number is asked
    // for near the surface only.
    Point last{};
    double last_distance = 0;
    const auto outside_by = [&](const Point& p) {
      const double away = std::sqrt(distance_.triangles().closest(p).squared_distance);
      const bool same_side = norm(subtract(p, last)) < std::abs(last_distance);
      const bool inside = same_side ? last_distance < 0 : distance_.contains(p);
      last = p;
      last_distance = inside ? -away : away;
      return last_distance - offset;
    };
    cage.mesh = stuff_isosurface(outside_by, grown(offset), spacing);
    remove_pinches(cage.mesh);
    cage.part_count = keep_largest_parts(cage.mesh, solids_);
    drop_unused_nodes(cage.mesh);
    return cage;
  }

  Box grown(double by) const {
    Box box = box_;
    for (std::size_t k = 0; k < 3; ++k) {
      box.low[k] -= by;
      box.high[k] += by;
    }
    return box;
  }

  SignedDistance distance_;
  std::vector<Point> samples_;
  Box box_;
  SizeGoal goal_;
  std::size_t solids_;
  double volume_;
};

std::string note_of(const Cage& cage, const Cutter& cutter, const Cutting& way) {
  char text[200];
  std::snprintf(
      text, sizeof text,
      "lattice of spacing %.4f of the body's size, cut %.2f spacings outside the surface: the "
      "cage has %.1f %% of the surface's volume",
      cage.spacing, way.offset, 100 * volume_of(cage.mesh) / cutter.volume());
  return text;
}

}  // namespace

Result<VolumeDraft> mesh_by_lattice(const UnitSurface& unit, const Sizing& sizing,
                                    const SizeGoal& goal) {
  const Cutter cutter(unit, goal);
  VolumeDraft draft;
  draft.features.reason = "the lattice mesher keeps no sharp edges";
  double best_miss = HUGE_VAL;
  std::string note;
  for (const Cutting& way : ways) {
    Cage cage = cutter.cut_to_goal(way);
    draft.attempts += cage.attempts;
    if (!check_boundary(cage.mesh)) continue;
    const double kept = volume_of(cage.mesh) / cutter.volume();
    const bool whole = cage.part_count == cutter.solids();
    const double missed = cutter.missed(cage);
    const bool plausible =
        whole && kept >= least_volume && kept <= most_volume && missed <= most_missed;
    // A cage in the wrong number of parts is the last resort.
    const double miss = std::abs(std::log(kept)) + missed + cutter.log_size_miss(cage) +
                        (whole ? 0 : 10) + (cage.part_count < cutter.solids() ? 10 : 0);
    if (!plausible && miss >= best_miss) continue;
    best_miss = miss;
    note = note_of(cage, cutter, way);
    draft.mesh = std::move(cage.mesh);
    if (plausible) break;
  }
  if (draft.mesh.tets.empty())
    return make_issue(IssueCode::lattice_failed, "no lattice node lies inside at any size tried");
  draft.notes.push_back(note);
  if (!sizing.uniform())
    draft.notes.push_back("the lattice mesher knows no local sizes and no coarsening");
  return draft;
}

}  // namespace souple
