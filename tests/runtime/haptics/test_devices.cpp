// SPDX-License-Identifier: MIT
// Devices that are shipped: a recorded path, and a hand that is simulated.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <limits>
#include <string>

#include "runtime/haptics/devices/device_check.hpp"
#include "runtime/haptics/devices/synthetic_hand.hpp"
#include "tests/support/allocation_count.hpp"
#include "tests/support/rigid_scenes.hpp"

namespace souple {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

DeviceSample sample_of(double time_s, const Point& place, double angle = 0,
                       const Vec3& axis = Vec3::UnitZ(), double opening_rad = 0) {
  const Vec3 v = axis.normalized() * std::sin(angle / 2);
  return {time_s, {{std::cos(angle / 2), v.x(), v.y(), v.z()}, place}, opening_rad};
}

RecordedPath path_of(std::vector<DeviceSample> samples) {
  Result<RecordedPath> path = RecordedPath::create(std::move(samples));
  EXPECT_TRUE(path.ok());
  return std::move(*path);
}

RecordedPath resting(const DeviceSample& sample = {}) { return path_of({sample}); }

SyntheticHand hand_of(RecordedPath wish, const SyntheticHandSettings& settings) {
  Result<SyntheticHand> hand = SyntheticHand::create(std::move(wish), settings);
  EXPECT_TRUE(hand.ok());
  return std::move(*hand);
}

double angle_about_z(const Pose& pose) { return 2 * std::atan2(pose.rotation[3], pose.rotation[0]); }

TEST(RecordedPath, GoesStraightAndTurnsEvenlyBetweenSamples) {
  const RecordedPath path =
      path_of({sample_of(1, {0, 0, 0}), sample_of(3, {2, -4, 1}, 1.2, Vec3::UnitZ(), 0.4)});
  const DeviceSample quarter = path.at(1.5);
  EXPECT_EQ(quarter.time_s, 1.5);
  EXPECT_NEAR(quarter.pose.translation[0], 0.5, 1e-15);
  EXPECT_NEAR(quarter.pose.translation[1], -1, 1e-15);
  EXPECT_NEAR(angle_about_z(quarter.pose), 0.3, 1e-14);
  EXPECT_NEAR(quarter.opening_rad, 0.1, 1e-15);
  EXPECT_EQ(path.at(-5).pose.translation, (Point{0, 0, 0}));
  EXPECT_EQ(path.at(99).pose.translation, (Point{2, -4, 1}));
}

TEST(RecordedPath, TurnsTheShorterWayBetweenOppositeQuaternions) {
  DeviceSample second = sample_of(1, {}, 0.2);
  for (double& q : second.pose.rotation) q = -q;
  EXPECT_NEAR(std::abs(std::remainder(angle_about_z(path_of({sample_of(0, {}), second}).at(0.5).pose),
                                      2 * M_PI)),
              0.1, 1e-14);
}

TEST(RecordedPath, RefusesWhatNoHandDoes) {
  const auto code_of = [](std::vector<DeviceSample> samples) {
    const Result<RecordedPath> path = RecordedPath::create(std::move(samples));
    return path.ok() ? IssueCode{} : path.issue().code;
  };
  EXPECT_EQ(code_of({}), IssueCode::hand_path_malformed);
  EXPECT_EQ(code_of({sample_of(0, {}), sample_of(0, {})}), IssueCode::hand_path_bad_time);
  EXPECT_EQ(code_of({sample_of(1, {}), sample_of(0.5, {})}), IssueCode::hand_path_bad_time);
  EXPECT_EQ(code_of({sample_of(nan, {})}), IssueCode::hand_path_bad_value);
  EXPECT_EQ(code_of({sample_of(0, {0, nan, 0})}), IssueCode::hand_path_bad_value);
  EXPECT_EQ(code_of({sample_of(0, {0, 1e4, 0})}), IssueCode::hand_path_bad_value);
  EXPECT_EQ(code_of({{0, {{0, 0, 0, 0}, {}}, 0}}), IssueCode::hand_path_bad_value);
  EXPECT_EQ(code_of({sample_of(0, {}, 0, Vec3::UnitZ(), nan)}), IssueCode::hand_path_bad_value);
  DeviceLimits limits;
  limits.rate_hz = 0;
  EXPECT_FALSE(RecordedPathDevice::create(resting(), limits).ok());
}

TEST(RecordedPath, PlaysOneSampleATickWithoutAllocating) {
  DeviceLimits limits;
  limits.rate_hz = 500;
  Result<RecordedPathDevice> device =
      RecordedPathDevice::create(path_of({sample_of(2, {0, 0, 0}), sample_of(3, {1, 0, 0})}), limits);
  ASSERT_TRUE(device.ok());
  const std::size_t before = test::allocation_count();
  DeviceSample sample;
  for (int k = 0; k < 501; ++k) {
    ASSERT_FALSE(device->finished());
    ASSERT_TRUE(device->read(sample));
    ASSERT_NEAR(sample.time_s, 2 + k * 0.002, 1e-12);
    ASSERT_NEAR(sample.pose.translation[0], k * 0.002, 1e-12);
    device->write({});
  }
  EXPECT_TRUE(device->finished());
  EXPECT_EQ(test::allocation_count(), before);
}

// m x'' + b x' + k x = F from rest: x = F/k (1 - e^(-s t)(cos w t + s/w sin w t)), s = b/2m.
TEST(SyntheticHand, FollowsTheClosedFormUnderAConstantForce) {
  SyntheticHandSettings settings;
  settings.model.move = {0.1, 0.3, 0.7, 400};
  SyntheticHand hand = hand_of(resting(), settings);
  const double s = 1.0 / 0.2, w = std::sqrt(400 / 0.1 - s * s), force = 2;
  for (int k = 1; k <= 300; ++k) {
    hand.write({{force, 0, 0}, {}, 0});
    const double t = k * 1e-3;
    const double exact =
        force / 400 * (1 - std::exp(-s * t) * (std::cos(w * t) + s / w * std::sin(w * t)));
    ASSERT_NEAR(hand.truth().pose.translation[0], exact, 1e-14);
  }
}

TEST(SyntheticHand, LimpWithoutSpringAndDamperFallsAsAMass) {
  SyntheticHandSettings settings;
  settings.model.move = {0.2, 0, 0, 0};
  SyntheticHand hand = hand_of(resting(), settings);
  for (int k = 0; k < 1000; ++k) hand.write({{0, 0, -1}, {}, 0});
  EXPECT_NEAR(hand.truth().pose.translation[2], -0.5 * 1 / 0.2, 1e-11);
  EXPECT_NEAR(hand.velocity_m_s().z(), -5, 1e-11);
  EXPECT_NEAR(hand.received_j(), 2.5, 1e-11);  // m v^2 / 2
}

// The tick does not matter: a hand that is stiff beyond any tick comes to rest where it belongs.
TEST(SyntheticHand, IsExactAtAnyStiffness) {
  for (const double stiffness : {1.0, 1e3, 1e6, 1e8}) {
    SyntheticHandSettings settings;
    settings.model.move = {0.05, 0.1, 2 * std::sqrt(stiffness * 0.05), stiffness};
    SyntheticHand hand = hand_of(resting(), settings);
    for (int k = 0; k < 20000; ++k) hand.write({{3, 0, 0}, {}, 0});
    EXPECT_NEAR(hand.truth().pose.translation[0], 3 / stiffness, 1e-9 * 3 / stiffness) << stiffness;
  }
}

TEST(SyntheticHand, TurnsAndOpensAsItMoves) {
  SyntheticHandSettings settings;
  settings.model.move = settings.model.turn = settings.model.opening = {0.1, 0.3, 0.7, 40};
  SyntheticHand hand = hand_of(resting(), settings);
  for (int k = 0; k < 200; ++k) hand.write({{0, 0, 8}, {0, 0, 8}, 8});
  const double way = hand.truth().pose.translation[2];
  EXPECT_GT(way, 0.1);
  EXPECT_NEAR(angle_about_z(hand.truth().pose), way, 1e-12);
  EXPECT_NEAR(hand.truth().opening_rad, way, 1e-14);
}

TEST(SyntheticHand, ReachesThePathItWants) {
  SyntheticHandSettings settings;
  settings.model = hand_of_grip(1);
  SyntheticHand hand = hand_of(
      path_of({sample_of(0, {0, 0, 0}), sample_of(0.5, {0.1, 0, 0}, 1, Vec3(1, 2, 3), 0.3)}), settings);
  for (int k = 0; k < 4000; ++k) hand.write({});
  const Pose wish = sample_of(0, {}, 1, Vec3(1, 2, 3)).pose;
  EXPECT_NEAR(hand.truth().pose.translation[0], 0.1, 1e-9);
  for (std::size_t k = 0; k < 4; ++k)
    EXPECT_NEAR(hand.truth().pose.rotation[k], wish.rotation[k], 1e-8);
  EXPECT_NEAR(hand.truth().opening_rad, 0.3, 1e-9);
}

TEST(SyntheticHand, TellsOnlyWhatItsEncodersSee) {
  SyntheticHandSettings settings;
  settings.resolution_m = 1e-4;
  settings.turn_resolution_rad = 1e-3;
  settings.opening_resolution_rad = 1e-2;
  SyntheticHand hand = hand_of(
      path_of({sample_of(0, {0, 0, 0}, 0.5), sample_of(1, {0.05, 0, 0}, 1, Vec3::UnitZ(), 0.7)}),
      settings);
  DeviceSample sample;
  for (int k = 0; k < 1000; ++k) {
    ASSERT_TRUE(hand.read(sample));
    const double ticks = sample.pose.translation[0] / 1e-4;
    ASSERT_NEAR(ticks, std::round(ticks), 1e-9);
    ASSERT_LE(std::abs(sample.pose.translation[0] - hand.truth().pose.translation[0]), 0.5001e-4);
    const double turns = (angle_about_z(sample.pose) - 0.5) / 1e-3;
    ASSERT_NEAR(turns, std::round(turns), 1e-8);
    ASSERT_LE(std::abs(sample.opening_rad - hand.truth().opening_rad), 0.50001e-2);
    hand.write({});
  }
}

TEST(SyntheticHand, GivesEachSampleOnceAndAsLateAsItsDelay) {
  for (const std::size_t delay : {0, 1, 3}) {
    SyntheticHandSettings settings;
    settings.delay_samples = delay;
    SyntheticHand hand = hand_of(resting(), settings);
    std::vector<double> truth;
    DeviceSample sample;
    double last_time = -1;
    for (std::size_t k = 0; k < 20; ++k) {
      truth.push_back(hand.truth().pose.translation[0]);
      ASSERT_TRUE(hand.read(sample));
      EXPECT_FALSE(hand.read(sample));
      EXPECT_GT(sample.time_s, last_time);
      last_time = sample.time_s;
      EXPECT_NEAR(sample.time_s, (double(k) - double(delay)) * 1e-3, 1e-12);
      EXPECT_EQ(sample.pose.translation[0], k >= delay ? truth[k - delay] : 0.0);
      hand.write({{1, 0, 0}, {}, 0});
    }
  }
}

TEST(SyntheticHand, FeelsNoMoreThanItsMotorsGiveAndNothingThatIsNoNumber) {
  SyntheticHandSettings settings, plain;
  settings.limits.force_n = 1;
  SyntheticHand cut = hand_of(resting(), settings), whole = hand_of(resting(), plain);
  for (int k = 0; k < 50; ++k) {
    cut.write({{100, 0, 0}, {}, 0});
    whole.write({{1, 0, 0}, {}, 0});
  }
  EXPECT_DOUBLE_EQ(cut.truth().pose.translation[0], whole.truth().pose.translation[0]);
  SyntheticHand hand = hand_of(resting(), plain);
  hand.write({{nan, 0, 0}, {}, 0});
  hand.write({{}, {}, std::numeric_limits<double>::infinity()});
  EXPECT_EQ(hand.refused_wrenches(), 2u);
  EXPECT_EQ(hand.truth().pose.translation, (Point{0, 0, 0}));
}

TEST(SyntheticHand, AllocatesNothingInATick) {
  SyntheticHandSettings settings;
  settings.delay_samples = 2;
  settings.turn_resolution_rad = 1e-4;
  SyntheticHand hand = hand_of(resting(), settings);
  DeviceSample sample;
  const std::size_t before = test::allocation_count();
  for (int k = 0; k < 100; ++k) {
    hand.read(sample);
    hand.write({{1, 2, 3}, {1e-3, 0, 0}, 0});
  }
  EXPECT_EQ(test::allocation_count(), before);
}

TEST(SyntheticHand, RefusesModelsThatAreNone) {
  const auto refused = [](auto&& change) {
    SyntheticHandSettings settings;
    change(settings);
    return !SyntheticHand::create(resting(), settings).ok();
  };
  EXPECT_TRUE(refused([](auto& s) { s.model.move.mass = 0; }));
  EXPECT_TRUE(refused([](auto& s) { s.model.move.hand_stiffness = -1; }));
  EXPECT_TRUE(refused([](auto& s) { s.model.turn.own_damping = nan; }));
  EXPECT_TRUE(refused([](auto& s) {
    s.model.move = {1e-9, 0, 0, 1e9};
    s.limits.rate_hz = 1;
  }));
  EXPECT_TRUE(refused([](auto& s) { s.limits.rate_hz = nan; }));
  EXPECT_TRUE(refused([](auto& s) { s.resolution_m = -1; }));
  EXPECT_TRUE(refused([](auto& s) { s.delay_samples = 100000; }));
  EXPECT_FALSE(refused([](auto&) {}));
}

// Which checks a device fails that gives these samples, one a millisecond of the observer's clock.
template <class Change>
std::vector<std::string> failures(Change&& change, double tick_s = 1e-3) {
  DeviceLimits limits;
  limits.force_n = 5;
  DeviceCheck check(limits);
  for (int k = 0; k < 1000; ++k) {
    DeviceSample sample = sample_of(k * tick_s, {1e-4 * k, 0, 0}, 1e-3 * k);
    double now = k * tick_s;
    Wrench wrench{{1, 0, 0}, {}, 0};
    double latency = 1e-3;
    if (!change(k, now, sample, wrench, latency)) continue;
    check.saw_sample(now, sample);
    check.saw_wrench(wrench);
    check.saw_answer(latency);
  }
  std::vector<std::string> failed;
  for (const DeviceVerdict& verdict : check.judge())
    if (!verdict.passed) failed.emplace_back(verdict.check);
  return failed;
}

TEST(DeviceCheck, PassesASoundDeviceAndNamesWhatIsWrongWithOthers) {
  using Names = std::vector<std::string>;
  const auto of = [](auto&& change) {
    return failures([&](int k, double& now, DeviceSample& s, Wrench& w, double& latency) {
      return change(k, now, s, w, latency);
    });
  };
  EXPECT_EQ(of([](int, auto&, auto&, auto&, auto&) { return true; }), Names{});
  EXPECT_EQ(of([](int k, auto&, auto&, auto&, auto&) { return k < 50; }), Names{"samples"});
  EXPECT_EQ(of([](int k, auto&, auto& s, auto&, auto&) {
              if (k == 500) s.pose.translation[0] = nan;
              return true;
            }),
            Names{"samples_refused"});
  EXPECT_EQ(of([](int k, auto&, auto& s, auto&, auto&) {
              if (k == 500) s.time_s = 0.4995 - 1e-3;
              return true;
            }),
            Names{"clock_faults"});
  EXPECT_EQ(of([](int k, auto&, auto&, auto&, auto&) { return k < 300 || k > 315; }),
            Names{"longest_gap"});
  EXPECT_EQ(of([](int, auto&, auto& s, auto&, auto&) {
              s.time_s *= 1.05;
              return true;
            }),
            Names{"clock_error"});
  EXPECT_EQ(of([](int k, auto&, auto& s, auto&, auto&) {
              if (k > 500) s.pose.translation[1] = 1;
              return true;
            }),
            Names{"speed"});
  EXPECT_EQ(of([](int, auto&, auto&, auto& w, auto&) {
              w.force_n[1] = 6;
              return true;
            }),
            Names{"wrenches_beyond_limits"});
  EXPECT_EQ(of([](int k, auto&, auto&, auto&, auto& latency) {
              if (k % 20 == 0) latency = 0.008;
              return true;
            }),
            Names{"latency_p99"});
  EXPECT_EQ(failures([](int, auto&, auto&, auto&, auto&) { return true; }, 1.1e-3),
            Names{"rate_error"});
}

}  // namespace
}  // namespace souple
