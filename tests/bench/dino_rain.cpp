// SPDX-License-Identifier: GPL-3.0-or-later
// Forty dinosaurs rain into a bin: speed of whole steps on two threads, and the laws over 20 s.
//   dino_rain [STEPS]              one rain; fewer steps for a glance
//   dino_rain hairs RAINS STEPS    so many, each a hair off the one before: what luck is in the first
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <memory>
#include <string_view>

#include "runtime/collision/feature_minima.hpp"
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

// All bodies a hair off: another rain as soon as they touch.
void set_off(SceneWorld& built, double speed) {
  for (const BodyId body : built.bodies) {
    if (!built.world.is_soft(body)) continue;
    const auto at = built.world.positions(body);
    const std::vector<Point> positions(at.begin(), at.end()), velocities(at.size(), Point{speed, 0, 0});
    if (auto status = built.world.set_state(body, positions, velocities); !status)
      exit_with(status.issue());
  }
}

// How deep points on the edges of a body are inside another one, whatever contacts there are.
class Overlap {
 public:
  explicit Overlap(const SceneWorld& built) {
    for (const BodyId body : built.bodies)
      if (built.world.is_soft(body)) surfaces_.push_back(std::make_unique<Placed>(built.world, body));
  }

  double deepest() const {
    double depth = 0;
    for (const auto& one : surfaces_)
      for (const auto& other : surfaces_)
        if (one != other && one->surface.bounds().intersects(other->surface.bounds()))
          depth = std::max(depth, deepest(one->surface, other->surface));
    return depth;
  }

 private:
  struct Placed {
    Placed(const World& world, BodyId body) : surface(world.asset(body).surface()) {
      const auto positions = world.positions(body);
      x.resize(3 * Eigen::Index(positions.size()));
      for (std::size_t k = 0; k < positions.size(); ++k)
        node_entry(x, Index(k)) = as_vec3(positions[k]);
      surface.refit(x);
    }
    DeformedSurface surface;
    Eigen::VectorXd x;
  };

  static double deepest(const DeformedSurface& a, const DeformedSurface& b) {
    constexpr int parts = 8;
    double depth = 0;
    for (const auto& edge : a.topology().edges)
      for (int k = 0; k < parts; ++k) {
        const double along = double(k) / parts;
        const Vec3 point =
            (1 - along) * a.position(edge.vertex[0]) + along * a.position(edge.vertex[1]);
        depth = std::max(depth, depth_inside(b, point));
      }
    return depth;
  }

  std::vector<std::unique_ptr<Placed>> surfaces_;
};

double mean_edge_m(const SceneWorld& built) {
  return souple::bench::mean_edge_m(built.world.asset(built.bodies.back()));
}

void rain_a_hair_off(int rains, int steps) {
  constexpr double hair_m_s = 1e-7;
  const Scene scene = bench_scene("dino_rain");
  std::vector<double> penetrations, overlaps;
  double not_finite = 0;
  ResultHash hash;
  for (int rain = 1; rain <= rains; ++rain) {
    SceneWorld built = build_or_exit(scene);
    set_off(built, rain * hair_m_s);
    JobPool pool(2);
    built.world.run_jobs_with(pool.runner());
    Laws laws;
    for (int k = 0; k < steps; ++k) laws.add(step_or_exit(scene, built), built);
    penetrations.push_back(laws.penetration / mean_edge_m(built));
    overlaps.push_back(Overlap(built).deepest() / mean_edge_m(built));
    not_finite += laws.not_finite;
    for (const BodyId body : built.bodies)
      if (built.world.is_soft(body)) hash.add(built.world.positions(body));
  }
  print_row("dino_rain.hairs.penetration", "edge", *std::ranges::max_element(penetrations), hash);
  print_row("dino_rain.hairs.penetration_median", "edge", median(penetrations), hash);
  print_row("dino_rain.hairs.overlap", "edge", *std::ranges::max_element(overlaps), hash);
  print_row("dino_rain.hairs.not_finite", "1", not_finite, hash);
}

void rain(int steps) {
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
  const double edge = mean_edge_m(built);
  ResultHash hash;
  for (const BodyId body : built.bodies)
    if (built.world.is_soft(body)) hash.add(built.world.positions(body));
  print_row("dino_rain.tets", "1", double(dino.model().tets().size()), hash);
  pile.print("dino_rain", hash);
  print_row("dino_rain.most_contacts", "1", most_contacts, hash);
  print_row("dino_rain.penetration", "edge", laws.penetration / edge, hash);
  print_row("dino_rain.penetration_pile", "edge", laws_of_pile.penetration / edge, hash);
  print_row("dino_rain.surface_depth", "edge", laws.surface_depth / edge, hash);
  print_row("dino_rain.overlap", "edge", Overlap(built).deepest() / edge, hash);
  print_row("dino_rain.below_floor", "edge", std::max(0.0, -laws.lowest / edge), hash);
  print_row("dino_rain.not_finite", "1", laws.not_finite, hash);
  print_row("dino_rain.cone_violation", "1", laws.cone, hash);
  print_row("dino_rain.contact_residual", "1", laws.residual, hash);
  print_row("dino_rain.unconverged", "1", laws.unconverged, hash);
  print_row("dino_rain.simulated", "s", built.world.time_s(), hash);
  print_row("dino_rain.kinetic_energy", "J", last.kinetic_energy_j, hash);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc > 3 && std::string_view(argv[1]) == "hairs")
    rain_a_hair_off(std::atoi(argv[2]), std::atoi(argv[3]));
  else
    rain(argc > 1 ? std::atoi(argv[1]) : all_steps);
  return 0;
}
