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

Chain make_chain(const std::string& name, ContactMethod method, int passes, double friction) {
  Scene scene = bench_scene(name);
  scene.world.contact_method = method;
  scene.world.contact_passes = passes;
  scene.world.friction = friction;
  SceneWorld built = build_or_exit(scene);
  return {std::move(scene), std::move(built)};
}

/// Replaces the velocities: all nodes of soft bodies move at `speed` along x, free bodies stand still.
void set_velocities(Chain& chain, double speed) {
  World& world = chain.built.world;
  for (std::size_t k = 0; k < chain.built.bodies.size(); ++k) {
    const BodyId body = chain.built.bodies[k];
    if (world.is_soft(body)) {
      const auto at = world.positions(body);
      const std::vector<Point> positions(at.begin(), at.end()),
          velocities(at.size(), Point{speed, 0, 0});
      if (auto status = world.set_state(body, positions, velocities); !status)
        exit_with(status.issue());
    } else if (std::get<SceneRigidBody>(chain.scene.bodies[k]).description.free) {
      if (auto status = world.set_rigid_state(body, world.rigid_pose(body), {}, {}); !status)
        exit_with(status.issue());
    }
  }
}

void take_state(Chain& chain, const Chain& other) {
  if (auto status = chain.built.world.copy_state(other.built.world); !status) exit_with(status.issue());
}

/// Of the fixed link on the elastic one, N.
Vec3 holding_force(const Chain& chain) {
  Vec3 sum = Vec3::Zero();
  for (const ContactRecord& contact : chain.built.world.contacts()) {
    if (contact.body_a.index == 0) sum -= as_vec3(contact.force_n);
    if (contact.body_b.index == 0) sum += as_vec3(contact.force_n);
  }
  return sum;
}

/// A way to move that is held against the exact one.
struct Rival {
  Rival(std::string row_end, Chain made, bool shares)
      : row(std::move(row_end)), chain(std::move(made)), shares_history(shares) {}

  std::string row;  ///< its rows end with this
  Chain chain;
  bool shares_history;  ///< begins every step where the exact one does
  PhaseRows times;
  double error_largest = 0;
  std::vector<double> errors;  ///< of the steps with contacts
};

constexpr double hair_m_s = 1e-7;

/// Warped with 1, 2 and 4 contact passes.
void add_warped(const std::string& name, double friction, bool shares_history,
                std::vector<Rival>& rivals) {
  for (const int passes : {1, 2, 4}) {
    const std::string row = (shares_history ? ".same_history.passes_" : ".passes_");
    rivals.emplace_back(row + std::to_string(passes),
                        make_chain(name, ContactMethod::warped, passes, friction), shares_history);
  }
}

/// Exact, a hair off at the start: what the motion itself makes of a difference that is none.
void add_hair_off(const std::string& name, double friction, std::vector<Rival>& rivals) {
  rivals.emplace_back(".exact_hair_off", make_chain(name, ContactMethod::exact, 1, friction), false);
  set_velocities(rivals.back().chain, hair_m_s);
}

/// All start alike; those that do not share its history go on by themselves.
void compare(const std::string& name, int steps) {
  Chain exact = make_chain(name, ContactMethod::exact, 1, 0.4);
  std::vector<Rival> rivals;
  add_warped(name, 0.4, false, rivals);
  add_warped(name, 0.4, true, rivals);
  add_hair_off(name, 0.4, rivals);
  const Points rest =
      as_matrix(exact.built.world.asset(exact.first_elastic()).model().rest_positions());
  PhaseRows exact_times;
  double largest = 0;
  for (int k = 0; k < steps; ++k) {
    for (Rival& rival : rivals)
      if (rival.shares_history) take_state(rival.chain, exact);
    const StepReport e = step_or_exit(exact.scene, exact.built);
    if (e.contact_count > 0) exact_times.add(e);
    const bool is_largest = e.elastic_energy_j > largest;
    largest = std::max(largest, e.elastic_energy_j);
    for (Rival& rival : rivals) {
      const StepReport r = step_or_exit(rival.chain.scene, rival.chain.built);
      if (r.contact_count > 0) rival.times.add(r);
      if (e.contact_count == 0) continue;
      rival.errors.push_back(100 * shape_error(rival.chain.shape(), exact.shape(), rest));
      if (is_largest) rival.error_largest = rival.errors.back();
    }
  }
  ResultHash hash;
  const Rival& warped = rivals.front();
  hash.add(warped.chain.built.world.positions(warped.chain.first_elastic()));
  exact_times.print(name + ".exact", hash);
  warped.times.print(name + ".warped", hash);
  print_row(name + ".compliance_ratio", "1",
            median(exact_times.compliance_s()) / median(warped.times.compliance_s()), hash);
  for (const Rival& rival : rivals) {
    print_row(name + ".shape_error_largest" + rival.row, "%", rival.error_largest, hash);
    print_row(name + ".shape_error_final" + rival.row, "%", rival.errors.back(), hash);
    print_row(name + ".shape_error_steps" + rival.row, "%", rival.errors, hash);
  }
}

/// Brings a chain near rest: whenever its kinetic energy falls, all of it is taken away.
void settle(Chain& chain, int steps) {
  double last = 0;
  for (int k = 0; k < steps; ++k) {
    const StepReport step = step_or_exit(chain.scene, chain.built);
    if (step.kinetic_energy_j < last) set_velocities(chain, 0);
    last = step.kinetic_energy_j < last ? 0 : step.kinetic_energy_j;
  }
}

/// Facets that slide on facets tremble for ever, by the exact method too: rest is the mean of it.
struct MeanRest {
  Points shape;
  Vec3 force = Vec3::Zero();  ///< of the fixed link, N
  double kinetic_energy_j = 0;
};

/// Goes on by itself; the mean of the last `counted` steps.
MeanRest rest_of(Chain& chain, int steps, int counted) {
  MeanRest mean{.shape = Points::Zero(3, chain.shape().cols())};
  for (int k = 0; k < steps; ++k) {
    const StepReport step = step_or_exit(chain.scene, chain.built);
    if (k < steps - counted) continue;
    mean.shape += chain.shape() / counted;
    mean.force += holding_force(chain) / counted;
    mean.kinetic_energy_j += step.kinetic_energy_j / counted;
  }
  return mean;
}

/// A hanging chain of three without friction: all go on from the same state near rest.
void compare_rest() {
  constexpr int near_rest = 1000, steps = 1000, counted = 200;
  const std::string name = "chain3_vertical";
  Chain exact = make_chain(name, ContactMethod::exact, 1, 0);
  settle(exact, near_rest);
  std::vector<Rival> rivals;
  add_warped(name, 0, false, rivals);
  add_hair_off(name, 0, rivals);
  for (Rival& rival : rivals) take_state(rival.chain, exact);
  set_velocities(rivals.back().chain, hair_m_s);
  const MeanRest truth = rest_of(exact, steps, counted);
  const auto& asset = exact.built.world.asset(exact.first_elastic());
  const double weight =
      9.81 * (1000 * mass_properties(exact.built.shapes.back()).volume + asset.model().total_mass());
  for (Rival& rival : rivals) {
    const MeanRest mean = rest_of(rival.chain, steps, counted);
    ResultHash hash;
    hash.add(rival.chain.built.world.positions(rival.chain.first_elastic()));
    print_row("chain3_rest.shape_error" + rival.row, "%",
              100 * shape_error(mean.shape, truth.shape, as_matrix(asset.model().rest_positions())),
              hash);
    print_row("chain3_rest.force_error" + rival.row, "mg",
              (mean.force - Vec3(0, 0, weight)).norm() / weight, hash);
    print_row("chain3_rest.kinetic_energy" + rival.row, "J", mean.kinetic_energy_j, hash);
  }
}

}  // namespace

int main() {
  compare("chain3_horizontal", 200);
  compare("chain3_vertical", 200);
  compare("chain5_horizontal", 100);
  compare_rest();
  return 0;
}
