// SPDX-License-Identifier: MIT
// Plans from a file: the same as those made on the spot, or refused.
#include <gtest/gtest.h>

#include <array>
#include <limits>
#include <type_traits>

#include "runtime/multigrid/level_transitions.hpp"
#include "tests/runtime/multigrid/galerkin_problem.hpp"

namespace souple {
namespace {

using namespace test;

struct Levels {
  MeshLevel coarse, fine;

  LevelTransition stored() const { return store_transitions(std::array{coarse, fine}).value().front(); }
};

std::array<Levels, 2> both_kinds() {
  const MeshLevel small =
      level_of(irregular_box_mesh({2, 2, 1}, {0.005, 0.01, 0.005}, {0.19, 0.13, 0.09}, 1));
  return {Levels{coarse_box(), nested_box({3, 2, 2}, origin, box)},
          Levels{small, embedded_level(irregular_box_mesh({4, 3, 2}, origin, box, 1), small.mesh)}};
}

TEST(StoredPlan, GivesTheSameBitsAsTheOneThatWasMade) {
  for (const Levels& levels : both_kinds()) {
    const Problem problem(levels.fine, levels.coarse);
    const GalerkinPlan made = GalerkinPlan::create(problem.model.pattern(), problem.p);
    const auto opened = GalerkinPlan::open(problem.model.pattern(), levels.stored(), {});
    ASSERT_TRUE(opened.ok()) << format_issue(opened.issue());
    EXPECT_EQ(replayed(*opened, problem.fine).values, replayed(made, problem.fine).values);
    EXPECT_EQ(opened->coarse_pattern().column, made.coarse_pattern().column);
  }
}

TEST(StoredPlan, ChainsOverThreeLevels) {
  const std::array<MeshLevel, 3> levels{level_of(box_mesh({2, 1, 1}, origin, box)),
                                        nested_box({2, 1, 1}, origin, box),
                                        nested_box({4, 2, 2}, origin, box)};
  const Problem problem(levels[2], levels[1]);
  const std::vector<LevelTransition> stored = store_transitions(levels).value();
  ASSERT_EQ(stored.size(), 2U);
  const auto upper = GalerkinPlan::open(problem.model.pattern(), stored[1], {});
  ASSERT_TRUE(upper.ok());
  const auto lower = GalerkinPlan::open(upper->coarse_pattern(), stored[0], {});
  ASSERT_TRUE(lower.ok());
  const Eigen::MatrixXd p = dense(problem.p) * dense(prolongation_of(stored[0]));
  const Eigen::MatrixXd expected = p.transpose() * dense(problem.fine) * p;
  const Eigen::MatrixXd actual = dense(replayed(*lower, replayed(*upper, problem.fine)));
  EXPECT_LE((actual - expected).cwiseAbs().maxCoeff(), 1e-6 * expected.cwiseAbs().maxCoeff());
}

TEST(StoredPlan, LeavesOutFixedNodes) {
  for (const Levels& levels : both_kinds()) {
    Problem problem(levels.fine, levels.coarse);
    std::vector<Index> fixed{0, 7, 12, 13};
    // Nothing that moves hangs on coarse node 1.
    for (Index i = 0; i < problem.p.fine_count(); ++i)
      for (Index k = problem.p.row_begin[std::size_t(i)]; k < problem.p.row_begin[std::size_t(i) + 1];
           ++k)
        if (problem.p.column[std::size_t(k)] == 1) fixed.push_back(i);
    const auto plan = GalerkinPlan::open(problem.model.pattern(), levels.stored(), fixed);
    ASSERT_TRUE(plan.ok());
    problem.fix(fixed);
    const Eigen::MatrixXd p = dense(problem.p);
    Eigen::MatrixXd expected = p.transpose() * dense(problem.fine) * p;
    for (Index a = 0; a < problem.p.coarse_count; ++a)
      if (p.col(3 * a).isZero()) expected.block<3, 3>(3 * a, 3 * a).setIdentity();
    ASSERT_EQ(expected(3, 3), 1);
    const Eigen::MatrixXd actual = dense(replayed(*plan, problem.fine));
    EXPECT_LE((actual - expected).cwiseAbs().maxCoeff(), 1e-6 * expected.cwiseAbs().maxCoeff());
    EXPECT_EQ(actual, actual.transpose());
    EXPECT_EQ(actual.llt().info(), Eigen::Success);
  }
}

TEST(StoredPlan, RefusesFixedNodesThatAreNone) {
  const Levels levels = both_kinds()[0];
  const Problem problem(levels.fine, levels.coarse);
  for (const Index node : {Index{-1}, problem.p.fine_count(), std::numeric_limits<Index>::max()})
    EXPECT_EQ(
        GalerkinPlan::open(problem.model.pattern(), levels.stored(), std::array{node}).issue().code,
        IssueCode::asset_index_out_of_range);
}

/// Changes one number of one list; false where that left it as it was.
bool spoil(LevelTransition& t, unsigned list, std::size_t place, Index value) {
  const LevelTransition before = t;
  const auto set = [&](auto& rows) { rows[place % rows.size()] = value; };
  const auto set_row = [&](auto& rows) {
    auto& number = rows[place / 4 % rows.size()][place % 4];
    number = static_cast<std::remove_reference_t<decltype(number)>>(value);
  };
  if (list == 0) set(t.row_begin);
  if (list == 1) set(t.column);
  if (list == 2) set(t.pattern_begin);
  if (list == 3) set(t.pattern_column);
  if (list == 4) set_row(t.pieces);
  if (list == 5) set_row(t.slots);
  if (list == 6) set_row(t.targets);
  return t != before;
}

/// Whatever index is wrong, near or far: what opens is the plan of its product and no other.
TEST(StoredPlan, IsRefusedWhateverIndexIsWrong) {
  for (const Levels& levels : both_kinds()) {
    const Problem problem(levels.fine, levels.coarse);
    const LevelTransition sound = levels.stored();
    std::mt19937 random(11);
    const Index far[] = {
        -1, std::numeric_limits<Index>::min(), std::numeric_limits<Index>::max(), 1 << 20, 255, 256, 0};
    std::size_t refused = 0;
    for (int round = 0; round < 6000; ++round) {
      LevelTransition bad = sound;
      const Index value = round % 2 == 0 ? far[random() % std::size(far)] : Index(random() % 40);
      const auto list = static_cast<unsigned>(random() % 7);
      if (!spoil(bad, list, random(), value)) continue;
      const auto opened = GalerkinPlan::open(problem.model.pattern(), bad, {});
      if (!opened) {
        EXPECT_EQ(opened.issue().code, IssueCode::asset_multigrid_invalid);
        ++refused;
        continue;
      }
      const GalerkinPlan own = GalerkinPlan::create(problem.model.pattern(), prolongation_of(bad));
      EXPECT_EQ(replayed(*opened, problem.fine).values, replayed(own, problem.fine).values)
          << round << " list " << list;
    }
    EXPECT_GT(refused, 4000U);
  }
}

TEST(StoredPlan, OfAnotherMeshOrCutShortIsRefused) {
  const auto kinds = both_kinds();
  const Problem problem(kinds[0].fine, kinds[0].coarse);
  const auto refused = [&](const LevelTransition& stored) {
    const auto opened = GalerkinPlan::open(problem.model.pattern(), stored, {});
    return !opened && opened.issue().code == IssueCode::asset_multigrid_invalid;
  };
  EXPECT_TRUE(refused(kinds[1].stored()));
  EXPECT_TRUE(refused({}));
  const auto without_last = [&](auto member) {
    LevelTransition cut = kinds[0].stored();
    (cut.*member).pop_back();
    return cut;
  };
  EXPECT_TRUE(refused(without_last(&LevelTransition::row_begin)));
  EXPECT_TRUE(refused(without_last(&LevelTransition::column)));
  EXPECT_TRUE(refused(without_last(&LevelTransition::weight)));
  EXPECT_TRUE(refused(without_last(&LevelTransition::pattern_begin)));
  EXPECT_TRUE(refused(without_last(&LevelTransition::pattern_column)));
  EXPECT_TRUE(refused(without_last(&LevelTransition::pieces)));
  EXPECT_TRUE(refused(without_last(&LevelTransition::slots)));
  EXPECT_TRUE(refused(without_last(&LevelTransition::targets)));
  LevelTransition unsound = kinds[0].stored();
  unsound.weight[3] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(refused(unsound));
}

}  // namespace
}  // namespace souple
