// SPDX-License-Identifier: MIT
// Joints and grabs: what they hold, what they leave free, and that they only pass momentum on.
#include <gtest/gtest.h>

#include <cmath>

#include "runtime/contact/contact.hpp"
#include "tests/support/box_mesh.hpp"
#include "tests/support/dense_compliance.hpp"
#include "tests/support/rigid_scenes.hpp"

namespace souple {
namespace {

using namespace test;

constexpr double g = 9.81;

WorldSettings settings_of(double h, double gravity = g) {
  WorldSettings settings;
  settings.time_step_s = h;
  settings.gravity_m_s2 = {0, 0, -gravity};
  settings.contact_solver.tolerance = 1e-12;
  return settings;
}

JointDescription joint_of(JointKind kind, BodyId a, std::optional<BodyId> b, const Vec3& point) {
  JointDescription joint;
  joint.name = "joint";
  joint.kind = kind;
  joint.body_a = a;
  joint.body_b = b;
  joint.point_m = as_point(point);
  joint.arm_m = 0.05;
  joint.reach_m = 0.01;
  return joint;
}

Mat3 rotation_of(const World& world, BodyId body) {
  const auto& q = world.rigid_pose(body).rotation;
  return Eigen::Quaterniond(q[0], q[1], q[2], q[3]).toRotationMatrix();
}

std::shared_ptr<const SoftBodyAsset> soft_bar(double h, double alpha = 0) {
  return make_body(box_mesh({6, 2, 2}, {-0.15, -0.05, -0.05}, {0.3, 0.1, 0.1}),
                   material_of(5e4, 0.3, 1000, alpha, 0.01), h);
}

TEST(Joints, TwoRodsHangTogetherAndSwing) {
  World world = make_world(settings_of(1e-3));
  const Mat3 lying = turned(90, {0, 1, 0});
  const BodyId upper = add_free(world, capsule_shape(0.01, 0.2), {0.2, 0, 0}, lying);
  const BodyId lower = add_free(world, capsule_shape(0.01, 0.2), {0.6, 0, 0}, lying);
  ASSERT_TRUE(world.add_joint(joint_of(JointKind::ball, upper, {}, Vec3::Zero())).ok());
  ASSERT_TRUE(world.add_joint(joint_of(JointKind::ball, lower, upper, {0.4, 0, 0})).ok());
  double worst = 0, most = -INFINITY;
  for (int k = 0; k < 2000; ++k) {
    step(world);
    const Vec3 head = place_of(world, upper) + rotation_of(world, upper) * Vec3(0, 0, -0.2);
    const Vec3 meet = place_of(world, upper) + rotation_of(world, upper) * Vec3(0, 0, 0.2) -
                      place_of(world, lower) - rotation_of(world, lower) * Vec3(0, 0, -0.2);
    worst = std::max({worst, head.norm(), meet.norm()});
    most = std::max(most, place_of(world, lower).z());
  }
  // A step turns the arms by their rotation vector, the problem by its linear part: omega^2 h^2 l / 2.
  EXPECT_LT(worst, 0.5 * 20 * 20 * 1e-6 * 0.4);
  EXPECT_LT(most, 0.01) << "it does not rise above where it was released";
}

TEST(Joints, PendulumHasThePeriodOfItsInertia) {
  const double h = 1e-3, radius = 0.02, length = 0.5;
  World world = make_world(settings_of(h));
  const double swing = 5 * M_PI / 180;
  const BodyId bob =
      add_free(world, sphere_shape(radius), {length * std::sin(swing), 0, -length * std::cos(swing)});
  ASSERT_TRUE(world.add_joint(joint_of(JointKind::ball, bob, {}, Vec3::Zero())).ok());
  std::vector<double> crossings;
  double last = place_of(world, bob).x();
  for (int k = 1; k < 4000; ++k) {
    step(world);
    const double x = place_of(world, bob).x();
    if (last > 0 && x <= 0) crossings.push_back((k - 1 + last / (last - x)) * h);
    last = x;
  }
  ASSERT_GE(crossings.size(), 2u);
  const double inertia = length * length + 0.4 * radius * radius;
  const double period = 2 * M_PI * std::sqrt(inertia / (g * length)) * (1 + swing * swing / 16);
  EXPECT_NEAR(crossings[1] - crossings[0], period, 2e-3 * period);
}

TEST(Joints, HingeKeepsItsAxisAndLeavesTheTurnAboutIt) {
  World world = make_world(settings_of(1e-3));
  const BodyId door = add_free(world, box_shape({0.2, 0.01, 0.1}), {0.2, 0, 0}, Mat3::Identity(),
                               moving(Vec3(0, 0.6, 0), Vec3(0, 0, 3)));
  auto hinge = joint_of(JointKind::hinge, door, {}, Vec3::Zero());
  hinge.arm_m = 0.2;
  ASSERT_TRUE(world.add_joint(hinge).ok());
  double turned_most = 0;
  for (int k = 0; k < 1000; ++k) {
    step(world);
    const Mat3 now = rotation_of(world, door);
    ASSERT_GT(now(2, 2), 1 - 1e-9) << k;
    ASSERT_LT((place_of(world, door) - now * Vec3(0.2, 0, 0)).norm(), 1e-5) << k;
    turned_most = std::max(turned_most, std::acos(std::clamp(now(0, 0), -1.0, 1.0)));
  }
  EXPECT_GT(turned_most, 2.5);
  EXPECT_NEAR(world.rigid_angular_velocity(door)[2], 3, 0.02) << "nothing brakes it";
}

TEST(Joints, WeldKeepsThePoseUnderWeightAndInFlight) {
  World world = make_world(settings_of(2e-3));
  const BodyId beam = add_free(world, box_shape({0.1, 0.02, 0.02}), {0.1, 0, 0}, turned(0, {0, 0, 1}));
  ASSERT_TRUE(world.add_joint(joint_of(JointKind::weld, beam, {}, Vec3::Zero())).ok());
  const BodyId a = add_free(world, box_shape({0.05, 0.05, 0.05}), {1, 0, 0}, Mat3::Identity(),
                            moving(Vec3(1, 0, 2), Vec3(1, 3, 2)));
  const BodyId b = add_free(world, sphere_shape(0.05), {1.1, 0.02, 0.03});
  ASSERT_TRUE(world.add_joint(joint_of(JointKind::weld, a, b, {1.05, 0, 0})).ok());
  double worst = 0;
  for (int k = 0; k < 1000; ++k) {
    const StepReport report = step(world);
    worst = std::max(worst, report.worst_joint_error_m);
    ASSERT_LT((place_of(world, beam) - Vec3(0.1, 0, 0)).norm(), 1e-7);
    const Vec3 apart = rotation_of(world, a).transpose() * (place_of(world, b) - place_of(world, a));
    ASSERT_LT((apart - Vec3(0.1, 0.02, 0.03)).norm(), 1e-4) << k;
    ASSERT_LT((rotation_of(world, a).transpose() * rotation_of(world, b) - Mat3::Identity()).norm(),
              5e-3);
  }
  EXPECT_LT(worst, 1e-6) << "the linear problem is solved";
}

TEST(Joints, InternalJointsPassMomentumOnAndKeepItsSum) {
  World world = make_world(settings_of(2e-3, 0));
  std::vector<BodyId> links;
  for (int k = 0; k < 4; ++k)
    links.push_back(add_free(world, capsule_shape(0.02, 0.1), {0.24 * k, 0, 0}, turned(90, {0, 1, 0}),
                             moving(Vec3(0, k == 0 ? 1 : 0, k == 3 ? -2 : 0.3))));
  for (int k = 0; k + 1 < 4; ++k)
    ASSERT_TRUE(world
                    .add_joint(joint_of(JointKind::ball, links[std::size_t(k)],
                                        links[std::size_t(k) + 1], {0.24 * k + 0.12, 0, 0}))
                    .ok());
  const StepReport first = step(world);
  StepReport last;
  for (int k = 0; k < 500; ++k) last = step(world);
  const Vec3 p0 = as_vec3(first.linear_momentum_kg_m_s), p1 = as_vec3(last.linear_momentum_kg_m_s);
  const Vec3 l0 = as_vec3(first.angular_momentum_kg_m2_s), l1 = as_vec3(last.angular_momentum_kg_m2_s);
  EXPECT_LT((p1 - p0).norm(), 1e-10 * p0.norm());
  EXPECT_LT((l1 - l0).norm(), 0.02 * l0.norm()) << "to the order of the integrator";
  EXPECT_LE(last.kinetic_energy_j, first.kinetic_energy_j * (1 + 1e-9));
}

TEST(Joints, SoftBodyHangsFromTheWorldAndCarriesARigidOne) {
  const double h = 0.01;
  World world = make_world(settings_of(h));
  const auto asset = soft_bar(h, 5);  // against swinging
  const BodyId bar = add_soft(world, asset, Vec3::Zero(), turned(90, {0, 1, 0}));
  const BodyId weight = add_free(world, sphere_shape(0.05), {0, 0, -0.2});
  auto top = joint_of(JointKind::weld, bar, {}, {0, 0, 0.15});
  top.axis = {0.5, 1, 0};  // its third point lies in the end face as well
  ASSERT_TRUE(world.add_joint(top).ok());
  ASSERT_TRUE(world.add_joint(joint_of(JointKind::ball, bar, weight, {0, 0, -0.15})).ok());
  StepReport report;
  for (int k = 0; k < 1000; ++k) report = step(world);
  EXPECT_LT(report.kinetic_energy_j, 1e-8);
  EXPECT_LT(report.worst_joint_error_m, 1e-7);
  // F L / (E A) of the bar's own weight, halved, and of the ball's; the points' own dents come on top.
  const double mass = 1000 * 4.0 / 3 * M_PI * std::pow(0.05, 3);
  const double longer = (mass * g + 0.5 * 3 * g) * 0.3 / (5e4 * 0.01);
  const double sunk = -0.2 - place_of(world, weight).z();
  EXPECT_GT(sunk, longer);
  EXPECT_LT(sunk, 4 * longer);
}

// What is welded to the world and pulled by a hand cannot follow: the force that would satisfy both
// does not exist. It must settle, not grow from step to step.
TEST(Joints, AHandThatPullsAtAWeldedBodyMeetsABoundedForce) {
  World world = make_world(settings_of(0.01));
  const BodyId box = add_free(world, box_shape({0.1, 0.1, 0.1}), Vec3::Zero());
  ASSERT_TRUE(world.add_joint(joint_of(JointKind::weld, box, {}, Vec3::Zero())).ok());
  const auto hand = world.grab({box, {0.1, 0, 0}});
  ASSERT_TRUE(hand.ok());
  ASSERT_TRUE(world.move_grab(*hand, pose_of(Mat3::Identity(), {0.11, 0, 0})).ok());
  double early = 0, late = 0;
  for (int k = 0; k < 2000; ++k) {
    step(world);
    double& most = k < 1000 ? early : late;
    for (const double f : world.contact_problem().force) most = std::max(most, std::abs(f));
  }
  EXPECT_LT(late, 1.01 * early);
  EXPECT_LT(place_of(world, box).norm(), 0.03);
}

TEST(Joints, BodiesOfAJointDoNotCollideUnlessAsked) {
  for (const bool collide : {false, true}) {
    World world = make_world(settings_of(0.01, 0));
    const BodyId a = add_free(world, box_shape({0.05, 0.05, 0.05}), {0, 0, 0});
    const BodyId b = add_free(world, box_shape({0.05, 0.05, 0.05}), {0, 0, 0.1001});
    auto joint = joint_of(JointKind::ball, a, b, {0, 0, 0.05});
    joint.collide = collide;
    ASSERT_TRUE(world.add_joint(joint).ok());
    step(world);
    EXPECT_EQ(!world.contacts().empty(), collide);
  }
}

TEST(Grabs, SoftBodyFollowsTheHandAndFallsWhenReleased) {
  const double h = 0.01;
  World world = make_world(settings_of(h));
  const auto asset = soft_bar(h);
  const BodyId bar = add_soft(world, asset, Vec3::Zero());
  const auto held = world.grab({bar, {-0.15, 0, 0}, 0.08, 16});
  ASSERT_TRUE(held.ok());
  const Index corner = 0;
  const Vec3 start = as_vec3(world.positions(bar)[corner]);
  double worst = 0;
  for (int k = 1; k <= 100; ++k) {
    ASSERT_TRUE(world.move_grab(*held, pose_of(Mat3::Identity(), {0, 0.001 * k, 0.002 * k})).ok()) << k;
    worst = std::max(worst, step(world).worst_joint_error_m);
  }
  EXPECT_LT(worst, 1e-6);
  for (int k = 0; k < 300; ++k) step(world);
  EXPECT_LT((as_vec3(world.positions(bar)[corner]) - start - Vec3(0, 0.1, 0.2)).norm(), 0.01);
  const double height = centre_of_mass(world, bar).z();
  ASSERT_TRUE(world.release(*held).ok());
  EXPECT_FALSE(world.release(*held).ok());
  EXPECT_FALSE(world.move_grab(*held, {}).ok());
  for (int k = 0; k < 20; ++k) step(world);
  EXPECT_NEAR(centre_of_mass(world, bar).z(), height - 0.5 * g * h * h * 20 * 21, 2e-3);
}

TEST(Grabs, AFullTurnOfTheHandTurnsARigidBodyOnce) {
  World world = make_world(settings_of(0.01, 0));
  const BodyId box = add_free(world, box_shape({0.1, 0.05, 0.02}), {0.2, 0, 0});
  const auto held = world.grab({box, {0.1, 0, 0}, 0.05, 16});
  ASSERT_TRUE(held.ok());
  for (int k = 1; k <= 200; ++k) {
    const Mat3 turn = turned(360.0 * k / 200, {0, 0, 1});
    ASSERT_TRUE(world.move_grab(*held, pose_of(turn, Vec3::Zero())).ok());
    step(world);
    ASSERT_LT((place_of(world, box) - turn * Vec3(0.2, 0, 0)).norm(), 2e-3) << k;
  }
  EXPECT_LT((rotation_of(world, box) - Mat3::Identity()).norm(), 0.02);
}

TEST(Joints, RefuseWhatCannotBeHeld) {
  World world = make_world(settings_of(0.01));
  const BodyId body = add_free(world, sphere_shape(0.1), {0, 0, 1});
  const BodyId plane = add_plane(world);
  const BodyId bar = add_soft(world, soft_bar(0.01), {1, 0, 1});
  const double nan = std::nan("");
  auto good = joint_of(JointKind::ball, body, {}, {0, 0, 1});
  const auto refuses = [&](auto&& spoil) {
    JointDescription joint = good;
    spoil(joint);
    const auto result = world.add_joint(joint);
    return !result.ok() && result.issue().code == IssueCode::joint_invalid;
  };
  EXPECT_TRUE(refuses([](auto& j) { j.body_a = {77}; }));
  EXPECT_TRUE(refuses([](auto& j) { j.body_b = BodyId{99}; }));
  EXPECT_TRUE(refuses([&](auto& j) { j.body_b = body; })) << "with itself";
  EXPECT_TRUE(refuses([&](auto& j) { j.body_a = plane; })) << "nothing can move it";
  EXPECT_TRUE(refuses([&](auto& j) { j.point_m[1] = nan; }));
  EXPECT_TRUE(refuses([&](auto& j) { j.axis = {0, 0, 0}; }));
  EXPECT_TRUE(refuses([&](auto& j) { j.axis = {nan, 0, 1}; }));
  EXPECT_TRUE(refuses([&](auto& j) { j.arm_m = 0; }));
  EXPECT_TRUE(refuses([&](auto& j) { j.arm_m = nan; }));
  EXPECT_TRUE(refuses([&](auto& j) { j.reach_m = -1; }));
  EXPECT_TRUE(refuses([&](auto& j) { j.body_a = bar; })) << "a metre from the soft body";
  EXPECT_FALSE(world.grab({plane, {0, 0, 0}}).ok());
  EXPECT_FALSE(world.grab({{88}, {0, 0, 0}}).ok());
  EXPECT_FALSE(world.grab({body, {nan, 0, 0}}).ok());
  EXPECT_FALSE(world.grab({body, {0, 0, 1}, -1}).ok());
  EXPECT_FALSE(world.grab({body, {0, 0, 1}, 0, 0}).ok());
  EXPECT_FALSE(world.move_grab({5}, {}).ok());
  EXPECT_FALSE(world.release({5}).ok());
  const auto held = world.grab({body, {0, 0, 1}});
  ASSERT_TRUE(held.ok());
  EXPECT_FALSE(world.move_grab(*held, {{0, 0, 0, 0}, {}}).ok());
  EXPECT_FALSE(world.move_grab(*held, {{1, 0, 0, 0}, {nan, 0, 0}}).ok());
  EXPECT_TRUE(world.step().ok()) << "a refusal leaves the world as it was";
}

}  // namespace
}  // namespace souple
