// SPDX-License-Identifier: MIT
// Impacts with restitution: rebound heights, and no energy from nothing.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/box_mesh.hpp"
#include "tests/support/dense_compliance.hpp"
#include "tests/support/rigid_scenes.hpp"

namespace souple {
namespace {

using namespace test;

constexpr double g = 9.81;

TEST(Restitution, BallReboundsToESquaredOfItsHeight) {
  for (const double e : {0.0, 0.5, 0.8, 1.0}) {
    WorldSettings settings;
    settings.time_step_s = 1e-3;
    World world = make_world(settings);
    const BodyId ball = add_free(world, sphere_shape(0.05), {0, 0, 1.05});
    const BodyId plane = add_plane(world);
    ASSERT_TRUE(world.set_pair(ball, plane, {0.3, true, e}).ok());
    double start = 0, highest = 0;
    bool has_hit = false;
    for (int k = 0; k < 1000; ++k) {
      const StepReport report = step(world);
      // Within the step of the impact it does not fall the last part of its way: at most m g h v.
      if (k == 0) start = energy_of(report);
      EXPECT_LT(energy_of(report), start + 0.524 * g * 1e-3 * std::sqrt(2 * g)) << "e " << e;
      has_hit = has_hit || !world.contact_events().empty();
      if (has_hit) highest = std::max(highest, place_of(world, ball).z() - 0.05);
      ASSERT_GT(place_of(world, ball).z(), 0.05 - 1e-6);
    }
    EXPECT_NEAR(highest, e * e, 0.02) << e;
  }
}

TEST(Restitution, EqualBallsExchangeTheirVelocities) {
  for (const double e : {0.0, 0.5, 1.0}) {
    WorldSettings settings;
    settings.time_step_s = 1e-3;
    settings.gravity_m_s2 = {0, 0, 0};
    World world = make_world(settings);
    const BodyId a =
        add_free(world, sphere_shape(0.05), {0, 0, 0}, Mat3::Identity(), moving({1, 0, 0}));
    const BodyId b = add_free(world, sphere_shape(0.05), {0.2, 0, 0});
    ASSERT_TRUE(world.set_pair(a, b, {0.3, true, e}).ok());
    for (int k = 0; k < 300; ++k) step(world);
    EXPECT_NEAR(speed_of(world, a).x(), (1 - e) / 2, 1e-9);
    EXPECT_NEAR(speed_of(world, b).x(), (1 + e) / 2, 1e-9);
  }
}

TEST(Restitution, NeverAddsEnergyToATumblingBoxOrASoftBody) {
  for (const double e : {0.0, 0.5, 1.0})
    for (const double mu : {0.0, 0.5}) {
      WorldSettings settings;
      settings.time_step_s = 5e-3;
      World world = make_world(settings);
      const BodyId box = add_free(world, box_shape({0.05, 0.04, 0.03}), {0, 0, 0.5},
                                  turned(40, {1, 2, 0}), moving({0.5, 0, 0}, {3, 1, 2}));
      const BodyId soft =
          add_soft(world,
                   make_body(box_mesh({2, 2, 2}, {-0.05, -0.05, -0.05}, {0.1, 0.1, 0.1}),
                             material_of(5e4, 0.3, 1000, 0, 0.002), 5e-3),
                   {0.4, 0, 0.4}, turned(20, {1, 1, 0}));
      const BodyId plane = add_plane(world);
      ASSERT_TRUE(world.set_pair(box, plane, {mu, true, e}).ok());
      ASSERT_TRUE(world.set_pair(soft, plane, {mu, true, e}).ok());
      double most = 0;
      for (int k = 0; k < 600; ++k) {
        const double energy = energy_of(step(world));
        if (k == 0) most = energy;
        ASSERT_LT(energy, 1.02 * most) << "e " << e << " mu " << mu << " step " << k;
      }
    }
}

TEST(Restitution, LeavesWhatRestsAtRest) {
  World world = make_world(WorldSettings{});
  const BodyId plane = add_plane(world);
  const BodyId box = add_free(world, box_shape({0.05, 0.05, 0.05}), {0, 0, 0.05});
  ASSERT_TRUE(world.set_pair(box, plane, {0.5, true, 1}).ok());
  for (int k = 0; k < 300; ++k) {
    step(world);
    ASSERT_LT(speed_of(world, box).norm(), 1e-6);
  }
}

}  // namespace
}  // namespace souple
