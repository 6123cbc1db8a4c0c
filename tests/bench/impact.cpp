// SPDX-License-Identifier: GPL-3.0-or-later
// Two soft bodies meet in free flight: what an impact does to the momentum of both together. Damping
// takes its share at every step, which the steps before the impact show.
#include <cmath>

#include "runtime/world/soft_body_asset.hpp"
#include "tests/bench/bench_scene.hpp"
#include "tests/bench/row.hpp"

namespace {

using namespace souple;
using namespace souple::bench;

struct Momentum {
  Vec3 linear = Vec3::Zero(), angular = Vec3::Zero();
};

Momentum momentum(const StepReport& step) {
  return {as_vec3(step.linear_momentum_kg_m_s), as_vec3(step.angular_momentum_kg_m2_s)};
}

/// What the contacts of a step did to either body, N s.
double impulse(const World& world, double h) {
  Vec3 sum = Vec3::Zero();
  for (const ContactRecord& contact : world.contacts()) sum += h * as_vec3(contact.force_n);
  return sum.norm();
}

void measure(const std::string& row, ContactMethod method, int passes, int steps) {
  Scene scene = bench_scene("impact");
  scene.world.contact_method = method;
  scene.world.contact_passes = passes;
  SceneWorld built = build_or_exit(scene);
  const double h = scene.world.time_step_s;
  const double size = built.world.asset(built.bodies.front()).longest_side_m();
  Momentum before = momentum(step_or_exit(scene, built)), lost;
  double kept = 1, total = 0, energy = 0, most_energy = 0;
  bool has_met = false;
  for (int k = 1; k < steps; ++k) {
    const StepReport step = step_or_exit(scene, built);
    const Momentum now = momentum(step);
    const double force = impulse(built.world, h);
    has_met = has_met || force > 0;
    if (!has_met) {
      kept = now.linear.norm() / before.linear.norm();
      energy = step.kinetic_energy_j;
    }
    total += force;
    most_energy = std::max(most_energy, step.kinetic_energy_j + step.elastic_energy_j);
    lost.linear += now.linear - kept * before.linear;
    lost.angular += now.angular - kept * before.angular;
    before = now;
  }
  ResultHash hash;
  for (const BodyId body : built.bodies) hash.add(built.world.positions(body));
  print_row("impact.impulse" + row, "N s", total, hash);
  print_row("impact.momentum_error" + row, "%", 100 * lost.linear.norm() / total, hash);
  print_row("impact.angular_momentum_error" + row, "%", 100 * lost.angular.norm() / (total * size),
            hash);
  print_row("impact.energy_gained" + row, "%", 100 * std::max(0.0, most_energy / energy - 1), hash);
}

}  // namespace

int main() {
  constexpr int steps = 60;
  measure(".exact", ContactMethod::exact, 1, steps);
  for (const int passes : {1, 2, 4})
    measure(".passes_" + std::to_string(passes), ContactMethod::warped, passes, steps);
  return 0;
}
