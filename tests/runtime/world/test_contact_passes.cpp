// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include "tests/support/box_mesh.hpp"
#include "tests/support/dense_compliance.hpp"
#include "tests/support/scenes.hpp"

namespace souple {
namespace {

using namespace test;

// A body that is bent and turned when it lands.
World bent_body(ContactMethod method, int passes) {
  WorldSettings settings;
  settings.contact_method = method;
  settings.contact_passes = passes;
  settings.free_motion.tolerance = 1e-11;
  World world = make_world(settings);
  const auto asset = make_body(box_mesh({6, 3, 3}, {-0.15, -0.05, -0.05}, {0.3, 0.1, 0.1}),
                               material_of(1e4, 0.4, 1000, 0.1, 0.01), 0.01);
  const BodyId body = add_soft(world, asset, {0, 0, 0.12}, turned(20, {1, 2, 0}), {0, 0, -1});
  std::vector<Point> x(world.positions(body).begin(), world.positions(body).end());
  const std::vector<Point> v(world.velocities(body).begin(), world.velocities(body).end());
  for (Point& p : x) p[2] += 3 * p[0] * p[0];
  EXPECT_TRUE(world.set_state(body, x, v).ok());
  add_plane(world);
  return world;
}

// Positions after its first impact.
std::vector<Point> bent_impact(ContactMethod method, int passes) {
  World world = bent_body(method, passes);
  for (int k = 0; k < 12; ++k) step(world);
  return {world.positions({0}).begin(), world.positions({0}).end()};
}

double distance(const std::vector<Point>& a, const std::vector<Point>& b) {
  double worst = 0;
  for (std::size_t k = 0; k < a.size(); ++k)
    worst = std::max(worst, (as_vec3(a[k]) - as_vec3(b[k])).norm());
  return worst;
}

TEST(ContactPasses, EachOneBringsTheWarpedMotionNearerToTheExactOne) {
  const auto exact = bent_impact(ContactMethod::exact, 1);
  const double one = distance(bent_impact(ContactMethod::warped, 1), exact);
  const double two = distance(bent_impact(ContactMethod::warped, 2), exact);
  const double four = distance(bent_impact(ContactMethod::warped, 4), exact);
  EXPECT_LT(two, 0.5 * one);
  EXPECT_LT(four, 0.5 * two);
  EXPECT_LT(four, 1e-3 * 0.3);
}

TEST(ContactPasses, EndWhenTheForcesHaveSettled) {
  World one = bent_body(ContactMethod::warped, 1), four = bent_body(ContactMethod::warped, 4);
  int solves_one = 0, solves_four = 0;
  for (int k = 0; k < 12; ++k) {
    solves_one += step(one).free_motion_iterations;
    solves_four += step(four).free_motion_iterations;
  }
  EXPECT_GT(solves_four, solves_one) << "in an impact";
  for (int k = 0; k < 600; ++k) step(four);
  ASSERT_TRUE(one.copy_state(four).ok());
  step(one);
  step(four);
  EXPECT_EQ(step(four).free_motion_iterations, step(one).free_motion_iterations) << "at rest";
}

// A thin plate folded over a ball. (tests/bench/test_folded_rest.cpp has the body that needs
// relaxation.)
World folding_plate(ContactMethod method) {
  const auto plate = make_body(box_mesh({10, 6, 1}, {-0.15, -0.09, -0.01}, {0.3, 0.18, 0.02}),
                               material_of(4e3, 0.4, 1000, 0.5, 0.02), 0.01);
  WorldSettings settings;
  settings.contact_method = method;
  World world = make_world(settings);
  add_soft(world, plate, {0.01, 0.005, 0.1});
  add_plane(world);
  add_sphere(world, 0.04, {0, 0, 0.04});
  return world;
}

// What warping adds to the momentum or takes from it is given back in the steps after.
TEST(WarpedMotion, KeepsTheMomentumThatContactForcesGive) {
  constexpr double h = 0.01;
  World world = folding_plate(ContactMethod::warped);
  const CorotationalModel& model = world.asset({0}).model();
  const auto momentum = [&] {
    Vec3 sum = Vec3::Zero();
    for (Index node = 0; node < model.node_count(); ++node)
      sum += model.masses()[node] * as_vec3(world.velocities({0})[std::size_t(node)]);
    return sum;
  };
  const Vec3 before = momentum();
  Vec3 impulse = Vec3::Zero();
  double pushed = 0;
  for (int k = 0; k < 300; ++k) {
    step(world);
    const Vec3 damping = model.rayleigh_mass_per_s() * momentum();
    impulse += h * (model.total_mass() * Vec3(0, 0, -9.81) - damping);
    for (const ContactRecord& contact : world.contacts()) {
      impulse += h * as_vec3(contact.force_n);
      pushed += h * as_vec3(contact.force_n).norm();
    }
  }
  EXPECT_LT((momentum() - before - impulse).norm(), 1e-6 * pushed);
}

TEST(WarpedRest, StaysWhereTheExactMethodCameToRest) {
  World exact = folding_plate(ContactMethod::exact), warped = folding_plate(ContactMethod::warped);
  for (int k = 0; k < 300; ++k) step(exact);
  ASSERT_TRUE(warped.copy_state(exact).ok());
  for (int k = 0; k < 300; ++k) {
    step(exact);
    step(warped);
  }
  const std::vector<Point> a(exact.positions({0}).begin(), exact.positions({0}).end());
  const std::vector<Point> b(warped.positions({0}).begin(), warped.positions({0}).end());
  EXPECT_LT(distance(a, b), 1e-3 * 0.03) << "0.1 % of a deformation of some centimetres";
}

TEST(ContactPasses, ChangeNothingForTheExactCompliance) {
  const auto one = bent_impact(ContactMethod::exact, 1), three = bent_impact(ContactMethod::exact, 3);
  EXPECT_LT(distance(one, three), 1e-6);
}

}  // namespace
}  // namespace souple
