// SPDX-License-Identifier: MIT
// Free rigid bodies: motion without contact, friction on planes, stacks (references 4.2
// to 4.6, 5.1, 5.4).
#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/rigid_scenes.hpp"

namespace souple {
namespace {

using namespace test;

constexpr double g = 9.81;

WorldSettings settings_of(double h, double friction, double slope_deg = 0) {
  WorldSettings settings;
  settings.time_step_s = h;
  settings.friction = friction;
  settings.gravity_m_s2 = gravity_on_slope(slope_deg);
  return settings;
}

const RigidShape cube = box_shape({0.05, 0.05, 0.05});

TEST(RigidBodies, FallAsTheSchemeHasItWhateverTheirShape) {
  const double h = 1e-3;
  World world = make_world(settings_of(h, 0.4));
  const BodyId bodies[]{add_free(world, cube, {0, 0, 50}),
                        add_free(world, sphere_shape(0.1), {1, 0, 50}, turned(30, {1, 1, 0})),
                        add_free(world, capsule_shape(0.05, 0.1), {2, 0, 50})};
  const int steps = 1000;
  for (int k = 0; k < steps; ++k) step(world);
  for (const BodyId body : bodies) {
    EXPECT_NEAR(place_of(world, body).z(), 50 - 0.5 * g * h * h * steps * (steps + 1), 1e-9);
    EXPECT_NEAR(speed_of(world, body).z(), -g * h * steps, 1e-10);
  }
}

struct Spin {
  double momentum_error = 0, energy_gain = 0, energy_loss = 0;
};

// A brick that tumbles about its middle axis, where a small disturbance grows.
Spin tumble(double h) {
  WorldSettings settings = settings_of(h, 0);
  settings.gravity_m_s2 = {0, 0, 0};
  World world = make_world(settings);
  add_free(world, box_shape({0.1, 0.06, 0.03}), Vec3::Zero(), turned(20, {1, 2, 3}),
           moving(Vec3::Zero(), turned(20, {1, 2, 3}) * Vec3(0.05, 5, 0.02)));
  Spin spin;
  double first = 0, last = 0;
  Vec3 momentum;
  for (int k = 0; k * h < 2 - 1e-9; ++k) {
    const StepReport report = step(world);
    if (k == 0) {
      first = last = report.kinetic_energy_j;
      momentum = as_vec3(report.angular_momentum_kg_m2_s);
    }
    spin.energy_gain = std::max(spin.energy_gain, (report.kinetic_energy_j - last) / first);
    last = report.kinetic_energy_j;
    spin.momentum_error =
        (as_vec3(report.angular_momentum_kg_m2_s) - momentum).norm() / momentum.norm();
  }
  spin.energy_loss = (first - last) / first;
  return spin;
}

TEST(RigidBodies, TumbleWithTheirMomentumAndEnergyToTheOrderOfTheIntegrator) {
  const Spin coarse = tumble(2e-3), fine = tumble(1e-3);
  EXPECT_LT(coarse.energy_gain, 1e-12) << "the gyroscopic moment must not put energy in";
  EXPECT_LT(fine.energy_loss, 0.02);
  EXPECT_LT(fine.momentum_error, 0.02);
  EXPECT_LT(fine.momentum_error, 0.65 * coarse.momentum_error) << "first order";
}

TEST(RigidBodies, StickAndSlideWithinHalfADegreeOfTheFrictionAngle) {  // 4.2
  for (const double friction : {0.2, 0.5, 1.0}) {
    const double angle = std::atan(friction) * 180 / M_PI, h = 2e-3;
    for (const double off : {-0.45, 0.45}) {
      World world = make_world(settings_of(h, friction, angle + off));
      const BodyId body = add_free(world, box_shape({0.1, 0.1, 0.02}), {0, 0, 0.02});
      add_plane(world);
      for (int k = 0; k < 500; ++k) step(world);
      const double slope = (angle + off) * M_PI / 180;
      const double a = g * (std::sin(slope) - friction * std::cos(slope));
      EXPECT_NEAR(speed_of(world, body).x(), off < 0 ? 0 : a, off < 0 ? 1e-8 : 1e-3 + 5e-3 * a)
          << friction;
      EXPECT_LT(std::abs(place_of(world, body).z() - 0.02), 1e-6);
    }
  }
}

TEST(RigidBodies, SlidingBlockStopsAfterTheClosedFormDistance) {  // 4.3, with the offset of the scheme
  for (const double mass : {0.1, 10.0}) {
    World world = make_world(settings_of(1e-3, 0.3));
    FreeRigidMotion motion = weighing(mass);
    motion.velocity_m_s = {2, 0, 0};
    const BodyId body =
        add_free(world, box_shape({0.1, 0.1, 0.02}), {0, 0, 0.02}, Mat3::Identity(), motion);
    add_plane(world);
    for (int k = 0; k < 900; ++k) step(world);
    EXPECT_NEAR(place_of(world, body).x(), 0.678579, 1e-3 * 0.678579) << mass;
    EXPECT_LT(speed_of(world, body).norm(), 1e-9);
  }
}

TEST(RigidBodies, SlidingBallRollsWithFiveSeventhsOfItsSpeed) {  // 4.4
  const double h = 5e-4, v0 = 2, mu = 0.3;
  World world = make_world(settings_of(h, mu));
  const BodyId ball =
      add_free(world, sphere_shape(0.05), {0, 0, 0.05}, Mat3::Identity(), moving({v0, 0, 0}));
  add_plane(world);
  const auto rolls = [&] {
    return std::abs(speed_of(world, ball).x() - 0.05 * world.rigid_angular_velocity(ball)[1]) < 1e-6;
  };
  int k = 0;
  for (; k < 1000 && !rolls(); ++k) step(world);
  EXPECT_NEAR(k * h, 0.194165, 2 * h);
  EXPECT_NEAR(place_of(world, ball).x(), 0.332855, 2 * h * v0);
  for (int more = 0; more < 500; ++more) step(world);
  EXPECT_NEAR(speed_of(world, ball).x(), 1.428571, 1e-3);
}

TEST(RigidBodies, BallOnASlopeRollsWithFiveSeventhsOfItsAcceleration) {  // 4.4
  for (const auto& [slope, mu] : {std::pair(30.0, 0.2), std::pair(30.0, 0.1)}) {
    World world = make_world(settings_of(1e-3, mu, slope));
    const BodyId ball = add_free(world, sphere_shape(0.05), {0, 0, 0.05});
    add_plane(world);
    for (int k = 0; k < 500; ++k) step(world);
    const double sine = std::sin(slope * M_PI / 180), cosine = std::cos(slope * M_PI / 180);
    const bool rolls = sine / cosine <= 3.5 * mu;
    const double a = rolls ? 5.0 / 7 * g * sine : g * (sine - mu * cosine);
    EXPECT_NEAR(speed_of(world, ball).x(), 0.5 * a, 5e-3 * a);
    const double slip = speed_of(world, ball).x() - 0.05 * world.rigid_angular_velocity(ball)[1];
    if (rolls)
      EXPECT_LT(std::abs(slip), 1e-6);
    else
      EXPECT_GT(slip, 0.1);
  }
}

TEST(RigidBodies, TallBlockTipsOnASlopeWhereItWouldStillStick) {  // 4.2: tan(theta) > b / h
  for (const auto& [slope, tips] : {std::pair(26.0, false), std::pair(27.2, true)}) {
    World world = make_world(settings_of(2e-3, 1.0, slope));
    const BodyId body = add_free(world, box_shape({0.05, 0.05, 0.1}), {0, 0, 0.1});
    add_plane(world);
    for (int k = 0; k < 1000; ++k) step(world);
    const Mat3 now =
        Eigen::Quaterniond(world.rigid_pose(body).rotation[0], world.rigid_pose(body).rotation[1],
                           world.rigid_pose(body).rotation[2], world.rigid_pose(body).rotation[3])
            .toRotationMatrix();
    EXPECT_EQ(now(2, 2) < 0.9, tips) << slope;
  }
}

// A block of base b on a plane, pushed slowly at height h by a smooth ball: the mean force that it
// takes once the first touch has rung out and before a tilt shortens the lever of the weight.
constexpr double push_speed = 0.005, push_time = 0.6;
struct Pushed {
  double force = 0, tilt = 0, way = 0;
};

Pushed push_at(double height, double friction) {
  const double half = 0.05, radius = 0.01, time_step = 2e-3;
  World world = make_world(settings_of(time_step, friction));
  const BodyId block = add_free(world, box_shape({half, half, 2 * half}), {0, 0, 2 * half});
  add_plane(world);
  const double start = -half - radius - 1e-4;
  const BodyId ball = add_driven(world, sphere_shape(radius),
                                 {{0, pose_of(Mat3::Identity(), {start, 0, height})},
                                  {1, pose_of(Mat3::Identity(), {start + push_speed, 0, height})}});
  EXPECT_TRUE(world.set_pair(ball, block, {0.0, true}).ok());
  Pushed result;
  const int first = 25, last = 75;
  for (int k = 0; k < int(push_time / time_step); ++k) {
    step(world);
    if (k >= first && k < last) result.force += event_force(world, ball, block).x() / (last - first);
  }
  const auto& q = world.rigid_pose(block).rotation;
  const Eigen::Quaterniond turn(q[0], q[1], q[2], q[3]);
  result.tilt = std::acos(std::min(1.0, turn.toRotationMatrix()(2, 2)));
  result.way = place_of(world, block).x() - result.tilt * 2 * half;  // of its base
  return result;
}

TEST(RigidBodies, PushedBlockSlidesOrTipsByTheHeightOfThePush) {  // 4.5: slides iff h < b / (2 mu)
  const double mu = 0.4, base = 0.1, weight = 1000 * base * base * 2 * base * g;
  const double limit = base / (2 * mu);
  for (const double height : {0.5 * limit, 0.9 * limit}) {
    const Pushed block = push_at(height, mu);
    EXPECT_NEAR(block.force, mu * weight, 0.02 * mu * weight) << height;
    EXPECT_LT(block.tilt, 1e-3) << height;
    EXPECT_NEAR(block.way, push_speed * push_time, 2e-4) << height;
  }
  for (const double height : {1.1 * limit, 1.4 * limit}) {
    const Pushed block = push_at(height, mu);
    EXPECT_NEAR(block.force, weight * base / (2 * height), 0.02 * weight) << height;
    EXPECT_NEAR(block.tilt, push_speed * push_time / height, 2e-3) << height;
    EXPECT_LT(std::abs(block.way), 1e-3) << height;
  }
}

TEST(RigidBodies, LadderSlipsBelowItsLeastAngle) {  // 4.5: 57.45 degrees with 0.3 and 0.2
  const double half = 0.5, radius = 1e-3;
  for (const auto& [angle, holds] : {std::pair(57.95, true), std::pair(56.95, false)}) {
    World world = make_world(settings_of(2e-3, 0.3));
    const double a = angle * M_PI / 180;
    // The foot on the floor z = 0, the head at the wall x = 0.
    const BodyId ladder = add_free(world, capsule_shape(radius, half),
                                   {half * std::cos(a) + radius, 0, half * std::sin(a) + radius},
                                   turned(angle - 90, {0, 1, 0}));
    const BodyId floor = add_plane(world), wall = add_plane(world, turned(90, {0, 1, 0}));
    ASSERT_TRUE(world.set_pair(ladder, floor, {0.3, true}).ok());
    ASSERT_TRUE(world.set_pair(ladder, wall, {0.2, true}).ok());
    const double height = place_of(world, ladder).z();
    for (int k = 0; k < 1000; ++k) step(world);
    const double fallen = height - place_of(world, ladder).z();
    if (holds)
      EXPECT_LT(fallen, 1e-3) << angle;
    else
      EXPECT_GT(fallen, 0.02) << angle;
  }
}

TEST(RigidBodies, StackOfTenCarriesItsWeightWithoutDriftOrSinking) {  // 4.6
  World world = make_world(settings_of(0.01, 0.5));
  const double mass = 1000 * 0.001;
  const BodyId floor = add_plane(world);
  std::vector<BodyId> boxes;
  for (int k = 0; k < 10; ++k) boxes.push_back(add_free(world, cube, {0, 0, 0.05 + 0.1 * k}));
  StepReport report;
  double early = 0, late = 0;
  for (int k = 0; k < 1000; ++k) {
    report = step(world);
    (k < 500 ? early : late) = std::max(k < 500 ? early : late, report.worst_penetration_m);
  }
  for (int k = 0; k < 10; ++k) {
    const Vec3 below =
        event_force(world, k == 0 ? floor : boxes[std::size_t(k - 1)], boxes[std::size_t(k)]);
    EXPECT_NEAR(below.z(), (10 - k) * mass * g, 1e-4 * 10 * mass * g) << k;
    const Vec3 moved = place_of(world, boxes[std::size_t(k)]) - Vec3(0, 0, 0.05 + 0.1 * k);
    EXPECT_LT(moved.norm(), 1e-5) << k;
  }
  EXPECT_LE(late, early + 1e-9);
  EXPECT_LT(late, 1e-6);
}

TEST(RigidBodies, StuckBlockDoesNotCreepInAMinute) {
  World world = make_world(settings_of(0.01, 0.5, 26));
  const BodyId body = add_free(world, cube, {0, 0, 0.05});
  add_plane(world);
  for (int k = 0; k < 100; ++k) step(world);
  const Vec3 start = place_of(world, body);
  for (int k = 0; k < 6000; ++k) step(world);
  EXPECT_LT((place_of(world, body) - start).norm(), 1e-7);
}

TEST(RigidBodies, BoxOnItsCornersHasTheResultantsThatStaticsGives) {  // 5.1
  for (const double slope : {0.0, 15.0}) {
    World world = make_world(settings_of(0.01, 0.6, slope));
    const BodyId body = add_free(world, box_shape({0.1, 0.06, 0.03}), {0, 0, 0.03});
    add_plane(world);
    for (int k = 0; k < 200; ++k) step(world);
    const double weight = 1000 * 8 * 0.1 * 0.06 * 0.03 * g;
    Vec3 force = Vec3::Zero(), moment = Vec3::Zero();
    int corners = 0;
    for (const ContactRecord& c : world.contacts()) {
      const Vec3 f = (c.body_a == body ? 1 : -1) * as_vec3(c.force_n);
      force += f;
      moment += (as_vec3(c.point_m) - place_of(world, body)).cross(f);
      corners += f.norm() > 0;
    }
    EXPECT_LT((force + weight / g * as_vec3(gravity_on_slope(slope))).norm(), 1e-6 * weight);
    EXPECT_LT(moment.norm(), 1e-6 * weight * 0.1);
    EXPECT_GE(corners, 3);
    EXPECT_LT(speed_of(world, body).norm(), 1e-9);
  }
}

TEST(RigidBodies, PainleveRodMeetsAnImpactWithoutFailureOrEnergy) {  // 5.4: mu = 2 at tan(theta) = 2
  for (const double mu : {1.0, 1.4, 2.0, 5.0}) {
    World world = make_world(settings_of(1e-3, mu));
    const double angle = std::atan(2.0), half = 0.5;
    // It slides towards the side that it leans over to: the paradox's direction.
    const BodyId rod = add_free(world, capsule_shape(1e-3, half), {0, 0, half * std::sin(angle) + 1e-3},
                                turned(90 - angle * 180 / M_PI, {0, 1, 0}), moving({-3, 0, 0}));
    add_plane(world);
    double last = INFINITY;
    for (int k = 0; k < 1000; ++k) {
      const auto report = world.step();
      ASSERT_TRUE(report.ok()) << format_issue(report.issue());
      const double energy = energy_of(*report);
      ASSERT_LT(energy, last + 1e-3) << "mu " << mu << " step " << k;
      ASSERT_LT(report->cone_violation, 1e-9);
      last = energy;
    }
    EXPECT_GT(place_of(world, rod).z(), 0);
    EXPECT_LT(place_of(world, rod).norm(), 10);
  }
}

}  // namespace
}  // namespace souple
