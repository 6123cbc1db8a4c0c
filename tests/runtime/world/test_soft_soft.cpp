// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include "runtime/contact/contact.hpp"
#include "tests/support/box_mesh.hpp"
#include "tests/support/dense_compliance.hpp"
#include "tests/support/scenes.hpp"

namespace souple {
namespace {

using namespace test;

std::shared_ptr<const SoftBodyAsset> cube(int cells, double young = 1e4) {
  return make_body(box_mesh({cells, cells, cells}, {-0.1, -0.1, 0}, {0.2, 0.2, 0.2}),
                   material_of(young, 0.4, 1000, 0.1, 0.01), 0.01);
}

TEST(SoftSoft, StackedCubesComeToRestAndPassTheWeightOn) {
  World world = make_world(WorldSettings{});
  const auto lower_asset = cube(3, 4e4), upper_asset = cube(4, 4e4);  // meshes do not match
  const BodyId lower = add_soft(world, lower_asset, Vec3::Zero());
  const BodyId upper = add_soft(world, upper_asset, {0.01, 0.02, 0.205});
  add_plane(world);
  StepReport report;
  for (int k = 0; k < 1000; ++k) report = step(world);
  const double weight = 9.81 * upper_asset->model().total_mass();
  const double lower_weight = 9.81 * lower_asset->model().total_mass();
  EXPECT_LT((contact_force(world, upper) - Vec3(0, 0, weight)).norm(), 1e-3 * weight);
  EXPECT_LT((contact_force(world, lower) - Vec3(0, 0, lower_weight)).norm(), 1e-3 * weight);
  EXPECT_LT(report.kinetic_energy_j, 1e-6 * weight * 0.2);
  EXPECT_LT(report.worst_penetration_m, 1e-4 * 0.2);
}

TEST(SoftSoft, CollisionKeepsTheMomentumOfThePair) {
  WorldSettings settings;
  settings.gravity_m_s2 = {0, 0, 0};
  settings.free_motion.tolerance = 1e-11;
  World world = make_world(settings);
  const auto asset = make_body(box_mesh({3, 3, 3}, {-0.1, -0.1, -0.1}, {0.2, 0.2, 0.2}),
                               material_of(1e4, 0.4, 1000, 0, 0.005), 0.01);
  const BodyId a = add_soft(world, asset, {-0.15, 0, 0}, turned(10, {0, 1, 1}), {1, 0, 0});
  const BodyId b = add_soft(world, asset, {0.15, 0.03, 0.02}, turned(25, {1, 0, 1}), {-0.5, 0, 0});
  std::size_t active = 0;
  for (int k = 0; k < 60; ++k) active = std::max(active, step(world).active_count);
  EXPECT_GT(active, 2u);
  EXPECT_GT(mean_velocity(world, b).x(), -0.4) << "they did meet";
  // Every contact force acts on both; what is left is the error of warping the rigid part.
  const Vec3 total = mean_velocity(world, a) + mean_velocity(world, b);
  EXPECT_LT((total - Vec3(0.5, 0, 0)).norm(), 0.02);
}

TEST(SoftSoft, OrderOfTheBodiesDoesNotMatter) {
  const auto run = [](bool swapped) {
    World world = make_world(WorldSettings{});
    add_plane(world);
    const auto small = cube(2), large = cube(3);
    BodyId watched{};
    if (swapped) {
      add_soft(world, large, {0.02, 0.01, 0.21});
      watched = add_soft(world, small, Vec3::Zero());
    } else {
      watched = add_soft(world, small, Vec3::Zero());
      add_soft(world, large, {0.02, 0.01, 0.21});
    }
    for (int k = 0; k < 30; ++k) step(world);
    return centre_of_mass(world, watched);
  };
  EXPECT_LT((run(false) - run(true)).norm(), 1e-5);
}

}  // namespace
}  // namespace souple
