// SPDX-License-Identifier: MIT
// Hierarchies from what an asset stores: the same as those made of its levels, or refused.
#include <gtest/gtest.h>

#include <limits>

#include "runtime/multigrid/level_transitions.hpp"
#include "runtime/multigrid/multigrid_preconditioner.hpp"
#include "runtime/solve/step_solver.hpp"
#include "tests/runtime/multigrid/turned_box.hpp"
#include "tests/support/scenes.hpp"

namespace souple {
namespace {

using namespace test;

struct Stored {
  std::vector<LevelTransition> transitions;
  std::vector<Point> coarsest;
};

Stored stored_levels(const std::vector<MeshLevel>& levels) {
  return {store_transitions(levels).value(), levels.front().mesh.nodes};
}

Result<MultigridHierarchy> opened(const Stored& stored, const BoxProblem& p) {
  return MultigridHierarchy::open(stored.transitions, stored.coarsest, p.model->rest_positions(),
                                  p.model->pattern(), p.fixed);
}

/// Iterations to 1e-8; -1 if it is not reached.
int iterations(MultigridHierarchy hierarchy, const BoxProblem& p) {
  StepSolver solver(Iteration::conjugate_gradient,
                    std::make_unique<MultigridPreconditioner>(
                        std::make_shared<const MultigridHierarchy>(std::move(hierarchy))),
                    p.model->node_count());
  solver.set_system({p.a.get(), {}});
  Eigen::VectorXd x = Eigen::VectorXd::Zero(p.b.size());
  const SolveReport report = solver.solve(p.b, {1e-8, p.b.norm(), 400}, x);
  return report.converged ? report.iterations : -1;
}

void expect_few_iterations(Result<MultigridHierarchy> hierarchy, const BoxProblem& p) {
  ASSERT_TRUE(hierarchy.ok());
  const int count = iterations(std::move(*hierarchy), p);
  EXPECT_GT(count, 0);
  EXPECT_LE(count, 27);
}

Eigen::VectorXd one_cycle(MultigridHierarchy hierarchy, const BoxProblem& p) {
  MultigridPreconditioner cycle(std::make_shared<const MultigridHierarchy>(std::move(hierarchy)));
  EXPECT_TRUE(cycle.update({p.a.get(), {}}));
  Eigen::VectorXd z(p.b.size());
  cycle.apply(p.b, z);
  return z;
}

/// Fixed nodes are not in the plan that is stored; lattices follow below levels that are too large.
TEST(StoredLevels, GiveTheCycleOfTheLevelsThemselves) {
  for (const bool is_clamped : {true, false})
    for (const std::size_t level_count : {2U, 3U}) {
      BoxCase setup;
      setup.is_clamped = is_clamped;
      setup.cells = 8;
      const BoxProblem p = make_problem(setup, level_count);
      auto open = opened(stored_levels(p.levels), p);
      ASSERT_TRUE(open.ok()) << format_issue(open.issue());
      auto made = MultigridHierarchy::create(p.levels, p.model->pattern(), p.fixed).value();
      EXPECT_EQ(open->level_count(), made.level_count());
      const Eigen::VectorXd expected = one_cycle(std::move(made), p);
      const Eigen::VectorXd actual = one_cycle(std::move(*open), p);
      EXPECT_LE((actual - expected).norm(), 1e-5 * expected.norm());
    }
}

TEST(StoredLevels, AFixedPartThatCoversCoarseNodesConvergesAsFast) {
  BoxCase setup;
  setup.cells = 8;
  BoxProblem p = make_problem(setup, 3);
  p.fixed.clear();
  for (Index node = 0; node < p.model->node_count(); ++node)
    if (p.model->rest_positions()[std::size_t(node)][0] < 0.13) p.fixed.push_back(node);
  for (const Index node : p.fixed) node_entry(p.b, node).setZero();
  fix(p.fixed, *p.a);
  expect_few_iterations(opened(stored_levels(p.levels), p), p);
}

TEST(StoredLevels, NoneAreReplacedByLattices) {
  BoxCase setup;
  setup.cells = 8;
  const BoxProblem p = make_problem(setup, 1);
  auto open = opened({}, p);
  ASSERT_TRUE(open.ok());
  EXPECT_GE(open->level_count(), 2U);
  expect_few_iterations(std::move(open), p);
}

TEST(StoredLevels, OfAnotherBodyAreRefused) {
  BoxCase setup;
  setup.cells = 8;
  const BoxProblem p = make_problem(setup, 2);
  setup.cells = 12;
  const auto other = opened(stored_levels(make_problem(setup, 2).levels), p);
  ASSERT_FALSE(other.ok());
  EXPECT_EQ(other.issue().code, IssueCode::asset_multigrid_invalid);
}

TEST(StoredLevels, PositionsThatSpanNoBodyAreRefused) {
  BoxCase setup;
  setup.cells = 8;
  const BoxProblem p = make_problem(setup, 2);
  const auto refused = [&](auto&& spoil) {
    Stored stored = stored_levels(p.levels);
    spoil(stored.coarsest);
    const auto open = opened(stored, p);
    return !open && open.issue().code == IssueCode::asset_multigrid_invalid;
  };
  EXPECT_TRUE(refused([](auto& nodes) { nodes.clear(); }));
  EXPECT_TRUE(refused([](auto& nodes) { nodes.pop_back(); }));
  EXPECT_TRUE(refused([](auto& nodes) { nodes[7][1] = std::numeric_limits<double>::quiet_NaN(); }));
  EXPECT_TRUE(refused([](auto& nodes) { nodes[7][1] = std::numeric_limits<double>::infinity(); }));
  EXPECT_TRUE(refused([](auto& nodes) { nodes[7][1] = 1e300, nodes[8][1] = -1e300; }));
  EXPECT_TRUE(refused([](auto& nodes) { nodes.assign(nodes.size(), nodes.front()); }));
}

/// Far off, but numbers: no level is of use then, and none is needed to go on.
TEST(StoredLevels, PositionsFarOffAreSurvived) {
  BoxCase setup;
  setup.cells = 8;
  const BoxProblem p = make_problem(setup, 2);
  for (const double place : {1e6, 1e100, 1e150, -1e150}) {
    Stored stored = stored_levels(p.levels);
    stored.coarsest[11] = {place, place, place};
    auto open = opened(stored, p);
    ASSERT_TRUE(open.ok());
    EXPECT_GT(iterations(std::move(*open), p), 0) << place;
  }
}

SoftBodyContent content_of(const std::vector<MeshLevel>& levels) {
  SoftBodyContent content;
  content.level = levels.back();
  content.material = material_of(1e4, 0.4, 1000, 0.1, 0.01);
  FixedSet wall{"wall", {}};
  for (std::size_t node = 0; node < content.level.mesh.nodes.size(); ++node)
    if (content.level.mesh.nodes[node][0] == 0) wall.nodes.push_back(Index(node));
  content.fixed_sets.push_back(wall);
  return content;
}

WorldSettings multigrid_settings() {
  WorldSettings settings;
  settings.contact_method = ContactMethod::exact;
  settings.free_motion.solver = SolverKind::multigrid_pcg;
  return settings;
}

TEST(StoredLevels, OfAnAssetAreUsedByTheWorld) {
  const std::vector<MeshLevel> levels = make_problem({}, 2).levels;
  std::vector<std::vector<Point>> shapes;
  for (const bool is_stored : {false, true}) {
    SoftBodyContent content = content_of(levels);
    if (is_stored) content.multigrid = store_transitions(levels).value();
    if (is_stored) content.coarsest_nodes = levels.front().mesh.nodes;
    World world = make_world(multigrid_settings());
    const BodyId body = add_soft(world, SoftBodyAsset::create(std::move(content)).value(), {0, 0, 0},
                                 Mat3::Identity(), {0, 0, 0}, "wall");
    for (int k = 0; k < 10; ++k) EXPECT_EQ(step(world).unconverged_count, 0);
    shapes.emplace_back(world.positions(body).begin(), world.positions(body).end());
  }
  double most = 0;
  for (std::size_t i = 0; i < shapes[0].size(); ++i)
    most = std::max(most, (as_vec3(shapes[0][i]) - as_vec3(shapes[1][i])).norm());
  EXPECT_LE(most, 1e-8);
  EXPECT_GT(most, 0) << "both took the same levels";
}

TEST(StoredLevels, OfAnAssetThatAreUnsoundAreRefusedByTheWorld) {
  const std::vector<MeshLevel> levels = make_problem({}, 2).levels;
  SoftBodyContent content = content_of(levels);
  content.multigrid = store_transitions(levels).value();
  content.multigrid[0].targets.pop_back();
  content.coarsest_nodes = levels.front().mesh.nodes;
  World world = make_world(multigrid_settings());
  const auto added =
      world.add_soft_body(SoftBodyAsset::create(std::move(content)).value(), SoftBodyDescription{});
  ASSERT_FALSE(added.ok());
  EXPECT_EQ(added.issue().code, IssueCode::asset_multigrid_invalid);
}

}  // namespace
}  // namespace souple
