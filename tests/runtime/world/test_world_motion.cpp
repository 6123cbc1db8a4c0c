// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include "runtime/contact/contact.hpp"
#include "tests/support/allocation_count.hpp"
#include "tests/support/box_mesh.hpp"
#include "tests/support/dense_compliance.hpp"
#include "tests/support/scenes.hpp"

namespace souple {
namespace {

using namespace test;

std::shared_ptr<const SoftBodyAsset> soft_box(double alpha = 0.1, double beta = 0.01, double h = 0.01) {
  return make_body(box_mesh({3, 3, 3}, {-0.1, -0.1, 0}, {0.2, 0.2, 0.2}),
                   material_of(1e4, 0.4, 1000, alpha, beta), h);
}

TEST(WorldMotion, FreeFallIsThatOfTheScheme) {
  WorldSettings settings;
  World world = make_world(settings);
  const BodyId body = add_soft(world, soft_box(0, 0.01), {0, 0, 100}, turned(30, {1, 0, 0}), {1, 0, 0});
  const Vec3 start = centre_of_mass(world, body);
  const int steps = 50;
  for (int k = 0; k < steps; ++k) step(world);
  const double h = settings.time_step_s, t = steps * h;
  // Implicit Euler: v_k = -g k h, x_k = -g h^2 k (k + 1) / 2.
  const Vec3 expected = start + Vec3(t, 0, -9.81 * h * h * steps * (steps + 1) / 2);
  EXPECT_LT((centre_of_mass(world, body) - expected).norm(), 1e-7);
  EXPECT_LT((mean_velocity(world, body) - Vec3(1, 0, -9.81 * t)).norm(), 1e-6);
}

TEST(WorldMotion, FreeBodyKeepsItsMomentumWhileItVibrates) {
  WorldSettings settings;
  settings.gravity_m_s2 = {0, 0, 0};
  settings.free_motion.tolerance = 1e-12;
  World world = make_world(settings);
  const BodyId body = add_soft(world, soft_box(0, 0.002), Vec3::Zero());
  std::vector<Point> x(world.positions(body).begin(), world.positions(body).end()), v(x.size());
  for (std::size_t k = 0; k < x.size(); ++k) {
    x[k][0] *= 1.3;  // stretched, and each node with its own velocity
    v[k] = {0.1 * double(k % 5), -0.2, 0.1 * double(k % 3)};
  }
  ASSERT_TRUE(world.set_state(body, x, v).ok());
  const Vec3 before = mean_velocity(world, body);
  double energy = INFINITY;
  for (int k = 0; k < 100; ++k) {
    const StepReport report = step(world);
    EXPECT_LT(report.kinetic_energy_j + report.elastic_energy_j, energy * (1 + 1e-9));
    energy = report.kinetic_energy_j + report.elastic_energy_j;
  }
  EXPECT_LT((mean_velocity(world, body) - before).norm(), 1e-10);
}

TEST(WorldMotion, ClampedBodyHangsAndItsFixedNodesStay) {
  const TetMesh mesh = box_mesh({8, 2, 2}, {0, 0, 0}, {0.2, 0.05, 0.05});
  FixedSet wall{"wall", {}};
  for (Index n = 0; n < Index(mesh.nodes.size()); ++n)
    if (mesh.nodes[std::size_t(n)][0] == 0) wall.nodes.push_back(n);
  const Material material = material_of(1e5, 0.3, 1000, 0.1, 0.02);
  const auto body_asset = make_body(mesh, material, 0.01, {wall}, "wall");
  WorldSettings settings;
  World world = make_world(settings);
  const BodyId body = add_soft(world, body_asset, {0, 0, 1}, Mat3::Identity(), Vec3::Zero(), "wall");
  for (int k = 0; k < 800; ++k) step(world);
  for (const Index n : wall.nodes)
    EXPECT_LT((as_vec3(world.positions(body)[std::size_t(n)]) - as_vec3(mesh.nodes[std::size_t(n)]) -
               Vec3(0, 0, 1))
                  .norm(),
              1e-15);
  // The same sag as the static solution of the linear problem, which is small here.
  const Eigen::MatrixXd c = dense_compliance(mesh, material, 0, 1, wall.nodes);
  const Eigen::VectorXd masses = lumped_masses(mesh, 1000);
  Eigen::VectorXd weight = Eigen::VectorXd::Zero(c.rows());
  for (Eigen::Index n = 0; n < masses.size(); ++n) weight[3 * n + 2] = -9.81 * masses[n];
  const Eigen::VectorXd sag = c * weight;
  const Eigen::Index tip = 3 * Eigen::Index(mesh.nodes.size() - 1) + 2;
  const double moved = world.positions(body).back()[2] - mesh.nodes.back()[2] - 1;
  EXPECT_LT(sag[tip], -0.005);
  EXPECT_NEAR(moved, sag[tip], 0.05 * std::abs(sag[tip]));
}

/// Angular momentum that a body gets by itself from a shear, over 50 steps, kg m^2/s; and where a node
/// ends.
std::pair<double, Vec3> sheared_and_left(RotationMethod method, double shear) {
  WorldSettings settings;
  settings.gravity_m_s2 = {0, 0, 0};
  settings.rotation_method = method;
  World world = make_world(settings);
  const BodyId body = add_soft(world, soft_box(0, 0.002), Vec3::Zero());
  std::vector<Point> x(world.positions(body).begin(), world.positions(body).end());
  for (Point& p : x) p[0] += shear * p[2];
  EXPECT_TRUE(world.set_state(body, x, std::vector<Point>(x.size())).ok());
  double largest = 0;
  for (int k = 0; k < 50; ++k)
    largest = std::max(largest, as_vec3(step(world).angular_momentum_kg_m2_s).norm());
  return {largest, as_vec3(world.positions(body).back())};
}

TEST(WorldMotion, OtherRotationsAgreeForSmallStrainsAndSpinABodyForLargeOnes) {
  const auto [spin, end] = sheared_and_left(RotationMethod::polar, 0.5);
  const auto [small_spin, small_end] = sheared_and_left(RotationMethod::polar, 1e-4);
  for (const RotationMethod method : {RotationMethod::qr, RotationMethod::gram_schmidt}) {
    EXPECT_GT(sheared_and_left(method, 0.5).first, 3 * spin);
    EXPECT_LT((sheared_and_left(method, 1e-4).second - small_end).norm(), 1e-6);
  }
}

TEST(WorldMotion, DrivenPlatePushesABodyAlong) {
  WorldSettings settings;
  settings.gravity_m_s2 = {0, 0, 0};
  World world = make_world(settings);
  const BodyId body = add_soft(world, soft_box(0, 0.01), {0, 0, 0.001});
  RigidBodyDescription plate;
  plate.name = "plate";
  plate.shape.kind = RigidShapeKind::box;
  plate.shape.half_extents_m = {0.2, 0.2, 0.02};
  plate.path = {{0, pose_of(Mat3::Identity(), {0, 0, -0.02})},
                {1, pose_of(Mat3::Identity(), {0, 0, 0.48})}};
  ASSERT_TRUE(world.add_rigid_body(plate).ok());
  double worst = 0;
  for (int k = 0; k < 100; ++k) worst = std::max(worst, step(world).worst_penetration_m);
  EXPECT_LT(worst, 1e-9);
  EXPECT_GT(mean_velocity(world, body).z(), 0.45);
}

TEST(WorldMotion, TurningPlateDragsABodyByFriction) {
  WorldSettings settings;
  settings.friction = 1;
  World world = make_world(settings);
  const BodyId body = add_soft(world, soft_box(), Vec3::Zero());
  RigidBodyDescription plate;
  plate.name = "turntable";
  plate.path = {{0, pose_of(Mat3::Identity(), Vec3::Zero())},
                {0.5, pose_of(Mat3::Identity(), Vec3::Zero())}};
  for (int k = 1; k <= 8; ++k)
    plate.path.push_back({0.5 + k, pose_of(turned(45 * k, {0, 0, 1}), Vec3::Zero())});
  ASSERT_TRUE(world.add_rigid_body(plate).ok());
  for (int k = 0; k < 450; ++k) step(world);
  const Vec3 corner = as_vec3(world.positions(body)[0]);
  const Vec3 expected =
      turned(45 * 4, {0, 0, 1}) * as_vec3(world.asset(body).model().rest_positions()[0]);
  EXPECT_LT((corner - expected).head<2>().norm(), 0.02);
}

TEST(WorldMotion, SameInputGivesTheSameBits) {
  const auto run = [] {
    World world = make_world(WorldSettings{});
    const BodyId body = add_soft(world, soft_box(), {0, 0, 0.1}, turned(30, {1, 1, 0}));
    add_plane(world);
    for (int k = 0; k < 60; ++k) step(world);
    return std::vector<Point>(world.positions(body).begin(), world.positions(body).end());
  };
  EXPECT_EQ(run(), run());
}

TEST(WorldMotion, ACopiedStateGoesOnWithTheSameBits) {
  const auto scene = [] {
    World world = make_world(WorldSettings{});
    add_soft(world, soft_box(), {0, 0, 0.05}, turned(30, {1, 1, 0}));
    add_plane(world);
    return world;
  };
  World first = scene(), second = scene();
  for (int k = 0; k < 40; ++k) step(first);
  ASSERT_TRUE(second.copy_state(first).ok());
  for (int k = 0; k < 20; ++k) {
    step(first);
    step(second);
  }
  EXPECT_EQ(std::vector<Point>(first.positions({0}).begin(), first.positions({0}).end()),
            std::vector<Point>(second.positions({0}).begin(), second.positions({0}).end()));
  EXPECT_EQ(first.time_s(), second.time_s());
  World other = make_world(WorldSettings{});
  EXPECT_FALSE(other.copy_state(first).ok());
}

/// A soft box that falls on another and a plane, under the given integrator, made anew at every call.
World heap(Integrator integrator) {
  WorldSettings settings;
  settings.integrator = integrator;
  settings.time_step_s = integrator == Integrator::bdf2 ? 0.015 : 0.01;
  World world = make_world(settings);
  const auto asset = soft_box();
  add_soft(world, asset, {0, 0, 0.05}, turned(30, {1, 1, 0}));
  add_soft(world, asset, {0.03, 0.02, 0.4}, turned(50, {0, 1, 0}));
  add_plane(world);
  return world;
}

std::vector<std::byte> end_of(World& world, int steps) {
  for (int k = 0; k < steps; ++k) step(world);
  return world.snapshot();
}

TEST(WorldMotion, ARestoredSnapshotGoesOnWithTheSameBits) {
  for (const Integrator integrator : {Integrator::implicit_euler, Integrator::bdf2}) {
    World first = heap(integrator), second = heap(integrator);
    const auto kept = end_of(first, 35);
    const auto end = end_of(first, 30);
    ASSERT_TRUE(second.restore(kept).ok());
    EXPECT_NEAR(second.time_s(), 35 * (integrator == Integrator::bdf2 ? 0.015 : 0.01), 1e-12);
    EXPECT_EQ(end_of(second, 30), end);
    ASSERT_TRUE(first.restore(kept).ok()) << "back in time";
    EXPECT_TRUE(first.contacts().empty());
    EXPECT_EQ(first.snapshot(), kept);
    EXPECT_EQ(end_of(first, 30), end);
  }
}

TEST(WorldMotion, RefusesSnapshotsOfOtherWorldsAndDamagedOnes) {
  World world = heap(Integrator::implicit_euler), other = heap(Integrator::bdf2);
  const auto good = end_of(world, 20);
  const auto is_refused = [&](World& into, std::span<const std::byte> bytes) {
    const auto before = into.snapshot();
    const Status status = into.restore(bytes);
    EXPECT_EQ(into.snapshot(), before);
    return !status && status.issue().code == IssueCode::snapshot_invalid;
  };
  EXPECT_TRUE(is_refused(other, good));

  World larger = heap(Integrator::implicit_euler);
  add_soft(larger, soft_box(), {0, 0, 2});
  EXPECT_TRUE(is_refused(larger, good));
  for (std::size_t size = 0; size < good.size(); size += 1 + good.size() / 97)
    EXPECT_TRUE(is_refused(world, std::span(good).first(size))) << size;
  for (std::size_t at = 0; at < good.size(); at += 1 + good.size() / 97) {
    auto bad = good;
    bad[at] ^= std::byte{0x10};
    EXPECT_TRUE(is_refused(world, bad)) << at;
  }
  auto longer = good;
  longer.resize(longer.size() + 8);
  EXPECT_TRUE(is_refused(world, longer));
}

TEST(WorldMotion, StepAllocatesNothingOnceWarm) {
  WorldSettings settings;
  World world = make_world(settings);
  add_soft(world, soft_box(), {0, 0, 0.02}, turned(10, {1, 0, 0}));
  add_soft(world, soft_box(), {0.05, 0.02, 0.25}, turned(20, {0, 1, 0}));
  add_plane(world);
  add_sphere(world, 0.05, {0, 0, 0});
  for (int k = 0; k < 300; ++k) step(world);
  // Every count of contacts seen so far may come back.
  const std::size_t before = allocation_count();
  for (int k = 0; k < 50; ++k) {
    const auto report = world.step();
    ASSERT_TRUE(report.ok());
  }
  EXPECT_EQ(allocation_count() - before, 0u);
}

TEST(WorldMotion, FarBodiesHaveNoContactProblem) {
  World world = make_world(WorldSettings{});
  add_soft(world, soft_box(), {0, 0, 50});
  add_plane(world);
  const StepReport report = step(world);
  EXPECT_EQ(report.contact_count, 0u);
  EXPECT_EQ(report.times.compliance_s + report.times.contact_solve_s + report.times.correction_s, 0);
}

TEST(WorldMotion, InvertedBodyRecoversItsShape) {
  WorldSettings settings;
  settings.gravity_m_s2 = {0, 0, 0};
  World world = make_world(settings);
  const BodyId body = add_soft(world, soft_box(), Vec3::Zero());
  std::vector<Point> x(world.positions(body).begin(), world.positions(body).end());
  const std::vector<Point> v(x.size());
  std::swap(x[0], x[21]);  // nodes through each other: some elements are inverted
  x[5] = x[6];
  ASSERT_TRUE(world.set_state(body, x, v).ok());
  StepReport report;
  for (int k = 0; k < 600; ++k) report = step(world);
  EXPECT_LT(report.elastic_energy_j, 1e-6);
}

}  // namespace
}  // namespace souple
