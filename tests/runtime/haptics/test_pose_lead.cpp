// SPDX-License-Identifier: MIT
// Looking ahead by what a device is late by.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "runtime/haptics/devices/recorded_path.hpp"
#include "runtime/haptics/devices/synthetic_hand.hpp"
#include "runtime/haptics/pose_lead.hpp"
#include "runtime/world/rigid_path.hpp"
#include "tests/support/tool_scenes.hpp"

namespace souple {
namespace {

using namespace test;

constexpr double tick_s = 0.001, lead_s = 0.0015, radius = 0.02, stiffness = 800;

// A steady screw: line and turn at constant speeds in world axes.
DeviceSample steady(double t) {
  const Vec3 axis = Vec3(1, 2, -2) / 3;
  DeviceSample sample = sample_at(t, Vec3(0.1, -0.2, 0.3) + t * Vec3(0.2, 0.1, -0.05),
                                  Mat3(Eigen::AngleAxisd(0.7 + 3 * t, axis)), 0.1 + 0.5 * t);
  return sample;
}

void expect_same(const DeviceSample& a, const DeviceSample& b, double tolerance) {
  EXPECT_LE((as_vec3(a.pose.translation) - as_vec3(b.pose.translation)).norm(), tolerance);
  EXPECT_LE((placement(a.pose).rotation - placement(b.pose).rotation).norm(), tolerance);
  EXPECT_NEAR(a.opening_rad, b.opening_rad, tolerance);
}

TEST(PoseLead, SteadyMotionIsFollowedExactly) {
  PoseLead lead(lead_s);
  for (int k = 0; k < 20; ++k) {
    lead.add(steady(k * tick_s));
    if (k >= 1) expect_same(lead.ahead(), steady(k * tick_s + lead_s), 1e-12);
  }
}

TEST(PoseLead, WithoutALeadOrAMotionTheSampleIsTheSample) {
  PoseLead none(0), one(lead_s), late(lead_s), elsewhere(lead_s);
  for (int k = 0; k < 5; ++k) none.add(steady(k * tick_s));
  one.add(steady(0));
  late.add(steady(0));
  late.add(steady(1));
  for (int k = 0; k < 5; ++k) elsewhere.add(steady(k * tick_s));
  elsewhere.restart();
  elsewhere.add(steady(3));
  expect_same(none.ahead(), steady(4 * tick_s), 0);
  expect_same(one.ahead(), steady(0), 0);
  expect_same(late.ahead(), steady(1), 0);
  expect_same(elsewhere.ahead(), steady(3), 0);
}

struct BallOnPlane {
  explicit BallOnPlane(const HapticSettings& settings)
      : world(make_world({})), channel((add_plane(world), hold(settings))) {}
  HapticChannel hold(const HapticSettings& settings) {
    HandleCoupling coupling;
    coupling.stiffness_n_m = stiffness;
    coupling.turn_stiffness_nm_rad = 1e6;
    coupling.look_ahead_m = 0.005;
    return make_channel(add_tool(world, sphere_shape(radius), coupling, {0, 0, radius + 1e-5}),
                        settings);
  }
  World world;
  HapticChannel channel;
};

TEST(PoseLead, AHandThatPressesFeelsWhatItWillPress) {
  HapticSettings settings = patient_settings();
  settings.lead_s = lead_s;
  BallOnPlane scene(settings);
  scene.channel.tick(sample_at(0, {0, 0, radius + 1e-5}));
  physics_step(scene.world, scene.channel);
  const double speed = 0.1;
  for (int k = 1; k <= 20; ++k) {
    const double depth = speed * tick_s * k;
    const Vec3 force = force_of(scene.channel.tick(sample_at(k * tick_s, {0, 0, radius - depth})));
    if (k <= 5) continue;
    EXPECT_NEAR(force.z(), stiffness * (depth + speed * lead_s), 1e-3 * force.z());
  }
}

// A mass on a spring that is late: without the lead the swing grows, with it the hand comes to rest.
double swing(double lead, double k_contact) {
  HapticSettings settings;
  settings.tick_budget_s = std::numeric_limits<double>::infinity();
  settings.lead_s = lead;
  settings.reach_m = 0.05;
  World world = make_world({});
  add_plane(world);
  HandleCoupling coupling;
  coupling.stiffness_n_m = k_contact;
  coupling.look_ahead_m = 0.005;
  const Vec3 start(0, 0, radius + 0.005);
  HapticChannel channel =
      make_channel(add_tool(world, sphere_shape(radius), coupling, start), settings);
  SyntheticHandSettings hand_settings;
  hand_settings.model = hand_of_grip(0.4);
  hand_settings.delay_samples = 1;
  auto path = RecordedPath::create({sample_at(0, start), sample_at(0.3, {0, 0, radius - 0.008})});
  auto hand = SyntheticHand::create(*path, hand_settings);
  double low = 1, high = -1;
  DeviceSample sample;
  for (int k = 0; k < 2000; ++k) {
    hand->read(sample);
    const Wrench wrench = channel.tick(sample);
    if (k % 10 == 0) physics_step(world, channel);
    hand->write(wrench);
    if (k < 1600) continue;
    low = std::min(low, hand->truth().pose.translation[2]);
    high = std::max(high, hand->truth().pose.translation[2]);
  }
  return high - low;
}

TEST(PoseLead, WhatADeviceIsLateByNoLongerShakesAStiffContact) {
  const double k_contact = 2000;
  EXPECT_GT(swing(0, k_contact), 1e-3);
  EXPECT_LT(swing(lead_s, k_contact), 1e-5);
}

}  // namespace
}  // namespace souple
