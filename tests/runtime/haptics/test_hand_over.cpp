// SPDX-License-Identifier: MIT
// What a hand feels when physics publishes, is slow, or has died, and when a device misbehaves: never a
// jump.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "tests/support/box_mesh.hpp"
#include "tests/support/dense_compliance.hpp"
#include "tests/support/tool_scenes.hpp"

namespace souple {
namespace {

using namespace test;

constexpr double radius = 0.02, stiffness = 800, tick_s = 0.001;

// A ball on a soft block that stands on a plane; the hand presses and wanders.
struct Pressing {
  explicit Pressing(const HapticSettings& settings) : world(make()), channel(hold(settings)) {}
  World make() {
    WorldSettings s;
    s.friction = 0.5;
    World made = make_world(s);
    add_soft(made,
             make_body(box_mesh({4, 4, 2}, {-0.05, -0.05, 0}, {0.1, 0.1, 0.04}),
                       material_of(1e4, 0.4, 1000, 0.1, 0.01), 0.01),
             {0, 0, 1e-5});
    add_plane(made);
    return made;
  }
  HapticChannel hold(const HapticSettings& settings) {
    HandleCoupling coupling;
    coupling.stiffness_n_m = stiffness;
    coupling.look_ahead_m = 0.003;
    return make_channel(add_tool(world, sphere_shape(radius), coupling, {0, 0, 0.08}), settings);
  }
  static Vec3 hand(double t) {
    const double depth = 0.006 * std::min(1.0, t / 0.2) * (1 + 0.2 * std::sin(9 * t));
    return {0.01 * std::sin(5 * t), 0.006 * std::cos(7 * t), 0.04 + radius + 5e-4 - depth};
  }
  /// A tick at the time; the force.
  Vec3 tick() {
    time += tick_s;
    return force_of(channel.tick(sample_at(time, hand(time))));
  }
  /// So many ticks with physics every `period` of them; the largest force and step of it.
  void run(int ticks, int period) {
    for (int k = 0; k < ticks; ++k) {
      if (k % period == 0) physics_step(world, channel);
      const Vec3 force = tick();
      largest_step = std::max(largest_step, (force - last).norm());
      largest_force = std::max(largest_force, force.norm());
      last = force;
    }
  }
  World world;
  HapticChannel channel;
  double time = 0, largest_step = 0, largest_force = 0;
  Vec3 last = Vec3::Zero();
};

HapticSettings unhurried() {
  HapticSettings settings;
  settings.tick_budget_s = std::numeric_limits<double>::infinity();
  return settings;
}

TEST(HandOver, ForceGoesOnWhereItWas) {
  Pressing scene(unhurried());
  scene.tick();
  scene.run(1500, 10);
  EXPECT_GT(scene.largest_force, 0.3);
  const HapticTelemetry told = scene.channel.telemetry();
  EXPECT_EQ(told.hand_overs, 150u);
  EXPECT_LE(told.largest_hand_over_step_n, 1e-9 + 0.03 * scene.largest_force);
  EXPECT_LE(scene.largest_step, 0.03 * scene.largest_force);
}

TEST(HandOver, SlowPhysicsStillGivesAForceWithoutJumps) {
  Pressing scene(unhurried());
  scene.tick();
  scene.run(500, 10);
  scene.largest_step = 0;
  scene.run(2000, 100);
  EXPECT_LE(scene.largest_step, 0.05 * scene.largest_force);
  EXPECT_EQ(scene.channel.telemetry().dead_ticks, 0u);
  EXPECT_NEAR(scene.channel.telemetry().longest_silence_s, 0.1, 1e-9);
}

TEST(HandOver, AToolThatWasTakenAwayIsExactlyFreeAfterAPeriod) {
  Pressing scene(unhurried());
  scene.tick();
  scene.run(500, 10);
  ASSERT_GT(scene.last.norm(), 0.1);
  const Vec3 from = Pressing::hand(scene.time);
  for (int k = 1; k <= 60; ++k) {
    if (k % 10 == 0) physics_step(scene.world, scene.channel);
    scene.time += tick_s;
    const Vec3 force =
        force_of(scene.channel.tick(sample_at(scene.time, from + Vec3(0, 0, 0.001 * k))));
    if (k > 40) {
      EXPECT_EQ(force, Vec3(Vec3::Zero()));
    }
  }
}

TEST(HandOver, DeadPhysicsFadesToNothingAndComesBack) {
  HapticSettings settings = unhurried();
  Pressing scene(settings);
  scene.tick();
  scene.run(400, 10);
  const double before = scene.last.norm();
  ASSERT_GT(before, 0.1);
  scene.largest_step = 0;
  scene.run(600, 100000);
  EXPECT_EQ(scene.last, Vec3(Vec3::Zero())) << "0.3 s until it is taken for dead, 0.2 s to fade";
  EXPECT_GE(scene.channel.telemetry().dead_ticks, 250u);
  scene.run(400, 10);
  EXPECT_GT(scene.last.norm(), 0.1);
  EXPECT_LE(scene.largest_step, 0.03 * scene.largest_force);
}

TEST(HandOver, BeyondItsReachTheLinearProblemIsNotBelieved) {
  HapticSettings settings = unhurried();
  settings.reach_m = 0.002;
  Pressing scene(settings);
  scene.tick();
  scene.run(300, 10);
  const Vec3 at = Pressing::hand(scene.time);
  double last = 0;
  for (int k = 1; k <= 50; ++k) {
    scene.time += tick_s;
    last = force_of(scene.channel.tick(sample_at(scene.time, at - Vec3(0, 0, 0.0005 * k)))).norm();
  }
  EXPECT_LE(last, scene.last.norm() + 2.5 * stiffness * settings.reach_m);
  EXPECT_GT(scene.channel.telemetry().clamped_ticks, 40u);
}

TEST(BadInput, IsHeldCountedAndNeverPassedOnAsAForce) {
  Pressing scene(unhurried());
  scene.tick();
  scene.run(400, 10);
  const Vec3 hand = Pressing::hand(scene.time);
  const auto tick = [&](const DeviceSample& sample) { return force_of(scene.channel.tick(sample)); };
  for (int k = 0; k < 30; ++k) scene.last = tick(sample_at(scene.time += tick_s, hand));
  const double slack = 0.01 * scene.last.norm();
  const auto expect_held = [&](const Vec3& force) {
    ASSERT_TRUE(force.allFinite());
    EXPECT_LE((force - scene.last).norm(), slack);
  };
  const auto count = [&] { return scene.channel.telemetry(); };
  const double nan = NAN, t = scene.time;
  expect_held(tick(sample_at(t + 0.001, {nan, 0, 0})));
  expect_held(tick(sample_at(nan, hand)));
  expect_held(tick(sample_at(t + 0.001, hand, Mat3::Identity(), INFINITY)));
  DeviceSample no_turn = sample_at(t + 0.001, hand);
  no_turn.pose.rotation = {0, 0, 0, 0};
  expect_held(tick(no_turn));
  EXPECT_EQ(count().refused_not_finite, 4u);
  expect_held(tick(sample_at(t + 0.002, hand + Vec3(1, 0, 0))));
  expect_held(tick(sample_at(t + 0.9, hand + Vec3(0, 0, -1))));
  expect_held(tick(sample_at(t + 0.003, hand, turned(170, {1, 0, 0}))));
  EXPECT_EQ(count().refused_jumps, 3u);
  expect_held(tick(sample_at(t - 5, hand)));
  expect_held(tick(sample_at(t, hand)));
  EXPECT_EQ(count().refused_clock, 2u);
  for (int k = 0; k < 5; ++k) expect_held(force_of(scene.channel.tick()));
  EXPECT_EQ(count().missing_samples, 5u);
  expect_held(tick(sample_at(t + 0.016, hand)));
  DeviceSample newest;
  ASSERT_TRUE(scene.channel.newest_sample(newest));
  EXPECT_EQ(newest.time_s, t + 0.016) << "physics is told of what is believed, and of nothing else";
  EXPECT_LT((as_vec3(newest.pose.translation) - hand).norm(), 1e-15);
}

TEST(BadInput, ADeviceThatStaysElsewhereIsBelievedInTheEndFromZeroUp) {
  Pressing scene(unhurried());
  scene.tick();
  scene.run(400, 10);
  const Vec3 place = Pressing::hand(scene.time) + Vec3(1.5, 0, 0);
  const double clock = -100;  // it was switched off and on
  for (int k = 0; k < 300; ++k) {
    if (k % 10 == 0) physics_step(scene.world, scene.channel);
    const Vec3 force = force_of(scene.channel.tick(sample_at(clock + k * tick_s, place)));
    EXPECT_LE((force - scene.last).norm(), 0.03 * scene.largest_force) << k;
    scene.last = force;
  }
  EXPECT_EQ(scene.channel.telemetry().recoveries, 1u);
  EXPECT_EQ(scene.last, Vec3(Vec3::Zero())) << "there is nothing there";
}

TEST(DeviceLimits, AreAppliedLast) {
  HapticSettings settings = unhurried();
  settings.limits.force_n = 0.2;
  settings.limits.torque_nm = 0.001;
  settings.limits.force_slew_n_s = 2;
  Pressing scene(settings);
  scene.tick();
  for (int k = 0; k < 600; ++k) {
    if (k % 10 == 0) physics_step(scene.world, scene.channel);
    scene.time += tick_s;
    const Wrench wrench = scene.channel.tick(sample_at(scene.time, Pressing::hand(scene.time)));
    EXPECT_LE(force_of(wrench).norm(), 0.2 + 1e-12);
    EXPECT_LE(torque_of(wrench).norm(), 0.001 + 1e-12);
    EXPECT_LE((force_of(wrench) - scene.last).norm(), 2 * tick_s * (1 + 1e-9));
    scene.last = force_of(wrench);
  }
  EXPECT_NEAR(scene.last.norm(), 0.2, 1e-9);
  EXPECT_GT(scene.channel.telemetry().limited_ticks, 100u);
}

}  // namespace
}  // namespace souple
