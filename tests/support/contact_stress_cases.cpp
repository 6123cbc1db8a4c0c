// SPDX-License-Identifier: MIT
#include "tests/support/contact_stress_cases.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>

#include "tests/support/box_mesh.hpp"
#include "tests/support/dense_compliance.hpp"
#include "tests/support/rigid_scenes.hpp"

namespace souple::test {
namespace {

using Asset = std::shared_ptr<const SoftBodyAsset>;

Asset cube(int cells, double young, double h) {
  return make_body(box_mesh({cells, cells, cells}, {-0.05, -0.05, -0.05}, {0.1, 0.1, 0.1}),
                   material_of(young, 0.3, 1000, 0.1, 0.01), h);
}

struct Bounds {
  double penetration_m = 1e-3;  ///< a hundredth of the bodies' side
  double energy_gain = 0.02;
  int settled = 10;   ///< steps after which nothing may overlap any more
  double unit_j = 0;  ///< what a gain is relative to; 0: the energy of the first step above its floor
};

// Energy that is put in by driven bodies and held ones is not known: such cases allow any gain.
ContactStressOutcome run(std::string name, World& world, int steps, const Bounds& bounds) {
  ContactStressOutcome outcome;
  outcome.name = std::move(name);
  outcome.allowed_penetration_m = bounds.penetration_m;
  outcome.allowed_gain = bounds.energy_gain;
  double first = 0;
  for (int k = 0; k < steps; ++k) {
    const auto report = world.step();
    if (!report) {
      outcome.refused = format_issue(report.issue());
      break;
    }
    const double energy = energy_of(*report);
    if (k == 0) first = energy;
    if (!std::isfinite(energy)) outcome.refused = "not finite";
    if (k >= bounds.settled)
      outcome.worst_penetration_m = std::max(outcome.worst_penetration_m, report->worst_penetration_m);
    outcome.cone_violation = std::max(outcome.cone_violation, report->cone_violation);
    const double unit = bounds.unit_j > 0 ? bounds.unit_j : std::max(std::abs(first), 1e-6);
    outcome.energy_gain = std::max(outcome.energy_gain, (energy - first) / unit);
    outcome.most_contacts = std::max(outcome.most_contacts, report->contact_count);
  }
  return outcome;
}

WorldSettings settings_of(double h, double friction) {
  WorldSettings settings;
  settings.time_step_s = h;
  settings.friction = friction;
  return settings;
}

ContactStressOutcome mass_ratio() {
  World world = make_world(settings_of(0.01, 0.4));
  add_plane(world);
  add_free(world, box_shape({0.05, 0.05, 0.05}), {0, 0, 0.05}, Mat3::Identity(), weighing(0.01));
  add_free(world, box_shape({0.05, 0.05, 0.05}), {0, 0, 0.1501}, Mat3::Identity(), weighing(100));
  return run("mass ratio 1e4: the heavy on the light", world, 300, {});
}

ContactStressOutcome stiffness_ratio() {
  World world = make_world(settings_of(0.01, 0.4));
  add_plane(world);
  add_soft(world, cube(3, 1e4, 0.01), {0, 0, 0.05});
  add_soft(world, cube(3, 1e10, 0.01), {0, 0, 0.151});
  add_free(world, box_shape({0.06, 0.06, 0.01}), {0, 0, 0.213}, Mat3::Identity(), weighing(0.05));
  return run("stiffness ratio 1e6 in one island, and a rigid plate", world, 300, {});
}

ContactStressOutcome friction_of(double mu) {
  char name[64];
  std::snprintf(name, sizeof name, "friction %.1f: soft and rigid on a slope of 35 degrees", mu);
  WorldSettings settings = settings_of(0.01, mu);
  settings.gravity_m_s2 = gravity_on_slope(35);
  World world = make_world(settings);
  add_plane(world);
  add_soft(world, cube(3, 2e4, 0.01), {0, 0, 0.051});
  add_free(world, box_shape({0.05, 0.05, 0.03}), {0.3, 0, 0.031});
  return run(name, world, 200, {.unit_j = 1.3 * 9.81 * 0.1});
}

ContactStressOutcome redundant_contacts() {
  World world = make_world(settings_of(0.01, 0.5));
  add_plane(world);
  const Asset plate = make_body(box_mesh({22, 22, 1}, {-0.1, -0.1, 0}, {0.2, 0.2, 0.02}),
                                material_of(1e6, 0.3, 1000, 0.1, 0.01), 0.01);
  add_soft(world, plate, {0, 0, 0.002}, turned(1, {1, 1, 0}));
  return run("529 redundant contacts on one face", world, 60, {.unit_j = 0.8 * 9.81 * 0.01});
}

ContactStressOutcome jammed_wedge() {
  World world = make_world(settings_of(0.01, 0.8));
  const RigidShape wall = box_shape({0.05, 0.2, 0.3});
  for (const double side : {-1.0, 1.0})
    add_driven(world, wall, {{0, pose_of(turned(8 * side, {0, 1, 0}), {0.095 * side, 0, 0})}});
  add_soft(world, cube(3, 2e4, 0.01), {0, 0, 0.12}, Mat3::Identity(), {0, 0, -2});
  return run("wedge of 16 degrees, jammed at 2 m/s", world, 300,
             {.penetration_m = 2e-3, .unit_j = 2.5});
}

ContactStressOutcome turning_gripper() {
  World world = make_world(settings_of(0.01, 1));
  const RigidShape jaw = box_shape({0.02, 0.06, 0.06});
  for (const double side : {-1.0, 1.0}) {
    std::vector<Keyframe> path;
    for (int k = 0; k <= 80; ++k) {
      const double t = 0.05 * k, close = std::min(t / 0.5, 1.0);
      const Mat3 turn = turned(t > 1 ? 360 * (t - 1) / 1.5 : 0, {1, 0.5, 0.2});
      path.push_back({t, pose_of(turn, turn * Vec3(side * (0.071 - 0.006 * close), 0, 0))});
    }
    add_driven(world, jaw, path);
  }
  add_soft(world, cube(3, 2e4, 0.01), {0, 0, 0});
  return run("closed gripper through two full turns", world, 400, {.energy_gain = 1e9});
}

ContactStressOutcome step_of(double h) {
  char name[64];
  std::snprintf(name, sizeof name, "h %.0f ms: soft and rigid dropped", 1e3 * h);
  World world = make_world(settings_of(h, 0.4));
  add_plane(world);
  add_soft(world, cube(3, 2e4, h), {0, 0, 0.2}, turned(25, {1, 2, 0}));
  add_free(world, box_shape({0.05, 0.04, 0.03}), {0.02, 0, 0.4}, turned(40, {0, 1, 1}));
  // A gap is linear over a step, a turn is not: second order in h.
  return run(name, world, int(1.5 / h), {.penetration_m = 15 * h * h});
}

ContactStressOutcome overlap_of(const std::string& name, const std::function<void(World&)>& fill) {
  World world = make_world(settings_of(0.01, 0.4));
  add_plane(world);
  fill(world);
  // Pushing out costs what lifting by the overlap would, and what is squeezed; 4 cm at a side of 0.1 m
  // a second take 40 steps.
  return run(name, world, 300,
             {.penetration_m = 5e-3, .energy_gain = 3, .settled = 60, .unit_j = 2 * 9.81 * 0.1});
}

}  // namespace

std::vector<ContactStressOutcome> run_contact_stress() {
  std::vector<ContactStressOutcome> all{mass_ratio(), stiffness_ratio()};
  for (const double mu : {0.0, 0.2, 0.5, 0.7, 1.0, 2.0}) all.push_back(friction_of(mu));
  all.push_back(redundant_contacts());
  all.push_back(jammed_wedge());
  all.push_back(turning_gripper());
  for (const double h : {1e-3, 2e-3, 5e-3, 1e-2, 2e-2, 5e-2}) all.push_back(step_of(h));
  all.push_back(overlap_of("overlap: soft half in the floor", [](World& world) {
    add_soft(world, cube(3, 2e4, 0.01), {0, 0, 0});
  }));
  all.push_back(overlap_of("overlap: rigid half in the floor", [](World& world) {
    add_free(world, box_shape({0.05, 0.05, 0.05}), {0, 0, 0});
  }));
  all.push_back(overlap_of("overlap: soft half in soft", [](World& world) {
    add_soft(world, cube(3, 2e4, 0.01), {0, 0, 0.05});
    add_soft(world, cube(3, 2e4, 0.01), {0.01, 0, 0.1});
  }));
  all.push_back(overlap_of("overlap: rigid half in rigid", [](World& world) {
    add_free(world, box_shape({0.05, 0.05, 0.05}), {0, 0, 0.05});
    add_free(world, box_shape({0.05, 0.05, 0.05}), {0.01, 0, 0.1});
  }));
  all.push_back(overlap_of("overlap: rigid half in soft", [](World& world) {
    add_soft(world, cube(3, 2e4, 0.01), {0, 0, 0.05});
    add_free(world, box_shape({0.04, 0.04, 0.04}), {0.01, 0, 0.1});
  }));
  return all;
}

std::string describe(const ContactStressOutcome& o) {
  char line[256];
  std::snprintf(line, sizeof line,
                "%-54s contacts %4zu penetration %.1e m cone %.0e energy gain %+.3f  %s",
                o.name.c_str(), o.most_contacts, o.worst_penetration_m, o.cone_violation, o.energy_gain,
                o.is_good()         ? "good"
                : o.refused.empty() ? "BAD"
                                    : o.refused.c_str());
  return line;
}

}  // namespace souple::test
