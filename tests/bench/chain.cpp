// SPDX-License-Identifier: GPL-3.0-or-later
// Chains of rigid and elastic links, warped against exact: compliance of the contacts, and the shape.
#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "runtime/collision/mass_properties.hpp"
#include "runtime/contact/contact.hpp"
#include "runtime/world/soft_body_asset.hpp"
#include "tests/bench/bench_scene.hpp"
#include "tests/bench/phase_times.hpp"
#include "tests/bench/shape_error.hpp"

namespace {

using namespace souple;
using namespace souple::bench;

struct Chain {
  Scene scene;
  SceneWorld built;

  BodyId first_elastic() const {
    return *std::ranges::find_if(built.bodies, [&](BodyId body) { return built.world.is_soft(body); });
  }
  Points shape() const { return as_matrix(built.world.positions(first_elastic())); }
};

Chain make_chain(const std::string& name, ContactMethod method, double friction) {
  Scene scene = bench_scene(name);
  scene.world.contact_method = method;
  scene.world.friction = friction;
  SceneWorld built = build_or_exit(scene);
  return {std::move(scene), std::move(built)};
}

/// Of the fixed link on the elastic one less the weight of all that hangs, over that weight.
double force_error(const Chain& chain, double weight) {
  Vec3 sum = Vec3::Zero();
  for (const ContactRecord& contact : chain.built.world.contacts()) {
    if (contact.body_a.index == 0) sum -= as_vec3(contact.force_n);
    if (contact.body_b.index == 0) sum += as_vec3(contact.force_n);
  }
  return (sum - Vec3(0, 0, weight)).norm() / weight;
}

/// Both start alike and each goes on by itself: what is compared holds how far their motions drift apart,
/// not only the error of a step.
void compare(const std::string& name, int steps) {
  Chain exact = make_chain(name, ContactMethod::exact, 0.4);
  Chain warped = make_chain(name, ContactMethod::warped, 0.4);
  const Points rest =
      as_matrix(exact.built.world.asset(exact.first_elastic()).model().rest_positions());
  PhaseRows exact_times, warped_times;
  double largest = 0, error_largest = 0;
  for (int k = 0; k < steps; ++k) {
    const StepReport e = step_or_exit(exact.scene, exact.built);
    const StepReport w = step_or_exit(warped.scene, warped.built);
    if (e.contact_count > 0) exact_times.add(e);
    if (w.contact_count > 0) warped_times.add(w);
    if (e.elastic_energy_j > largest) {
      largest = e.elastic_energy_j;
      error_largest = shape_error(warped.shape(), exact.shape(), rest);
    }
  }
  ResultHash hash;
  hash.add(warped.built.world.positions(warped.first_elastic()));
  exact_times.print(name + ".exact", hash);
  warped_times.print(name + ".warped", hash);
  print_row(name + ".compliance_ratio", "1",
            median(exact_times.compliance_s()) / median(warped_times.compliance_s()), hash);
  print_row(name + ".shape_error_largest", "%", 100 * error_largest, hash);
  print_row(name + ".shape_error_final", "%", 100 * shape_error(warped.shape(), exact.shape(), rest),
            hash);
}

/// A hanging chain of three without friction, from the same state of rest.
void compare_rest(int shared_steps, int steps) {
  Chain exact = make_chain("chain3_vertical", ContactMethod::exact, 0);
  Chain warped = make_chain("chain3_vertical", ContactMethod::warped, 0);
  for (int k = 0; k < shared_steps; ++k) step_or_exit(exact.scene, exact.built);
  if (auto status = warped.built.world.copy_state(exact.built.world); !status)
    exit_with(status.issue());
  for (int k = 0; k < steps; ++k) {
    step_or_exit(exact.scene, exact.built);
    step_or_exit(warped.scene, warped.built);
  }
  const auto& asset = exact.built.world.asset(exact.first_elastic());
  const double link_mass =
      1000 * mass_properties(exact.built.shapes.back()).volume + asset.model().total_mass();
  ResultHash hash;
  hash.add(warped.built.world.positions(warped.first_elastic()));
  print_row("chain3_rest.shape_error", "%",
            100 * shape_error(warped.shape(), exact.shape(), as_matrix(asset.model().rest_positions())),
            hash);
  print_row("chain3_rest.force_error", "mg", force_error(warped, 9.81 * link_mass), hash);
}

}  // namespace

int main() {
  compare("chain3_horizontal", 200);
  compare("chain3_vertical", 200);
  compare("chain5_horizontal", 100);
  compare_rest(600, 600);
  return 0;
}
