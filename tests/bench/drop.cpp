// SPDX-License-Identifier: GPL-3.0-or-later
// A liver of about 10k tets falls on a floor and a ball, mu = 0.4: speed, laws, rest.
#include <algorithm>

#include "runtime/contact/contact.hpp"
#include "tests/bench/liver.hpp"
#include "tests/bench/row.hpp"

namespace {

using namespace souple;
using namespace souple::bench;

constexpr int fall_steps = 100;    // by then it lies on both
constexpr int settle_steps = 300;  // contact has settled; the body still moves
constexpr int rest_steps = 2500;

struct Worst {
  double penetration = 0, depth = 0, cone = 0, residual = 0;
  void add(const StepReport& report) {
    penetration = std::max(penetration, report.worst_penetration_m);
    depth = std::max(depth, report.worst_surface_depth_m);
    cone = std::max(cone, report.cone_violation);
    residual = std::max(residual, report.contact_residual);
  }
};

struct Rest {
  double kinetic = 0, force_error = 0;
};

// The balance of forces, from the contact records: not the solver's word.
double force_error(const DropScene& scene, double weight) {
  Vec3 sum = Vec3::Zero();
  for (const auto& contact : scene.world.contacts()) sum += as_vec3(contact.force_n);
  return (sum - Vec3(0, 0, weight)).norm() / weight;
}

}  // namespace

int main() {
  const auto liver = baked_liver(10000, 2);
  const double weight = liver->model().total_mass() * 9.81, length = liver->longest_side_m();
  DropScene scene = make_drop(liver, WorldSettings{});
  std::vector<double> step_s, free_s, collision_s, compliance_s, solve_s, correction_s, contacts;
  Worst settled, any;
  StepReport last;
  for (int k = 0; k < rest_steps; ++k) {
    last = value_or_exit(scene.world.step());
    any.add(last);
    if (k >= settle_steps) settled.add(last);
    if (k < fall_steps || k >= settle_steps) continue;
    step_s.push_back(last.times.total_s);
    free_s.push_back(last.times.free_motion_s);
    collision_s.push_back(last.times.collision_s);
    compliance_s.push_back(last.times.compliance_s);
    solve_s.push_back(last.times.contact_solve_s);
    correction_s.push_back(last.times.correction_s);
    contacts.push_back(double(last.active_count));
  }
  ResultHash hash;
  hash.add(scene.world.positions(scene.body));
  print_row("drop.steps_per_s", "1/s", 1 / median(step_s), hash);
  print_row("drop.step", "ms", step_s, hash, 1e3);
  print_row("drop.phase.free_motion", "ms", free_s, hash, 1e3);
  print_row("drop.phase.collision", "ms", collision_s, hash, 1e3);
  print_row("drop.phase.compliance", "ms", compliance_s, hash, 1e3);
  print_row("drop.phase.contact_solve", "ms", solve_s, hash, 1e3);
  print_row("drop.phase.correction", "ms", correction_s, hash, 1e3);
  print_row("drop.active_contacts", "1", contacts, hash);
  print_row("drop.settled_penetration", "L", settled.penetration / length, hash);
  print_row("drop.settled_surface_depth", "L", settled.depth / length, hash);
  print_row("drop.worst_penetration", "L", any.penetration / length, hash);
  print_row("drop.cone_violation", "1", any.cone, hash);
  print_row("drop.contact_residual", "1", any.residual, hash);
  print_row("drop.rest_kinetic_energy", "mgL", last.kinetic_energy_j / (weight * length), hash);
  print_row("drop.rest_force_error", "mg", force_error(scene, weight), hash);
  return 0;
}
