// SPDX-License-Identifier: MIT
// Signorini's and Coulomb's laws as scenes: references 4.2, 4.3, equilibrium, energy.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/box_mesh.hpp"
#include "tests/support/dense_compliance.hpp"
#include "tests/support/scenes.hpp"

namespace souple {
namespace {

using namespace test;

constexpr double g = 9.81;

// A cube of 0.1 m, stiff enough that its deformation (1e-5 of its size) does not blur rigid formulas.
std::shared_ptr<const SoftBodyAsset> stiff_block(int cells, double h, double density = 1000) {
  return make_body(box_mesh({cells, cells, cells}, {-0.05, -0.05, 0}, {0.1, 0.1, 0.1}),
                   material_of(1e7, 0.3, density, 0, 1e-3), h);
}

WorldSettings settings_for(double h, double friction, double slope_deg = 0) {
  WorldSettings settings;
  settings.time_step_s = h;
  settings.friction = friction;
  const double slope = slope_deg * M_PI / 180;
  settings.gravity_m_s2 = {g * std::sin(slope), 0, -g * std::cos(slope)};
  return settings;
}

struct SlopeResult {
  double acceleration, tangential, normal, drift;
};

SlopeResult run_slope(double slope_deg, double friction) {
  const double h = 2e-3;
  World world = make_world(settings_for(h, friction, slope_deg));
  const auto block = stiff_block(2, h);
  const BodyId body = add_soft(world, block, Vec3::Zero());
  add_plane(world);
  for (int k = 0; k < 200; ++k) step(world);
  const Vec3 start = centre_of_mass(world, body);
  const double v0 = mean_velocity(world, body).x();
  Vec3 force = Vec3::Zero();
  const int steps = 200;
  for (int k = 0; k < steps; ++k) {
    step(world);
    force += contact_force(world, body) / steps;
  }
  return {(mean_velocity(world, body).x() - v0) / (steps * h), -force.x(), force.z(),
          (centre_of_mass(world, body) - start).norm()};
}

TEST(WorldLaws, BlockSticksJustBelowAndSlidesJustAboveTheFrictionAngle) {  // 4.2
  const double mass = stiff_block(2, 2e-3)->model().total_mass();
  const SlopeResult stuck = run_slope(26, 0.5), sliding = run_slope(27, 0.5);
  EXPECT_LT(stuck.drift, 1e-7);
  EXPECT_NEAR(stuck.tangential, mass * g * std::sin(26 * M_PI / 180), 1e-4 * mass * g);
  EXPECT_NEAR(stuck.normal, mass * g * std::cos(26 * M_PI / 180), 1e-4 * mass * g);
  EXPECT_NEAR(sliding.acceleration, 0.0832598, 2e-4);
  EXPECT_NEAR(sliding.normal, mass * g * std::cos(27 * M_PI / 180), 1e-3 * mass * g);
  EXPECT_NEAR(sliding.tangential, 0.5 * sliding.normal, 1e-6 * mass * g);
}

TEST(WorldLaws, APairOfBodiesHasAFrictionOfItsOwnOrNoContact) {
  // On one slope: the first block sticks as the world has it, the second slides as its pair has it, the
  // third falls through. Asked in both orders.
  const double h = 2e-3, slope = 20 * M_PI / 180;
  World world = make_world(settings_for(h, 0.5, 20));
  const auto block = stiff_block(2, h);
  BodyId body[3];
  for (int k = 0; k < 3; ++k) body[k] = add_soft(world, block, {0, 0.5 * k, 0});
  const BodyId plane = add_plane(world);
  ASSERT_TRUE(world.set_pair(body[1], plane, {0.2, true}).ok());
  ASSERT_TRUE(world.set_pair(plane, body[2], {0.5, true}).ok());
  ASSERT_TRUE(world.set_pair(plane, body[2], {0.5, false}).ok()) << "the last one holds";
  for (int k = 0; k < 200; ++k) step(world);
  const double t = 200 * h;
  EXPECT_LT(mean_velocity(world, body[0]).norm(), 1e-6);
  EXPECT_NEAR(mean_velocity(world, body[1]).x(), g * (std::sin(slope) - 0.2 * std::cos(slope)) * t,
              1e-2);
  EXPECT_NEAR(mean_velocity(world, body[2]).z(), -g * std::cos(slope) * t, 1e-6);
  EXPECT_EQ(contact_force(world, body[2]).norm(), 0);
}

TEST(WorldLaws, SlidingAccelerationOnSteepSlopesHasTheClosedForm) {  // 4.2
  EXPECT_NEAR(run_slope(30, 0.5).acceleration, 0.657145, 1e-3);
  EXPECT_NEAR(run_slope(45, 0.5).acceleration, 3.468358, 2e-3);
}

double stopping_distance(int cells, double density) {
  const double h = 1e-3;
  World world = make_world(settings_for(h, 0.3));
  const auto block = stiff_block(cells, h, density);
  const BodyId body = add_soft(world, block, Vec3::Zero());
  add_plane(world);
  for (int k = 0; k < 100; ++k) step(world);
  const double start = centre_of_mass(world, body).x();
  set_velocity(world, body, {2, 0, 0});
  for (int k = 0; k < 900; ++k) step(world);
  EXPECT_LT(mean_velocity(world, body).norm(), 1e-4);
  return centre_of_mass(world, body).x() - start;
}

TEST(WorldLaws, SlidingBlockStopsAfterTheClosedFormDistance) {  // 4.3, with the offset of the scheme
  const double expected = 0.678579;
  EXPECT_NEAR(stopping_distance(1, 1000), expected, 1e-3 * expected);
  EXPECT_NEAR(stopping_distance(3, 1000), expected, 1e-3 * expected);
  EXPECT_NEAR(stopping_distance(1, 4000), expected, 1e-3 * expected);
}

TEST(WorldLaws, AtRestForcesCarryTheWeightExactlyAndNothingMoves) {
  const double h = 0.01;
  const auto body_asset =
      make_body(irregular_box_mesh({4, 3, 3}, {-0.1, -0.1, 0}, {0.2, 0.15, 0.15}, 1),
                material_of(1e4, 0.4, 1000, 0.1, 0.01), h);
  const double mass = body_asset->model().total_mass();
  for (const auto method : {ContactMethod::warped, ContactMethod::exact}) {
    WorldSettings settings = settings_for(h, 0.4);
    settings.contact_method = method;
    World world = make_world(settings);
    const BodyId body = add_soft(world, body_asset, {0, 0, 0.05}, turned(20, {1, 0.3, 0.2}));
    add_plane(world);
    StepReport report;
    for (int k = 0; k < 1200; ++k) report = step(world);
    EXPECT_LT(report.kinetic_energy_j, 1e-8 * mass * g * 0.2);
    EXPECT_LT((contact_force(world, body) - Vec3(0, 0, mass * g)).norm(), 1e-4 * mass * g);
    EXPECT_LT(report.worst_penetration_m, 1e-9);
    EXPECT_LT(report.cone_violation, 1e-12);
    EXPECT_LT(report.contact_residual, 1e-6);
  }
}

TEST(WorldLaws, WithoutFedForwardForcesTheWeightIsCarriedOnlyApproximately) {
  // The old scheme, kept as an option: at rest C_warped H^T f = A^-1 H^T f_true (METHOD 4.2).
  const double h = 0.01;
  const auto body_asset = make_body(box_mesh({4, 3, 3}, {-0.1, -0.1, 0}, {0.2, 0.15, 0.15}),
                                    material_of(5e3, 0.4, 1000, 0.1, 0.01), h);
  const double mass = body_asset->model().total_mass();
  double error[2];
  for (const bool feed : {false, true}) {
    WorldSettings settings = settings_for(h, 0.4);
    settings.feed_forward_forces = feed;
    World world = make_world(settings);
    const BodyId body = add_soft(world, body_asset, {0, 0, 0.01}, turned(75, {0, 1, 0}));
    add_plane(world, Mat3::Identity(), {0, 0, -0.1});
    for (int k = 0; k < 900; ++k) step(world);
    error[feed] = (contact_force(world, body) - Vec3(0, 0, mass * g)).norm() / (mass * g);
  }
  EXPECT_LT(error[1], 1e-4);
  EXPECT_GT(error[0], 10 * error[1]);
  EXPECT_LT(error[0], 0.2);
}

TEST(WorldLaws, EveryStepOfADropObeysTheLaws) {
  const double h = 0.01;
  const auto body_asset = make_body(box_mesh({4, 4, 4}, {-0.1, -0.1, 0}, {0.2, 0.2, 0.2}),
                                    material_of(1e4, 0.4, 1000, 0.1, 0.01), h);
  World world = make_world(settings_for(h, 0.4));
  add_soft(world, body_asset, {0, 0, 0.2}, turned(40, {1, 1, 0}));
  add_plane(world);
  add_sphere(world, 0.05, {0.02, 0, 0.02});
  add_box(world, {0.03, 0.03, 0.03}, {-0.1, -0.05, 0.03}, turned(30, {0, 0, 1}));
  double last_energy = INFINITY;
  std::size_t contacts = 0;
  for (int k = 0; k < 300; ++k) {
    const StepReport report = step(world);
    contacts = std::max(contacts, report.active_count);
    EXPECT_LT(report.cone_violation, 1e-12);
    EXPECT_LT(report.contact_residual, 1e-5);
    EXPECT_LT(report.free_motion_residual, 1e-7);
    // Curved and cornered shapes: the gap is linearised over a step, resolved in the following ones.
    EXPECT_LT(report.worst_penetration_m, 0.02 * 0.2) << "step " << k;
    const double energy = report.kinetic_energy_j + report.elastic_energy_j + report.potential_energy_j;
    // The lagged rotations make implicit Euler not exactly dissipative: a share of the fall's energy.
    EXPECT_LT(energy, last_energy + 0.02 * 8 * g * 0.2) << "step " << k;
    last_energy = energy;
  }
  EXPECT_GT(contacts, 10u);
}

}  // namespace
}  // namespace souple
