// SPDX-License-Identifier: MIT
// Dirichlet nodes along a path: prescribed exactly, felt by the others through the right side.
#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "tests/support/allocation_count.hpp"
#include "tests/support/box_mesh.hpp"
#include "tests/support/dense_compliance.hpp"
#include "tests/support/scenes.hpp"

namespace souple {
namespace {

using namespace test;

TetMesh bar() { return box_mesh({6, 2, 2}, {0, -0.025, -0.025}, {0.2, 0.05, 0.05}); }

FixedSet nodes_where(const TetMesh& mesh, const std::string& name, auto&& chosen) {
  FixedSet set{name, {}};
  for (std::size_t n = 0; n < mesh.nodes.size(); ++n)
    if (chosen(mesh.nodes[n])) set.nodes.push_back(Index(n));
  return set;
}

std::vector<FixedSet> sets_of(const TetMesh& mesh) {
  return {nodes_where(mesh, "left", [](const Point& p) { return p[0] == 0; }),
          nodes_where(mesh, "right", [](const Point& p) { return p[0] > 0.1999; }),
          nodes_where(mesh, "ends", [](const Point& p) { return p[0] == 0 || p[0] > 0.1999; })};
}

std::shared_ptr<const SoftBodyAsset> bar_body(const std::string& fixed, double beta = 0.02) {
  const TetMesh mesh = bar();
  return make_body(mesh, material_of(1e5, 0.3, 1000, 0.1, beta), 0.01, sets_of(mesh), fixed);
}

std::vector<Keyframe> full_turn(const Vec3& axis, double seconds) {
  std::vector<Keyframe> path;
  for (int k = 0; k <= 8; ++k)
    path.push_back({seconds * k / 8, pose_of(turned(45 * k, axis), Vec3::Zero())});
  return path;
}

BodyId add_driven(World& world, const std::string& fixed, std::vector<DrivenSet> driven) {
  SoftBodyDescription description;
  description.name = "bar";
  description.fixed_set = fixed;
  description.driven = std::move(driven);
  const auto body = world.add_soft_body(bar_body(fixed), description);
  EXPECT_TRUE(body.ok()) << (body.ok() ? "" : format_issue(body.issue()));
  return *body;
}

TEST(DrivenNodes, GoThroughAFullTurnExactlyAndTheBodyWithThem) {
  for (const Integrator integrator : {Integrator::implicit_euler, Integrator::bdf2}) {
    WorldSettings settings;
    settings.integrator = integrator;
    settings.contact_method = ContactMethod::exact;
    settings.gravity_m_s2 = {0, 0, 0};
    World world = make_world(settings);
    const BodyId body = add_driven(world, "left", {{"left", full_turn({0, 1, 0}, 2)}});
    const auto rest = world.asset(body).model().rest_positions();
    const FixedSet& left = *world.asset(body).find_fixed_set("left");
    double largest_strain = 0;
    for (int k = 1; k <= 200; ++k) {
      largest_strain = std::max(largest_strain, step(world).elastic_energy_j);
      // The keyframes are an even turn: slerp between them is the same as the angle itself.
      const Mat3 turn = turned(1.8 * k, {0, 1, 0});
      for (const Index n : left.nodes)
        ASSERT_LT(
            (as_vec3(world.positions(body)[std::size_t(n)]) - turn * as_vec3(rest[std::size_t(n)]))
                .norm(),
            1e-14)
            << k;
    }
    EXPECT_GT(largest_strain, 1e-7) << "its inertia bends it";
    StepReport report;
    for (int k = 0; k < 400; ++k) report = step(world);
    EXPECT_LT(report.elastic_energy_j + report.kinetic_energy_j, 1e-9 * largest_strain);
    for (std::size_t n = 0; n < rest.size(); ++n)
      EXPECT_LT((as_vec3(world.positions(body)[n]) - as_vec3(rest[n])).norm(), 1e-6);
  }
}

TEST(DrivenNodes, PullTheOthersAsTheDenseSystemSays) {
  const TetMesh mesh = bar();
  const Material material = material_of(1e5, 0.3, 1000, 0.1, 0.02);
  WorldSettings settings;
  settings.gravity_m_s2 = {0, 0, 0};
  settings.free_motion.tolerance = 1e-13;
  World world = make_world(settings);
  const Vec3 shift(1e-3, -2e-3, 5e-4);
  const BodyId body =
      add_driven(world, "ends", {{"right", {{0, {}}, {0.01, pose_of(turned(2, {1, 0, 0}), shift)}}}});
  step(world);
  // A = M/h^2 + B/h + K in the rest shape, from B^T D B; the left end stands, the right one is moved.
  const double h = 0.01;
  Eigen::MatrixXd a = (1 + 0.02 / h) * dense_stiffness(mesh, 1e5, 0.3);
  const Eigen::VectorXd masses = lumped_masses(mesh, 1000);
  for (Eigen::Index i = 0; i < a.rows(); ++i) a(i, i) += (1 / (h * h) + 0.1 / h) * masses[i / 3];
  const auto sets = sets_of(mesh);
  Eigen::VectorXd dx = Eigen::VectorXd::Zero(a.rows());
  for (const Index n : sets[1].nodes)
    dx.segment<3>(3 * n) = turned(2, {1, 0, 0}) * as_vec3(mesh.nodes[std::size_t(n)]) + shift -
                           as_vec3(mesh.nodes[std::size_t(n)]);
  std::vector<Eigen::Index> free;
  for (Eigen::Index i = 0; i < a.rows(); ++i)
    if (std::ranges::find(sets[2].nodes, Index(i / 3)) == sets[2].nodes.end()) free.push_back(i);
  const Eigen::VectorXd right = -(a * dx)(free);
  const Eigen::MatrixXd part = a(free, free);
  const Eigen::VectorXd solved = part.llt().solve(right);
  for (std::size_t k = 0; k < free.size(); ++k) dx[free[k]] = solved[Eigen::Index(k)];
  for (std::size_t n = 0; n < mesh.nodes.size(); ++n)
    EXPECT_LT((as_vec3(world.positions(body)[n]) - as_vec3(mesh.nodes[n]) -
               dx.segment<3>(3 * Eigen::Index(n)))
                  .norm(),
              1e-10)
        << n;
}

TEST(DrivenNodes, PushAnotherSoftBodyThroughContact) {
  WorldSettings settings;
  settings.gravity_m_s2 = {0, 0, 0};
  World world = make_world(settings);
  // A ram whose every node is driven but those of its middle.
  add_driven(world, "ends",
             {{"left", {{0, {}}, {1, pose_of(Mat3::Identity(), {0.2, 0, 0})}}},
              {"right", {{0, {}}, {1, pose_of(Mat3::Identity(), {0.2, 0, 0})}}}});
  const auto block = make_body(box_mesh({2, 2, 2}, {0, 0, 0}, {0.06, 0.061, 0.063}),
                               material_of(1e4, 0.3, 1000, 0, 0.01), 0.01);
  const BodyId pushed = add_soft(world, block, {0.201, -0.03, -0.03});
  double worst = 0;
  for (int k = 0; k < 100; ++k) worst = std::max(worst, step(world).worst_penetration_m);
  EXPECT_LT(worst, 2e-4);
  EXPECT_GT(mean_velocity(world, pushed).x(), 0.19);
  EXPECT_LT(mean_velocity(world, pushed).x(), 0.3);
}

TEST(DrivenNodes, StepAllocatesNothing) {
  World world = make_world(WorldSettings{});
  add_driven(world, "ends", {{"right", full_turn({1, 0, 0}, 2)}});
  for (int k = 0; k < 3; ++k) step(world);
  const std::size_t before = allocation_count();
  for (int k = 0; k < 20; ++k) ASSERT_TRUE(world.step().ok());
  EXPECT_EQ(allocation_count() - before, 0u);
}

TEST(DrivenNodes, RefuseWhatCannotBeDriven) {
  World world = make_world(WorldSettings{});
  const auto refused = [&](std::vector<DrivenSet> driven) {
    SoftBodyDescription description;
    description.fixed_set = "left";
    description.driven = std::move(driven);
    const auto body = world.add_soft_body(bar_body("left"), description);
    return !body && body.issue().code == IssueCode::driven_nodes_invalid;
  };
  const std::vector<Keyframe> still{{0, {}}};
  EXPECT_TRUE(refused({{"nowhere", still}}));
  EXPECT_TRUE(refused({{"right", still}})) << "not fixed";
  EXPECT_TRUE(refused({{"left", still}, {"left", still}}));
  EXPECT_TRUE(refused({{"left", {}}}));
  EXPECT_TRUE(refused({{"left", {{0, {}}, {0, {}}}}}));
  EXPECT_TRUE(refused({{"left", {{NAN, {}}}}}));
  EXPECT_TRUE(refused({{"left", {{0, pose_of(Mat3::Identity(), {NAN, 0, 0})}}}}));
  EXPECT_EQ(world.body_count(), 0u);
}

}  // namespace
}  // namespace souple
