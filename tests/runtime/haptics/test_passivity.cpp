// SPDX-License-Identifier: MIT
// What the passivity controller does to walls that give energy, and does not do to those that do not.
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "runtime/haptics/devices/synthetic_hand.hpp"
#include "runtime/haptics/passivity_controller.hpp"
#include "tests/support/allocation_count.hpp"

namespace souple {
namespace {

PassivityController controller_of(const PassivitySettings& settings = {}) {
  Result<PassivityController> controller = PassivityController::create(settings);
  EXPECT_TRUE(controller.ok());
  return std::move(*controller);
}

// A hand pushes a wall that answers with a spring to where the hand was some ticks ago.
struct Wall {
  double stiffness_n_m = 3000;
  std::size_t delay = 4;

  /// Largest swing in the last tenth of two seconds, m, and what the wall has given, J.
  struct Outcome {
    double swing_m = 0, given_j = 0;
    std::uint64_t damped_ticks = 0;
  };
  Outcome push(PassivityController* controller) const {
    SyntheticHandSettings settings;
    settings.model = hand_of_grip(0.3);
    DeviceSample begin, in;
    begin.pose.translation = {0, 0, 0.01};
    in.time_s = 0.2;
    in.pose.translation = {0, 0, -0.02};
    Result<RecordedPath> wish = RecordedPath::create({begin, in});
    Result<SyntheticHand> hand = SyntheticHand::create(std::move(*wish), settings);
    Outcome outcome;
    std::vector<double> heights;
    double low = 1, high = -1;
    for (int k = 0; k < 2000; ++k) {
      DeviceSample sample;
      hand->read(sample);
      Wrench wrench;
      heights.push_back(sample.pose.translation[2]);
      const double height = heights[heights.size() > delay ? heights.size() - 1 - delay : 0];
      wrench.force_n[2] = std::max(0.0, -stiffness_n_m * height);
      if (controller) wrench = controller->control(sample, wrench);
      hand->write(wrench);
      if (k < 1800) continue;
      low = std::min(low, hand->truth().pose.translation[2]);
      high = std::max(high, hand->truth().pose.translation[2]);
    }
    outcome.swing_m = high - low;
    outcome.given_j = hand->received_j();
    if (controller) outcome.damped_ticks = controller->damped_ticks();
    return outcome;
  }
};

TEST(PassivityController, MakesADelayedWallPassiveThatWasNot) {
  const Wall wall;
  const Wall::Outcome alone = wall.push(nullptr);
  EXPECT_GT(alone.given_j, 0.05);
  EXPECT_GT(alone.swing_m, 5e-3);
  for (const PassivityScope scope : {PassivityScope::each_freedom, PassivityScope::total_power}) {
    PassivitySettings settings;
    settings.scope = scope;
    PassivityController controller = controller_of(settings);
    const Wall::Outcome tamed = wall.push(&controller);
    EXPECT_GT(tamed.damped_ticks, 0u);
    EXPECT_GT(controller.dissipated_j(), 0);
    EXPECT_LT(tamed.given_j, 0.02 * alone.given_j);
    EXPECT_LT(tamed.swing_m, 0.4 * alone.swing_m);
  }
}

// Damping takes from the hand what the hand puts in: never below zero, so no tick is touched.
TEST(PassivityController, LeavesPassiveForcesAsTheyAreToTheBit) {
  PassivityController controller = controller_of();
  std::mt19937 random(7);
  std::normal_distribution<double> step(0, 1e-3);
  DeviceSample sample;
  Point last = sample.pose.translation;
  for (int k = 1; k < 5000; ++k) {
    sample.time_s = k * 1e-3;
    // A damper against the motion that the hand makes next: passive in every tick.
    Point next = last;
    for (double& x : next) x += step(random);
    Wrench wrench;
    for (std::size_t i = 0; i < 3; ++i) wrench.force_n[i] = -3.7 * (next[i] - last[i]) / 1e-3;
    wrench.force_n[2] = wrench.force_n[2] == 0 ? -0.0 : wrench.force_n[2];
    const Wrench sent = controller.control(sample, wrench);
    for (std::size_t i = 0; i < 3; ++i) {
      ASSERT_EQ(std::bit_cast<std::uint64_t>(sent.force_n[i]),
                std::bit_cast<std::uint64_t>(wrench.force_n[i]));
      ASSERT_EQ(sent.torque_nm[i], 0);
    }
    sample.pose.translation = last = next;
  }
  EXPECT_EQ(controller.damped_ticks(), 0u);
  EXPECT_GT(controller.energy_j(), 0);
}

TEST(PassivityController, ObservesTheWorkOfEveryFreedom) {
  PassivityController controller = controller_of();
  DeviceSample sample;
  controller.control(sample, {{2, 0, 0}, {0, 0, -0.5}, -0.25});
  sample.time_s = 0.001;
  sample.pose = {{std::cos(0.005), 0, 0, std::sin(0.005)}, {-0.01, 0, 0}};
  sample.opening_rad = 0.02;
  controller.control(sample, {});
  // The hand gave 2 N over 1 cm, 0.5 Nm over 0.01 rad and 0.25 Nm over 0.02 rad.
  EXPECT_NEAR(controller.energy_j(), 0.02 + 0.005 + 0.005, 1e-12);
}

TEST(PassivityController, OneFreedomDoesNotPayForAnother) {
  const auto sent = [](PassivityScope scope) {
    PassivitySettings settings;
    settings.scope = scope;
    PassivityController controller = controller_of(settings);
    DeviceSample sample;
    controller.control(sample, {{-1, 1, 0}, {}, 0});  // x takes from the hand, y gives to it
    sample.time_s = 0.001;
    sample.pose.translation = {0.01, 0.001, 0};
    return controller.control(sample, {{-1, 1, 0}, {}, 0});
  };
  EXPECT_EQ(sent(PassivityScope::total_power).force_n, (Point{-1, 1, 0}));
  const Wrench each = sent(PassivityScope::each_freedom);
  EXPECT_EQ(each.force_n[0], -1);
  // 1 mJ is owed, and taken back within a tick at 1 m/s: 1 N.
  EXPECT_NEAR(each.force_n[1], 0, 1e-12);
}

TEST(PassivityController, DampsNoMoreThanItMay) {
  PassivitySettings settings;
  settings.largest_damping_n_s_m = 0.25;
  PassivityController controller = controller_of(settings);
  DeviceSample sample;
  controller.control(sample, {{50, 0, 0}, {}, 0});
  sample.time_s = 0.001;
  sample.pose.translation = {0.001, 0, 0};
  EXPECT_NEAR(controller.control(sample, {{50, 0, 0}, {}, 0}).force_n[0], 50 - 0.25, 1e-12);
}

TEST(PassivityController, ForgetsCreditBeyondItsBound) {
  PassivitySettings settings;
  settings.largest_credit_j = 0.001;
  PassivityController controller = controller_of(settings);
  DeviceSample sample;
  controller.control(sample, {{-5, 0, 0}, {}, 0});
  sample.time_s = 0.001;
  sample.pose.translation = {0.01, 0, 0};
  controller.control(sample, {});
  EXPECT_DOUBLE_EQ(controller.energy_j(), 0.001);
}

TEST(PassivityController, PassesOnWhatItCannotObserve) {
  PassivityController controller = controller_of();
  DeviceSample sample;
  sample.time_s = 1;
  controller.control(sample, {{1, 0, 0}, {}, 0});
  const std::size_t before = test::allocation_count();
  DeviceSample bad = sample;
  bad.time_s = 2;
  bad.pose.translation[1] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(controller.control(bad, {{3, 0, 0}, {}, 0}).force_n[0], 3);
  bad = sample;
  bad.time_s = 0.5;
  bad.pose.translation[0] = 1;
  EXPECT_EQ(controller.control(bad, {{4, 0, 0}, {}, 0}).force_n[0], 4);
  EXPECT_EQ(controller.energy_j(), 0);
  EXPECT_EQ(test::allocation_count(), before);
}

TEST(PassivityController, RefusesBoundsThatAreNone) {
  PassivitySettings settings;
  settings.largest_damping_n_s_m = -1;
  EXPECT_FALSE(PassivityController::create(settings).ok());
  settings = {};
  settings.largest_credit_j = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(PassivityController::create(settings).ok());
}

}  // namespace
}  // namespace souple
