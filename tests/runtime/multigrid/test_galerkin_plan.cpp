// SPDX-License-Identifier: MIT
#include "runtime/multigrid/galerkin_plan.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>

#include "tests/runtime/multigrid/galerkin_problem.hpp"
#include "tests/support/allocation_count.hpp"

namespace souple {
namespace {

using namespace test;

void expect_galerkin(const Problem& problem) {
  const GalerkinPlan plan = GalerkinPlan::create(problem.model.pattern(), problem.p);
  const BlockMatrixF coarse = replayed(plan, problem.fine);
  const Eigen::MatrixXd p = dense(problem.p);
  const Eigen::MatrixXd expected = p.transpose() * dense(problem.fine) * p;
  const Eigen::MatrixXd actual = dense(coarse);
  EXPECT_LE((actual - expected).cwiseAbs().maxCoeff(), 1e-6 * expected.cwiseAbs().maxCoeff());
  EXPECT_EQ(actual, actual.transpose());
  EXPECT_EQ(actual.llt().info(), Eigen::Success);
}

TEST(GalerkinPlan, EqualsTheExplicitProductOnNestedLevels) { expect_galerkin(nested()); }

TEST(GalerkinPlan, EqualsTheExplicitProductOnEmbeddedLevels) { expect_galerkin(embedded()); }

TEST(GalerkinPlan, EqualsTheExplicitProductWithFixedNodes) {
  for (Problem problem : {nested(), embedded()}) {
    problem.fine.pattern = &problem.model.pattern();
    problem.fix({0, 5, 6, 30, 31});
    expect_galerkin(problem);
  }
}

TEST(GalerkinPlan, FixedNodesChangeNothingOfWhatMoves) {
  Problem problem = embedded();
  const std::vector<Index> fixed{2, 3, 40};
  const Prolongation moving = without_rows(problem.p, fixed);
  const GalerkinPlan plan = GalerkinPlan::create(problem.model.pattern(), moving);
  const BlockMatrixF before = replayed(plan, problem.fine);
  problem.fix(fixed);
  const BlockMatrixF after = replayed(plan, problem.fine);
  EXPECT_EQ(before.values, after.values);
}

TEST(GalerkinPlan, CoarseNodesWithoutFineOnesGetTheIdentity) {
  Problem problem = nested();
  // Everything that hangs on coarse node 0 is fixed.
  std::vector<Index> fixed;
  for (Index i = 0; i < problem.p.fine_count(); ++i)
    for (Index k = problem.p.row_begin[std::size_t(i)]; k < problem.p.row_begin[std::size_t(i) + 1];
         ++k)
      if (problem.p.column[std::size_t(k)] == 0) fixed.push_back(i);
  problem.fix(fixed);
  const GalerkinPlan plan = GalerkinPlan::create(problem.model.pattern(), problem.p);
  const BlockMatrixF coarse = replayed(plan, problem.fine);
  ASSERT_EQ(plan.coarse_pattern().row_begin[1], 1);
  EXPECT_EQ(coarse.block(0), (Eigen::Matrix3f::Identity()));
  EXPECT_EQ(dense(coarse).llt().info(), Eigen::Success);
}

TEST(GalerkinPlan, NestedPatternIsThatOfTheCoarseMesh) {
  const Problem problem = nested();
  const GalerkinPlan plan = GalerkinPlan::create(problem.model.pattern(), problem.p);
  const MeshLevel coarse = coarse_box();
  const BlockPattern expected = build_block_pattern(Index(coarse.mesh.nodes.size()), coarse.mesh.tets);
  EXPECT_EQ(plan.coarse_pattern().row_begin, expected.row_begin);
  EXPECT_EQ(plan.coarse_pattern().column, expected.column);
  EXPECT_EQ(plan.coarse_pattern().diagonal, expected.diagonal);
}

/// Restricting twice is restricting by the product of the two prolongations.
TEST(GalerkinPlan, ThreeLevelsEqualTheProductOverBoth) {
  const Problem fine(test::nested_box({4, 2, 2}, origin, box),
                     level_of(test::box_mesh({4, 2, 2}, origin, box)));
  const Prolongation below = prolongation_of(test::nested_box({2, 1, 1}, origin, box),
                                             level_of(test::box_mesh({2, 1, 1}, origin, box)))
                                 .value();
  const GalerkinPlan first = GalerkinPlan::create(fine.model.pattern(), fine.p);
  const GalerkinPlan second = GalerkinPlan::create(first.coarse_pattern(), below);
  const BlockMatrixF coarse = replayed(second, replayed(first, fine.fine));
  const Eigen::MatrixXd p = dense(fine.p) * dense(below);
  const Eigen::MatrixXd expected = p.transpose() * dense(fine.fine) * p;
  EXPECT_LE((dense(coarse) - expected).cwiseAbs().maxCoeff(), 1e-6 * expected.cwiseAbs().maxCoeff());
}

TEST(GalerkinPlan, ReplayRepeatsItsBitsAndAllocatesNothing) {
  const Problem problem = embedded();
  const GalerkinPlan plan = GalerkinPlan::create(problem.model.pattern(), problem.p);
  const BlockMatrixF first = replayed(plan, problem.fine);
  BlockMatrixF second(plan.coarse_pattern());
  const std::size_t before = test::allocation_count();
  plan.replay(problem.fine, second);
  EXPECT_EQ(test::allocation_count(), before);
  EXPECT_EQ(first.values, second.values);
}

/// A fan: many tets share an edge, so that its rows have more coarse nodes than a piece has slots.
TEST(GalerkinPlan, CutsRowsOfManyNeighbours) {
  constexpr Index spokes = 150;
  TetMesh mesh;
  mesh.nodes = {{0, 0, -0.1}, {0, 0, 0.1}};
  for (Index k = 0; k < spokes; ++k) {
    const double angle = 2 * 3.14159265358979 * k / spokes;
    mesh.nodes.push_back({0.1 * std::cos(angle), 0.1 * std::sin(angle), 0});
    mesh.tets.push_back({0, 2 + k, 2 + (k + 1) % spokes, 1});
  }
  const MeshLevel fine = level_of(mesh);
  MeshLevel tied = fine;
  for (Index i = 0; i < 2 + spokes; ++i) tied.parents.push_back({i, i});
  Problem problem(tied, fine);
  // Every node hangs on four coarse nodes of its own.
  problem.p = {4 * (2 + spokes), {0}, {}, {}};
  for (Index i = 0; i < 2 + spokes; ++i) {
    for (Index k = 0; k < 4; ++k) {
      problem.p.column.push_back(4 * i + k);
      problem.p.weight.push_back(0.1 * (k + 1));
    }
    problem.p.row_begin.push_back(4 * (i + 1));
  }
  const GalerkinPlan plan = GalerkinPlan::create(problem.model.pattern(), problem.p);
  const Eigen::MatrixXd p = dense(problem.p);
  const Eigen::MatrixXd expected = p.transpose() * dense(problem.fine) * p;
  EXPECT_LE((dense(replayed(plan, problem.fine)) - expected).cwiseAbs().maxCoeff(),
            1e-6 * expected.cwiseAbs().maxCoeff());
}

TEST(GalerkinPlan, NothingToMoveIsTheIdentity) {
  Problem problem = nested();
  std::vector<Index> all(std::size_t(problem.p.fine_count()));
  for (std::size_t i = 0; i < all.size(); ++i) all[i] = Index(i);
  problem.fix(all);
  const GalerkinPlan plan = GalerkinPlan::create(problem.model.pattern(), problem.p);
  const BlockMatrixF coarse = replayed(plan, problem.fine);
  EXPECT_EQ(dense(coarse),
            Eigen::MatrixXd::Identity(3 * problem.p.coarse_count, 3 * problem.p.coarse_count));
}

}  // namespace
}  // namespace souple
