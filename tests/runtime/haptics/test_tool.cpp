// SPDX-License-Identifier: MIT
// Bodies that a hand holds, and the problem that a step leaves for it.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/allocation_count.hpp"
#include "tests/support/box_mesh.hpp"
#include "tests/support/dense_compliance.hpp"
#include "tests/support/tool_scenes.hpp"

namespace souple {
namespace {

using namespace test;

constexpr double radius = 0.02;

HandleCoupling spring(double stiffness, double turning = 50) {
  HandleCoupling coupling;
  coupling.stiffness_n_m = stiffness;
  coupling.turn_stiffness_nm_rad = turning;
  return coupling;
}

WorldSettings settings_of(double friction = 0.4) {
  WorldSettings settings;
  settings.friction = friction;
  settings.contact_solver.tolerance = 1e-10;
  return settings;
}

void expect_same(const Pose& a, const Pose& b, double tolerance) {
  const RigidPlacement one = placement(a), two = placement(b);
  EXPECT_LT((one.translation - two.translation).norm(), tolerance);
  EXPECT_LT((one.rotation - two.rotation).norm(), tolerance);
}

TEST(HeldBody, FollowsTheHandExactlyAtAnySpeed) {
  World world = make_world(settings_of());
  const Tool tool = add_tool(world, box_shape({0.01, 0.02, 0.03}), spring(500), Vec3::Zero());
  for (int k = 1; k <= 50; ++k) {
    const Pose hand =
        pose_of(turned(47.0 * k, {1, 2, -1}), 0.3 * k * Vec3(std::sin(k), 1, -std::cos(k)));
    ASSERT_TRUE(tool.move(world, hand, 0).ok());
    step(world);
    expect_same(world.rigid_pose(tool.bodies()[0]), hand, 1e-9);
  }
}

TEST(HeldBody, DamperLetsItGoByTheTimeConstantOfTheCoupling) {
  const double k = 1000, b = 50, h = 0.01;
  HandleCoupling coupling = spring(k);
  coupling.damping_n_s_m = b;
  World world = make_world(settings_of());
  add_plane(world);
  const Tool tool = add_tool(world, sphere_shape(radius), coupling, {0, 0, 0.1});
  // Pressed into the plane, then lifted: what is left of the way shrinks by B/h / (K + B/h) a step.
  for (const double z : {0.03, radius - 0.005}) {
    ASSERT_TRUE(tool.move(world, pose_of(Mat3::Identity(), {0, 0, z}), 0).ok());
    step(world);
  }
  const double behind = place_of(world, tool.bodies()[0]).z() - (radius - 0.005);
  EXPECT_NEAR(behind, 0.005, 1e-5);
  for (int n = 1; n <= 4; ++n) {
    ASSERT_TRUE(tool.move(world, pose_of(Mat3::Identity(), {0, 0, 0.08}), 0).ok());
    step(world);
    EXPECT_NEAR(place_of(world, tool.bodies()[0]).z() - 0.08, behind * std::pow(b / h / (k + b / h), n),
                1e-6);
  }
}

TEST(HeldBody, PressesAPlaneWithItsSpring) {
  const double stiffness = 800, depth = 0.004;
  World world = make_world(settings_of());
  const BodyId plane = add_plane(world);
  const Tool tool = add_tool(world, sphere_shape(radius), spring(stiffness), {0, 0, 0.021});
  ASSERT_TRUE(tool.move(world, pose_of(Mat3::Identity(), {0, 0, radius - depth}), 0).ok());
  step(world);
  EXPECT_NEAR(contact_force(world, tool.bodies()[0]).z(), stiffness * depth, 1e-3 * stiffness * depth);
  EXPECT_NEAR(place_of(world, tool.bodies()[0]).z(), radius, 1e-6);
  EXPECT_NEAR(event_force(world, plane, tool.bodies()[0]).z(), stiffness * depth,
              1e-3 * stiffness * depth);
}

TEST(HeldBody, TakesPartInASnapshot) {
  World world = make_world(settings_of());
  add_plane(world);
  HandleCoupling coupling = spring(800);
  coupling.damping_n_s_m = 20;
  const Tool tool = add_tool(world, sphere_shape(radius), coupling, {0, 0, 0.021});
  const auto press = [&](double z) {
    ASSERT_TRUE(tool.move(world, pose_of(turned(5, {1, 0, 0}), {0.001, 0, z}), 0).ok());
    step(world);
  };
  press(0.018);
  const auto before = world.snapshot();
  press(0.016);
  const Pose first = world.rigid_pose(tool.bodies()[0]);
  ASSERT_TRUE(world.restore(before).ok());
  press(0.016);
  expect_same(world.rigid_pose(tool.bodies()[0]), first, 0 + 1e-300);
}

TEST(HeldBody, ImpossibleDescriptionsAndPosesAreRefused) {
  World world = make_world(settings_of());
  const auto refused = [&](auto&& change) {
    ToolDescription tool;
    tool.jaws.resize(1);
    tool.jaws[0].shape = sphere_shape(radius);
    change(tool);
    EXPECT_FALSE(Tool::create(world, tool).ok());
  };
  refused([](ToolDescription& d) { d.jaws.clear(); });
  refused([](ToolDescription& d) { d.jaws.resize(3, d.jaws[0]); });
  refused([](ToolDescription& d) { d.jaws[0].shape = {}; });
  refused([](ToolDescription& d) { d.jaws[0].coupling.stiffness_n_m = 0; });
  refused([](ToolDescription& d) { d.jaws[0].coupling.turn_stiffness_nm_rad = NAN; });
  refused([](ToolDescription& d) { d.jaws[0].coupling.damping_n_s_m = -1; });
  refused([](ToolDescription& d) { d.jaws[0].coupling.look_ahead_m = INFINITY; });
  refused([](ToolDescription& d) { d.jaws[0].axis = {0, 0, 0}; });
  refused([](ToolDescription& d) { d.jaws[0].hinge.translation[1] = NAN; });
  refused([](ToolDescription& d) { d.jaws[0].mount.rotation = {0, 0, 0, 0}; });
  refused([](ToolDescription& d) { d.opening_rad = 100; });
  refused([](ToolDescription& d) { d.pose.translation[0] = INFINITY; });
  const Tool tool = add_tool(world, sphere_shape(radius), spring(500), {0, 0, 1});
  EXPECT_FALSE(tool.move(world, pose_of(Mat3::Identity(), {0, NAN, 0}), 0).ok());
  EXPECT_FALSE(tool.move(world, {}, INFINITY).ok());
  EXPECT_FALSE(world.move_handle(BodyId{77}, {}).ok());
  step(world);
  EXPECT_EQ(place_of(world, tool.bodies()[0]).z(), 1);
}

TEST(HeldBody, IsPlacedPastWhatLiesBetween) {
  World world = make_world(settings_of());
  add_box(world, {0.1, 0.1, 0.1}, Vec3::Zero());
  const Tool tool = add_tool(world, sphere_shape(radius), spring(500), {-0.2, 0, 0});
  const Pose beyond = pose_of(Mat3::Identity(), {0.2, 0, 0});
  ASSERT_TRUE(tool.place(world, beyond, 0).ok());
  step(world);
  expect_same(world.rigid_pose(tool.bodies()[0]), beyond, 1e-12);
  ASSERT_TRUE(tool.move(world, pose_of(Mat3::Identity(), {-0.2, 0, 0}), 0).ok());
  step(world);
  EXPECT_GT(place_of(world, tool.bodies()[0]).x(), 0.1) << "a motion is stopped";
}

struct Grip {
  World world;
  Tool tool;
  BodyId bar;
};

// A soft bar of 4 x 4 cm across between the jaws, on a plane that it rests on.
Grip make_grip(double opening, int passes = 1) {
  const double h = 0.01;
  WorldSettings settings = settings_of(0.6);
  settings.contact_passes = passes;
  Grip grip{make_world(settings), {}, {}};
  grip.bar = add_soft(grip.world,
                      make_body(box_mesh({3, 4, 3}, {-0.02, -0.02, -0.02}, {0.04, 0.04, 0.04}),
                                material_of(1e4, 0.4, 1000, 0.1, 0.01), h),
                      {0, 0, 0.02});
  add_plane(grip.world);
  grip.tool = add_forceps(grip.world, spring(2000), {-0.1, 0, 0.022}, opening);
  return grip;
}

void close_jaws(Grip& grip, double from, double to, int steps) {
  for (int k = 1; k <= steps; ++k) {
    const double opening = from + (to - from) * k / steps;
    ASSERT_TRUE(grip.tool.move(grip.world, pose_of(Mat3::Identity(), {-0.1, 0, 0.022}), opening).ok());
    step(grip.world);
  }
}

TEST(ToolProblem, IsTheProblemOfTheStepReordered) {
  Grip grip = make_grip(0.5);
  close_jaws(grip, 0.5, 0.34, 30);
  const StepContactProblem all = grip.world.contact_problem();
  ToolProblem problem;
  problem.reserve(512);
  ASSERT_TRUE(grip.world.tool_problem(grip.tool.bodies(), problem).ok());
  ASSERT_EQ(problem.contacts.size(), all.contacts.size()) << "the floor belongs to the island";
  EXPECT_GT(problem.contacts.size(), 20u);
  EXPECT_EQ(problem.left_out, 0u);
  const std::size_t count = all.contacts.size(), size = 3 * count;
  std::vector<std::size_t> place(count);
  double last = INFINITY, largest_w = 0, largest_q = 0;
  for (std::size_t k = 0; k < count; ++k) {
    const Vec3 force = Eigen::Map<const Eigen::Vector3f>(&problem.force[3 * k]).cast<double>();
    const double load = force.norm();
    // A key may be there twice.
    double nearest = INFINITY;
    for (std::size_t i = 0; i < count; ++i) {
      const double apart = (Eigen::Map<const Vec3>(&all.force[3 * i]) - force).norm();
      if (all.contacts[i].key != problem.contacts[k].key || apart >= nearest) continue;
      place[k] = i;
      nearest = apart;
    }
    ASSERT_LT(nearest, INFINITY);
    EXPECT_LE(load, last * (1 + 1e-6));
    last = load;
  }
  for (const double w : all.delassus) largest_w = std::max(largest_w, std::abs(w));
  for (const double q : all.free_gap) largest_q = std::max(largest_q, std::abs(q));
  for (std::size_t i = 0; i < size; ++i) {
    const std::size_t row = 3 * place[i / 3] + i % 3;
    EXPECT_NEAR(problem.free_gap[i], all.free_gap[row], 1e-6 * largest_q);
    EXPECT_NEAR(problem.force[i], all.force[row], 1e-6 * std::abs(all.force[row]) + 1e-12);
    double gap = problem.free_gap[i];
    for (std::size_t j = 0; j < size; ++j) {
      const std::size_t column = 3 * place[j / 3] + j % 3;
      EXPECT_NEAR(problem.delassus.column(j)[i], all.delassus[row * size + column], 1e-6 * largest_w);
      gap += double(problem.delassus.column(j)[i]) * double(problem.force[j]);
    }
    EXPECT_NEAR(problem.gap[i], gap, 1e-5 * largest_q);
  }
}

TEST(ToolProblem, MoreContactsThanRoomLeavesOutThoseThatBearLeast) {
  Grip grip = make_grip(0.5);
  close_jaws(grip, 0.5, 0.34, 30);
  ToolProblem all, some;
  all.reserve(512);
  some.reserve(10);
  ASSERT_TRUE(grip.world.tool_problem(grip.tool.bodies(), all).ok());
  ASSERT_TRUE(grip.world.tool_problem(grip.tool.bodies(), some).ok());
  ASSERT_EQ(some.contacts.size(), 10u);
  EXPECT_EQ(some.left_out, all.contacts.size() - 10);
  for (std::size_t k = 0; k < 10; ++k) EXPECT_EQ(some.contacts[k].key, all.contacts[k].key);
  // What was left out is as free to move as the rest of the world is: its forces stay.
  for (std::size_t i = 0; i < 30; ++i) {
    double gap = some.free_gap[i];
    for (std::size_t j = 0; j < 30; ++j)
      gap += double(some.delassus.column(j)[i]) * double(some.force[j]);
    EXPECT_NEAR(gap, all.gap[i], 1e-8);
  }
}

TEST(ToolProblem, AllocatesNothingOnceItHasItsRoom) {
  Grip grip = make_grip(0.5);
  close_jaws(grip, 0.5, 0.34, 30);
  ToolProblem problem;
  problem.reserve(512);
  ASSERT_TRUE(grip.world.tool_problem(grip.tool.bodies(), problem).ok());
  const std::size_t before = allocation_count();
  const bool ok = grip.world.tool_problem(grip.tool.bodies(), problem).ok();
  EXPECT_EQ(allocation_count() - before, 0u);
  EXPECT_TRUE(ok);
}

TEST(ToolProblem, IsOfHeldBodiesOnly) {
  Grip grip = make_grip(0.5);
  ToolProblem problem;
  problem.reserve(8);
  const std::vector<BodyId> bar{grip.bar}, none, missing{BodyId{99}};
  EXPECT_FALSE(grip.world.tool_problem(bar, problem).ok());
  EXPECT_FALSE(grip.world.tool_problem(none, problem).ok());
  EXPECT_FALSE(grip.world.tool_problem(missing, problem).ok());
}

// Mean vertical force of the jaws over the weight, from a bar lifted by 5 cm and held there.
double held_weight(int passes) {
  Grip grip = make_grip(0.5, passes);
  close_jaws(grip, 0.5, 0.32, 30);
  const double before = centre_of_mass(grip.world, grip.bar).z();
  const auto move_to = [&](double height) {
    const Pose hand = pose_of(Mat3::Identity(), {-0.1, 0, height});
    EXPECT_TRUE(grip.tool.move(grip.world, hand, 0.32).ok());
    step(grip.world);
  };
  for (int k = 1; k <= 100; ++k) move_to(0.022 + 0.0005 * k);
  constexpr int steps = 100;
  double force = 0;
  for (int k = 0; k < steps; ++k) {
    move_to(0.072);
    force += contact_force(grip.world, grip.bar).z() / steps;
  }
  EXPECT_GT(centre_of_mass(grip.world, grip.bar).z(), before + 0.045) << "lifted by 5 cm";
  return force / (9.81 * grip.world.asset(grip.bar).model().total_mass());
}

// A bar squeezed by a fifth: single forces tremble by a few per cent as contacts come and go at its
// edges, by the exact compliance too. Their mean is off by the error of warping, which a second pass
// takes away (METHOD 4.2).
TEST(Forceps, LiftASoftBodyByFriction) {
  EXPECT_NEAR(held_weight(1), 1, 0.1);
  EXPECT_NEAR(held_weight(2), 1, 0.02);
}

}  // namespace
}  // namespace souple
