// SPDX-License-Identifier: MIT
// A hand on the C interface feels what it feels through the C++ channel.
#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <cstring>
#include <limits>
#include <thread>

#include "c_scene.hpp"
#include "runtime/haptics/haptic_channel.hpp"
#include "runtime/load/load_soft_body.hpp"
#include "runtime/world/soft_body_asset.hpp"
#include "tests/support/allocation_count.hpp"

namespace souple {
namespace {

using namespace test;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr int ticks_per_step = 10;
// Ticks must not depend on the wall clock where bits are compared.
constexpr double no_budget_s = 1e9;

// The hand comes down on the body from above, then rests: 20 mm deep in the box.
double height_m(int tick) { return 0.13 - 1e-4 * std::min(tick, 400); }

struct CHand {
  CHand() {
    soft = add_c_soft(world.get(), asset.get(), 0, "bottom");
    auto jaw = initialised(souple_jaw_description_init);
    jaw.radius_m = 0.01;
    jaw.stiffness_n_m = 500;
    auto tool = initialised(souple_tool_description_init);
    tool.jaws = &jaw;
    tool.jaw_count = 1;
    tool.pose.translation_m.z = height_m(0);
    auto settings = initialised(souple_haptic_settings_init);
    settings.tick_budget_s = no_budget_s;
    settings.device_rate_hz = 1000;
    souple_haptic_channel* made = nullptr;
    EXPECT_EQ(souple_haptic_channel_create(world.get(), &tool, &settings, &made), SOUPLE_OK)
        << souple_last_error_what();
    channel.reset(made);
  }

  void step() {
    EXPECT_EQ(souple_haptic_begin_step(channel.get(), world.get()), SOUPLE_OK);
    EXPECT_EQ(souple_world_step(world.get(), nullptr), SOUPLE_OK);
    EXPECT_EQ(souple_haptic_publish(channel.get(), world.get()), SOUPLE_OK);
  }

  souple_wrench tick(int index) {
    const souple_device_sample sample{1e-3 * (index + 1), {{1, 0, 0, 0}, {0, 0, height_m(index)}}, 0};
    souple_wrench wrench{};
    EXPECT_EQ(souple_haptic_tick(channel.get(), &sample, &wrench), SOUPLE_OK);
    return wrench;
  }

  souple_haptic_telemetry telemetry() const {
    auto read = initialised(souple_haptic_telemetry_init);
    EXPECT_EQ(souple_haptic_get_telemetry(channel.get(), &read), SOUPLE_OK);
    return read;
  }

  AssetHandle asset = open_asset();
  WorldHandle world = make_c_world();
  ChannelHandle channel;
  souple_body soft = 0;
};

struct CppHand {
  CppHand() : world(World::create({}).value()), channel(make()) {}

  HapticChannel make() {
    SoftBodyDescription soft;
    soft.fixed_set = "bottom";
    EXPECT_TRUE(world.add_soft_body(*load_soft_body(asset_file()), soft));
    ToolDescription description;
    description.pose.translation[2] = height_m(0);
    JawDescription jaw;
    jaw.shape.kind = RigidShapeKind::sphere;
    jaw.shape.radius_m = 0.01;
    jaw.coupling.stiffness_n_m = 500;
    description.jaws = {jaw};
    HapticSettings settings;
    settings.tick_budget_s = no_budget_s;
    settings.limits.rate_hz = 1000;
    return HapticChannel::create(*Tool::create(world, description), settings).value();
  }

  void step() {
    EXPECT_TRUE(channel.begin_step(world));
    EXPECT_TRUE(world.step());
    EXPECT_TRUE(channel.publish(world));
  }

  Wrench tick(int index) {
    return channel.tick({1e-3 * (index + 1), {{1, 0, 0, 0}, {0, 0, height_m(index)}}, 0});
  }

  World world;
  HapticChannel channel;
};

TEST(CHaptics, TheWrenchHasTheBitsOfTheCppChannel) {
  CHand c;
  CppHand cpp;
  souple_wrench felt{};
  for (int k = 0; k < 600; ++k) {
    if (k % ticks_per_step == 0) c.step(), cpp.step();
    felt = c.tick(k);
    const Wrench expected = cpp.tick(k);
    ASSERT_EQ(std::memcmp(&felt, &expected, sizeof felt), 0) << k;
    if (height_m(k) > 0.112) {  // above the body
      ASSERT_EQ(felt.force_n.z, 0) << k;
    }
  }
  EXPECT_GT(felt.force_n.z, 0.05);
  souple_wrench lawful{};
  double residual = 1;
  ASSERT_EQ(souple_haptic_last_tick(c.channel.get(), &lawful, &residual), SOUPLE_OK);
  EXPECT_LE(residual, 1e-3);
  EXPECT_NEAR(lawful.force_n.z, felt.force_n.z, 0.1 * felt.force_n.z);
}

TEST(CHaptics, ASampleThatIsNoneIsHeldAndCounted) {
  CHand hand;
  souple_wrench before{};
  for (int k = 0; k < 600; ++k) {
    if (k % ticks_per_step == 0) hand.step();
    before = hand.tick(k);
  }
  souple_device_sample newest{};
  std::int32_t is_there = 0;
  const souple_device_sample bad[] = {{0.601, {{nan, 0, 0, 0}, {0, 0, 0}}, 0},
                                      {0.602, {{1, 0, 0, 0}, {5, 0, 0}}, 0},
                                      {0.1, {{1, 0, 0, 0}, {0, 0, height_m(600)}}, 0}};
  souple_wrench wrench{};
  for (const souple_device_sample& sample : bad) {
    ASSERT_EQ(souple_haptic_tick(hand.channel.get(), &sample, &wrench), SOUPLE_OK);
    EXPECT_NEAR(wrench.force_n.z, before.force_n.z, 0.05 * before.force_n.z);
  }
  ASSERT_EQ(souple_haptic_tick(hand.channel.get(), nullptr, &wrench), SOUPLE_OK);
  const auto telemetry = hand.telemetry();
  EXPECT_EQ(telemetry.refused_not_finite, 1u);
  EXPECT_EQ(telemetry.refused_jumps, 1u);
  EXPECT_EQ(telemetry.refused_clock, 1u);
  EXPECT_EQ(telemetry.missing_samples, 1u);
  EXPECT_EQ(telemetry.ticks, 604u);
  EXPECT_EQ(telemetry.publications, 60u);
  EXPECT_GT(telemetry.active_contacts, 0u);
  EXPECT_GT(souple_histogram_quantile(&telemetry.tick_time_s, 0.5), 0);
  ASSERT_EQ(souple_haptic_newest_sample(hand.channel.get(), &newest, &is_there), SOUPLE_OK);
  EXPECT_EQ(is_there, 1);
  EXPECT_EQ(newest.pose.translation_m.z, height_m(599));
}

TEST(CHaptics, TwoJawsOpenAndDoNotTouchEachOther) {
  const WorldHandle world = make_c_world();
  souple_jaw_description jaws[] = {initialised(souple_jaw_description_init),
                                   initialised(souple_jaw_description_init)};
  for (int k = 0; k < 2; ++k) {
    jaws[k].shape = SOUPLE_SHAPE_CAPSULE;
    jaws[k].radius_m = 0.01;
    jaws[k].half_length_m = 0.05;
    jaws[k].turn_per_opening = k == 0 ? 0.5 : -0.5;
  }
  auto tool = initialised(souple_tool_description_init);
  tool.name = "forceps";
  tool.jaws = jaws;
  tool.jaw_count = 2;
  tool.opening_rad = 0.4;
  souple_haptic_channel* made = nullptr;
  ASSERT_EQ(souple_haptic_channel_create(world.get(), &tool, nullptr, &made), SOUPLE_OK)
      << souple_last_error_what();
  const ChannelHandle channel(made);
  souple_body bodies[2] = {};
  std::size_t count = 0;
  ASSERT_EQ(souple_haptic_tool_bodies(channel.get(), bodies, 2, &count), SOUPLE_OK);
  ASSERT_EQ(count, 2u);
  souple_pose pose{};
  for (int k = 0; k < 2; ++k) {
    ASSERT_EQ(souple_world_rigid_pose(world.get(), bodies[k], &pose), SOUPLE_OK);
    EXPECT_NEAR(pose.rotation_wxyz[2], std::sin(k == 0 ? 0.1 : -0.1), 1e-12);
  }
  step_c(world.get(), 5);
  EXPECT_EQ(souple_world_contacts(world.get(), nullptr, 0, &count), SOUPLE_OK);
  EXPECT_EQ(count, 0u);
}

// Physics and hand each on a thread of their own, as fast as they can.
TEST(CHaptics, StepsAndTicksOnTwoThreadsNeverWaitForEachOther) {
  CHand hand;
  std::atomic<bool> stop = false;
  std::thread physics([&] {
    while (!stop) hand.step();
  });
  bool all_finite = true;
  int k = 0;
  for (; k < 600 || hand.telemetry().hand_overs < 20; ++k) {
    const souple_wrench felt = hand.tick(k);
    all_finite = all_finite && std::isfinite(felt.force_n.x + felt.force_n.y + felt.force_n.z);
  }
  stop = true;
  physics.join();
  EXPECT_TRUE(all_finite);
  const auto telemetry = hand.telemetry();
  EXPECT_EQ(telemetry.ticks, std::uint64_t(k));
  EXPECT_LE(telemetry.hand_overs, telemetry.publications);
}

TEST(CHaptics, TicksAndPublicationsAllocateNothing) {
  CHand hand;
  int k = 0;
  const auto run = [&] {
    for (const int end = k + 300; k < end; ++k) {
      if (k % ticks_per_step == 0) hand.step();
      hand.tick(k);
    }
  };
  run();
  run();
  const std::size_t before = allocation_count();
  run();
  EXPECT_EQ(allocation_count(), before);
}

}  // namespace
}  // namespace souple
