// SPDX-License-Identifier: MIT
// What a hand feels between the steps of the physics: closed forms, and independent solutions.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/support/allocation_count.hpp"
#include "tests/support/box_mesh.hpp"
#include "tests/support/dense_compliance.hpp"
#include "tests/support/frictional_contact.hpp"
#include "tests/support/tool_scenes.hpp"

namespace souple {
namespace {

using namespace test;

constexpr double radius = 0.02, stiffness = 800, mu = 0.5;

HandleCoupling spring(double line, double turning = 50) {
  HandleCoupling coupling;
  coupling.stiffness_n_m = line;
  coupling.turn_stiffness_nm_rad = turning;
  return coupling;
}

WorldSettings settings_of(double friction) {
  WorldSettings settings;
  settings.friction = friction;
  settings.contact_solver.tolerance = 1e-10;
  return settings;
}

// A ball that barely touches a plane.
struct BallOnPlane {
  explicit BallOnPlane(const HapticSettings& settings = patient_settings())
      : world(make_world(settings_of(mu))),
        channel((add_plane(world),
                 make_channel(add_tool(world, sphere_shape(radius), spring(stiffness, 1e6), start),
                              settings))) {
    channel.tick(sample_at(0, start));
    physics_step(world, channel);
  }
  inline static const Vec3 start{0, 0, radius + 1e-5};
  World world;
  HapticChannel channel;
};

TEST(HapticTick, PressesAPlaneWithTheStiffnessOfTheCoupling) {
  BallOnPlane scene;
  scene.channel.tick(sample_at(0.0005, BallOnPlane::start));
  for (int k = 1; k <= 20; ++k) {
    const double depth = 2e-4 * k;
    const Wrench wrench = scene.channel.tick(sample_at(0.001 * k, {0, 0, radius - depth}));
    EXPECT_NEAR(force_of(wrench).z(), stiffness * depth, 1e-4 * stiffness * depth);
    EXPECT_LT(force_of(wrench).head<2>().norm(), 1e-6);
    EXPECT_LE(scene.channel.residual(), 1e-4);
  }
}

TEST(HapticTick, SticksBelowTheConeAndSlipsOnIt) {
  BallOnPlane scene;
  const double depth = 0.004, normal = stiffness * depth;
  scene.channel.tick(sample_at(0.001, {0, 0, radius - depth}));
  for (int k = 1; k <= 40; ++k) {
    const double way = 1e-4 * k;
    const Vec3 force =
        force_of(scene.channel.tick(sample_at(0.001 + 0.001 * k, {way, 0, radius - depth})));
    EXPECT_NEAR(force.z(), normal, 1e-4 * normal);
    const double tangential = std::min(stiffness * way, mu * normal);
    EXPECT_NEAR(-force.x(), tangential, 1e-3 * normal) << "after " << way << " m";
    EXPECT_NEAR(force.y(), 0, 1e-3 * normal);
  }
}

TEST(HapticTick, TorqueIsThatOfTheForceAtTheContactPoint) {
  World world = make_world(settings_of(0));
  add_plane(world);
  ToolDescription description;
  description.jaws.resize(1);
  description.jaws[0].shape = sphere_shape(radius);
  description.jaws[0].mount.translation = {0.1, 0, 0};
  description.jaws[0].coupling = spring(stiffness);
  description.pose.translation = {0, 0, radius + 1e-5};
  auto channel = make_channel(*Tool::create(world, description), patient_settings());
  channel.tick(sample_at(0, {0, 0, radius + 1e-5}));
  physics_step(world, channel);
  channel.tick(sample_at(0.001, {0, 0, radius - 0.001}));
  const Wrench wrench = channel.tick(sample_at(0.002, {0, 0, radius - 0.001}));
  // Up, at x = 0.1: the hand's y axis is turned down.
  EXPECT_NEAR(torque_of(wrench).y(), -0.1 * force_of(wrench).z(), 1e-4 * force_of(wrench).z());
  EXPECT_NEAR(force_of(wrench).z(), stiffness * 0.001, 1e-3);
}

TEST(HapticTick, FreeMotionIsExactlyForceless) {
  World world = make_world(settings_of(mu));
  add_plane(world);
  HapticSettings settings = patient_settings();
  settings.credible_speed_m_s = 1e4;
  settings.credible_turn_rad_s = 1e6;
  auto channel = make_channel(
      add_tool(world, box_shape({0.01, 0.02, 0.03}), spring(stiffness), {0, 0, 1}), settings);
  std::mt19937 random(3);
  std::uniform_real_distribution<double> any(-1, 1);
  double time = 0;
  for (int step = 0; step < 30; ++step) {
    for (int k = 0; k < 10; ++k) {
      time += 0.001;
      const Vec3 place(any(random), any(random), 1.2 + any(random));
      const Mat3 rotation = turned(180 * any(random), {any(random), any(random), 1});
      const Wrench wrench = channel.tick(sample_at(time, place, rotation));
      EXPECT_EQ(force_of(wrench), Vec3(Vec3::Zero()));
      EXPECT_EQ(torque_of(wrench), Vec3(Vec3::Zero()));
      EXPECT_EQ(wrench.opening_nm, 0);
    }
    physics_step(world, channel);
  }
  EXPECT_EQ(channel.telemetry().refused_jumps, 0u);
}

struct Grip {
  World world;
  HapticChannel channel;
  double time = 0;

  static constexpr double height = 0.022;
  Wrench tick(const Vec3& offset, double opening, const Mat3& rotation = Mat3::Identity()) {
    time += 0.001;
    return channel.tick(sample_at(time, Vec3(-0.1, 0, height) + offset, rotation, opening));
  }
};

// A soft bar between closed jaws, on a plane.
Grip make_grip(const HapticSettings& settings = patient_settings()) {
  World world = make_world(settings_of(0.6));
  add_soft(world,
           make_body(box_mesh({3, 4, 3}, {-0.02, -0.02, -0.02}, {0.04, 0.04, 0.04}),
                     material_of(1e4, 0.4, 1000, 0.1, 0.01), 0.01),
           {0, 0, 0.02});
  add_plane(world);
  Tool tool = add_forceps(world, spring(2000), {-0.1, 0, Grip::height}, 0.5);
  Grip grip{std::move(world), make_channel(std::move(tool), settings)};
  for (int k = 0; k <= 30; ++k) {
    for (int t = 0; t < 10; ++t) grip.tick(Vec3::Zero(), 0.5 - 0.16 * k / 30);
    physics_step(grip.world, grip.channel);
  }
  return grip;
}

ToolProblem problem_of(const Grip& grip) {
  ToolProblem problem;
  problem.reserve(512);
  EXPECT_TRUE(grip.world.tool_problem(grip.channel.tool().bodies(), problem).ok());
  return problem;
}

struct Reference {
  Vec3 force = Vec3::Zero(), torque = Vec3::Zero();
  double opening = 0;
};

// Everything anew: finite poses, W in double, solved from nothing, virtual work of the points.
Reference dense_reference(const Grip& grip, const ToolProblem& problem, const Pose& hand,
                          double opening) {
  const std::size_t count = problem.contacts.size(), size = 3 * count;
  const Tool& tool = grip.channel.tool();
  std::vector<double> w(size * size), q(size), friction(count), force(size, 0.0), gap(size);
  const auto point_of = [&](const ToolTouch& t, const Pose& at, double phi) -> Vec3 {
    const RigidPlacement jaw = tool.jaw_pose(std::size_t(t.jaw), placement(at), phi);
    return jaw.rotation * t.local + jaw.translation;
  };
  for (std::size_t c = 0; c < size; ++c)
    for (std::size_t r = 0; r < size; ++r) w[c * size + r] = problem.delassus.column(c)[r];
  for (std::size_t i = 0; i < count; ++i) {
    const ToolContact& c = problem.contacts[i];
    friction[i] = c.law.friction;
    Vec3 moved = Vec3::Zero();
    for (const auto& [touch, sign] : {std::pair(&c.a, 1.0), std::pair(&c.b, -1.0)}) {
      if (touch->jaw < 0) continue;
      const RigidPlacement& from = problem.jaw_pose[std::size_t(touch->jaw)];
      moved +=
          sign * (point_of(*touch, hand, opening) - (from.rotation * touch->local + from.translation));
    }
    const Vec3 opened = c.frame.transpose() * moved;
    for (std::size_t r = 0; r < 3; ++r)
      q[3 * i + r] = double(problem.free_gap[3 * i + r]) + opened[Eigen::Index(r)];
  }
  const FrictionalContactProblem dense{count, w, q, friction};
  const auto report = solve_frictional_contact(dense, {1e-11, 200000}, force, gap);
  EXPECT_TRUE(report.converged);
  EXPECT_LT(natural_map_residual(dense, force), 1e-8);
  Reference sum;
  for (std::size_t i = 0; i < count; ++i) {
    const ToolContact& c = problem.contacts[i];
    for (const auto& [touch, sign] : {std::pair(&c.a, 1.0), std::pair(&c.b, -1.0)}) {
      if (touch->jaw < 0) continue;
      const Vec3 f = sign * (c.frame * Vec3(force[3 * i], force[3 * i + 1], force[3 * i + 2]));
      const double d = 1e-6;
      sum.force += f;
      sum.torque += (point_of(*touch, hand, opening) - as_vec3(hand.translation)).cross(f);
      sum.opening +=
          f.dot(point_of(*touch, hand, opening + d) - point_of(*touch, hand, opening - d)) / (2 * d);
    }
  }
  return sum;
}

TEST(HapticTick, AgreesWithADenseSolutionOfTheShiftedProblem) {
  Grip grip = make_grip();
  const ToolProblem problem = problem_of(grip);
  const Vec3 home(-0.1, 0, Grip::height);
  double largest = 0;
  for (int k = 1; k <= 12; ++k) {
    const Vec3 offset = 4e-4 * k * Vec3(0.2, 0.5, 1);
    const Mat3 rotation = turned(0.5 * k, {1, 0.3, -0.5});
    const double opening = 0.34 - 0.004 * k;
    grip.tick(offset, opening, rotation);
    const Wrench wrench = grip.channel.lawful_wrench();
    const Reference reference =
        dense_reference(grip, problem, pose_of(rotation, home + offset), opening);
    const double scale = reference.force.norm() + 0.05;
    largest = std::max(largest, reference.force.norm());
    EXPECT_LT((force_of(wrench) - reference.force).norm(), 2e-3 * scale) << "tick " << k;
    EXPECT_LT((torque_of(wrench) - reference.torque).norm(), 2e-3 * 0.1 * scale + 1e-5);
    EXPECT_NEAR(wrench.opening_nm, reference.opening, 2e-3 * std::abs(reference.opening) + 1e-6);
    EXPECT_GT(reference.opening, 0) << "what is squeezed opens the jaws";
  }
  EXPECT_GT(largest, 0.05);
}

TEST(HapticTick, AtThePublishedPoseFeelsThePublishedForces) {
  Grip grip = make_grip();
  const ToolProblem problem = problem_of(grip);
  Vec3 published = Vec3::Zero();
  double size = 0;
  for (std::size_t i = 0; i < problem.contacts.size(); ++i) {
    const ToolContact& c = problem.contacts[i];
    const Vec3 f = c.frame * Eigen::Map<const Eigen::Vector3f>(&problem.force[3 * i]).cast<double>();
    published += (double(c.a.jaw >= 0) - double(c.b.jaw >= 0)) * f;
    size += f.norm();
  }
  grip.tick(Vec3::Zero(), 0.34);
  const Wrench wrench = grip.tick(Vec3::Zero(), 0.34);
  EXPECT_LT((force_of(wrench) - published).norm(), 1e-4 * size);
  EXPECT_GT(wrench.opening_nm, 0);
}

TEST(HapticTick, RepeatedAtOnePoseStaysWhereItIs) {
  Grip grip = make_grip();
  const Vec3 offset(0, 0, 0.003);
  for (int k = 0; k < 5; ++k) grip.tick(offset, 0.33);
  const Vec3 first = force_of(grip.tick(offset, 0.33));
  for (int k = 0; k < 200; ++k) grip.tick(offset, 0.33);
  EXPECT_LT((force_of(grip.tick(offset, 0.33)) - first).norm(), 1e-3 * first.norm());
}

TEST(HapticTick, ResidualStaysWithinTheGoalWhileTheHandMoves) {
  HapticSettings settings = patient_settings();
  settings.residual_goal = 1e-4;
  Grip grip = make_grip(settings);
  for (int k = 0; k < 100; ++k) {
    grip.tick(0.002 * Vec3(std::sin(0.1 * k), std::sin(0.07 * k), std::sin(0.13 * k)),
              0.34 + 0.01 * std::sin(0.05 * k), turned(2 * std::sin(0.09 * k), {1, 1, 0}));
    EXPECT_LE(grip.channel.residual(), 1e-4);
  }
}

TEST(HapticTick, LeavesTheProblemOfThePhysicsAsItWas) {
  Grip grip = make_grip();
  const auto before = grip.world.snapshot();
  for (int k = 0; k < 20; ++k) grip.tick({0, 0.001, 0.002}, 0.3);
  EXPECT_EQ(grip.world.snapshot(), before);
  const Vec3 away = force_of(grip.tick({0, 0.001, 0.002}, 0.3));
  for (int k = 0; k < 3; ++k) grip.tick(Vec3::Zero(), 0.34);
  const Vec3 back = force_of(grip.tick(Vec3::Zero(), 0.34));
  Grip other = make_grip();
  other.tick(Vec3::Zero(), 0.34);
  EXPECT_LT((back - force_of(other.tick(Vec3::Zero(), 0.34))).norm(), 1e-3 * away.norm() + 1e-4);
}

TEST(HapticTick, AllocatesNothing) {
  HapticSettings settings;
  settings.max_sweeps = 500;
  Grip grip = make_grip(settings);
  for (int k = 0; k < 3; ++k) {
    grip.tick({0, 0, 0.001}, 0.33);
    physics_step(grip.world, grip.channel);
  }
  for (int k = 0; k < 5; ++k) {
    const std::size_t before = allocation_count();
    for (int t = 0; t < 10; ++t) grip.tick({0, 0.0001 * t, 0.001}, 0.33);
    grip.channel.tick();
    grip.channel.tick(sample_at(NAN, {NAN, 0, 0}));
    grip.channel.tick(sample_at(grip.time, {5, 0, 0}));
    EXPECT_EQ(allocation_count() - before, 0u) << "in ticks";
    ASSERT_TRUE(grip.channel.begin_step(grip.world).ok());
    step(grip.world);
    const std::size_t published = allocation_count();
    const bool ok = grip.channel.publish(grip.world).ok();
    EXPECT_EQ(allocation_count() - published, 0u) << "in publish";
    ASSERT_TRUE(ok);
  }
}

TEST(HapticTick, ContactsBeyondItsRoomAreToldAndTheMostLoadedFelt) {
  HapticSettings settings = patient_settings();
  settings.contact_capacity = 12;
  Grip grip = make_grip(settings);
  grip.tick(Vec3::Zero(), 0.34);
  const HapticTelemetry told = grip.channel.telemetry();
  EXPECT_EQ(told.contacts, 12u);
  EXPECT_EQ(told.contacts_left_out, problem_of(grip).contacts.size() - 12);
  EXPECT_GT(grip.tick(Vec3::Zero(), 0.34).opening_nm, 0);
}

TEST(HapticTick, SettingsThatMeanNothingAreRefused) {
  World world = make_world(settings_of(mu));
  const Tool tool = add_tool(world, sphere_shape(radius), spring(stiffness), Vec3::Zero());
  const auto refused = [&](auto&& change) {
    HapticSettings settings;
    change(settings);
    EXPECT_FALSE(HapticChannel::create(tool, settings).ok());
  };
  refused([](HapticSettings& s) { s.contact_capacity = 0; });
  refused([](HapticSettings& s) { s.contact_capacity = 1u << 20; });
  refused([](HapticSettings& s) { s.tick_budget_s = NAN; });
  refused([](HapticSettings& s) { s.residual_goal = -1; });
  refused([](HapticSettings& s) { s.max_sweeps = 0; });
  refused([](HapticSettings& s) { s.fade_s = 0; });
  refused([](HapticSettings& s) { s.dead_after_s = NAN; });
  refused([](HapticSettings& s) { s.reach_m = 0; });
  refused([](HapticSettings& s) { s.limits.rate_hz = 0; });
  refused([](HapticSettings& s) { s.limits.force_n = NAN; });
  EXPECT_TRUE(HapticChannel::create(tool, {}).ok());
}

}  // namespace
}  // namespace souple
