// SPDX-License-Identifier: GPL-3.0-or-later
// Forty dinosaurs rain into a bin: speed of whole steps on two threads, and the laws over 20 s.
#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "runtime/world/soft_body_asset.hpp"
#include "tests/bench/bench_scene.hpp"
#include "tests/bench/phase_times.hpp"
#include "tools/scene/job_pool.hpp"

namespace {

using namespace souple;
using namespace souple::bench;

constexpr int all_steps = 2000;
constexpr int pile_steps = 300;  // by then most lie on the pile

struct Laws {
  double penetration = 0, surface_depth = 0, cone = 0, residual = 0, lowest = INFINITY;
  double unconverged = 0, not_finite = 0;

  void add(const StepReport& step, const SceneWorld& built) {
    penetration = std::max(penetration, step.worst_penetration_m);
    surface_depth = std::max(surface_depth, step.worst_surface_depth_m);
    cone = std::max(cone, step.cone_violation);
    residual = std::max(residual, step.contact_residual);
    unconverged += step.unconverged_count;
    for (const BodyId body : built.bodies) {
      if (!built.world.is_soft(body)) continue;
      for (const Point& p : built.world.positions(body)) {
        lowest = std::min(lowest, p[2]);
        if (!std::isfinite(p[0] + p[1] + p[2])) ++not_finite;
      }
    }
  }
};

}  // namespace

// `steps`: fewer, for a glance.
int main(int argc, char** argv) {
  const int steps = argc > 1 ? std::atoi(argv[1]) : all_steps;
  const Scene scene = bench_scene("dino_rain");
  SceneWorld built = build_or_exit(scene);
  JobPool pool(2);
  built.world.run_jobs_with(pool.runner());
  PhaseRows pile;
  Laws laws, laws_of_pile;
  double most_contacts = 0;
  StepReport last;
  for (int k = 0; k < steps; ++k) {
    last = step_or_exit(scene, built);
    laws.add(last, built);
    most_contacts = std::max(most_contacts, double(last.contact_count));
    if (k < std::min(pile_steps, steps / 2)) continue;
    pile.add(last);
    laws_of_pile.add(last, built);
  }
  const SoftBodyAsset& dino = built.world.asset(built.bodies.back());
  const double edge = mean_edge_m(dino);
  ResultHash hash;
  for (const BodyId body : built.bodies)
    if (built.world.is_soft(body)) hash.add(built.world.positions(body));
  print_row("dino_rain.tets", "1", double(dino.model().tets().size()), hash);
  pile.print("dino_rain", hash);
  print_row("dino_rain.most_contacts", "1", most_contacts, hash);
  print_row("dino_rain.penetration", "edge", laws.penetration / edge, hash);
  print_row("dino_rain.penetration_pile", "edge", laws_of_pile.penetration / edge, hash);
  print_row("dino_rain.surface_depth", "edge", laws.surface_depth / edge, hash);
  print_row("dino_rain.below_floor", "edge", std::max(0.0, -laws.lowest / edge), hash);
  print_row("dino_rain.not_finite", "1", laws.not_finite, hash);
  print_row("dino_rain.cone_violation", "1", laws.cone, hash);
  print_row("dino_rain.contact_residual", "1", laws.residual, hash);
  print_row("dino_rain.unconverged", "1", laws.unconverged, hash);
  print_row("dino_rain.simulated", "s", built.world.time_s(), hash);
  print_row("dino_rain.kinetic_energy", "J", last.kinetic_energy_j, hash);
  return 0;
}
