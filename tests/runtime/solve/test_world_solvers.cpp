// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include "tests/support/allocation_count.hpp"
#include "tests/support/box_mesh.hpp"
#include "tests/support/scenes.hpp"

namespace souple {
namespace {

using namespace test;

std::shared_ptr<const SoftBodyAsset> bar() {
  SoftBodyContent content;
  content.level = level_of(box_mesh({10, 3, 3}, {0, 0, 0}, {0.2, 0.06, 0.06}));
  content.material = material_of(1e4, 0.4, 1000, 0.1, 0.01);
  FixedSet wall{"wall", {}};
  for (std::size_t node = 0; node < content.level.mesh.nodes.size(); ++node)
    if (content.level.mesh.nodes[node][0] == 0) wall.nodes.push_back(Index(node));
  content.fixed_sets.push_back(wall);
  auto made = SoftBodyAsset::create(std::move(content));
  EXPECT_TRUE(made.ok());
  return *made;
}

WorldSettings settings_of(SolverKind kind, double tolerance) {
  WorldSettings settings;
  settings.contact_method = ContactMethod::exact;
  settings.free_motion.solver = kind;
  settings.free_motion.tolerance = tolerance;
  settings.free_motion.max_iterations = 5000;
  return settings;
}

Eigen::VectorXd shape_after(int steps, const WorldSettings& settings, const std::string& fixed) {
  World world = make_world(settings);
  const BodyId body = add_soft(world, bar(), {0, 0, 0}, turned(40, {1, 1, 0}), {0.5, 0, 1}, fixed);
  for (int k = 0; k < steps; ++k) EXPECT_EQ(step(world).unconverged_count, 0);
  const auto x = world.positions(body);
  return Eigen::Map<const Eigen::VectorXd>(x[0].data(), Eigen::Index(3 * x.size()));
}

TEST(WorldSolvers, AllGiveTheSameMotion) {
  for (const std::string fixed : {"", "wall"}) {
    const Eigen::VectorXd reference = shape_after(30, settings_of(SolverKind::direct, 1e-12), fixed);
    for (const auto& name : solver_names) {
      SCOPED_TRACE(name.name);
      const Eigen::VectorXd x = shape_after(30, settings_of(name.kind, 1e-8), fixed);
      EXPECT_LT((x - reference).cwiseAbs().maxCoeff(), 1e-7);
    }
  }
}

TEST(WorldSolvers, AStepThatMissesItsToleranceGoesOnOrIsRefusedAsAsked) {
  WorldSettings settings = settings_of(SolverKind::jacobi_pcg, 1e-10);
  settings.free_motion.max_iterations = 2;
  World patient = make_world(settings);
  add_soft(patient, bar(), {0, 0, 0}, Mat3::Identity(), {0, 0, 0}, "wall");
  const StepReport report = step(patient);
  EXPECT_EQ(report.unconverged_count, 1);
  EXPECT_GT(report.free_motion_residual, 1e-10);
  EXPECT_LE(report.free_motion_residual, 1);
  EXPECT_GT(patient.time_s(), 0);

  settings.free_motion.unconverged = UnconvergedStep::refuse;
  World strict = make_world(settings);
  const BodyId body = add_soft(strict, bar(), {0, 0, 0}, Mat3::Identity(), {0, 0, 0}, "wall");
  const std::vector<Point> before(strict.positions(body).begin(), strict.positions(body).end());
  const auto refused = strict.step();
  ASSERT_FALSE(refused.ok());
  EXPECT_EQ(refused.issue().code, IssueCode::solver_not_converged);
  EXPECT_EQ(strict.time_s(), 0);
  EXPECT_TRUE(std::equal(before.begin(), before.end(), strict.positions(body).begin()));
}

TEST(WorldSolvers, StepsAllocateNothing) {
  for (const auto& name : solver_names) {
    SCOPED_TRACE(name.name);
    World world = make_world(settings_of(name.kind, 1e-6));
    add_soft(world, bar(), {0, 0, 0}, turned(20, {0, 1, 0}), {0, 1, 0}, "wall");
    step(world);
    const std::size_t before = allocation_count();
    for (int k = 0; k < 3; ++k) ASSERT_TRUE(world.step().ok());
    EXPECT_EQ(allocation_count(), before);
  }
}

}  // namespace
}  // namespace souple
