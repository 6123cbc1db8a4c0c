// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include "tests/support/box_mesh.hpp"
#include "tools/recipe/choose_solver.hpp"

namespace souple::test {
namespace {

Asset box(int cells, double young_pa = 1e4) {
  Asset asset;
  asset.levels.push_back(level_of(box_mesh({cells, cells, cells}, {0, 0, 0}, {0.1, 0.1, 0.1})));
  asset.material = material_of(young_pa, 0.4, 1000, 0.1, 0.01);
  return asset;
}

TEST(ChooseSolver, TakesTheFactorForASmallBodyAndACycleForALargeOne) {
  EXPECT_EQ(choose_solver(box(6)).value(), SolverKind::warped_pcg);
  EXPECT_EQ(choose_solver(box(20)).value(), SolverKind::multigrid_pcg);
}

TEST(ChooseSolver, TakesTheDiagonalWhereTheMassRules) {
  EXPECT_EQ(choose_solver(box(12, 1)).value(), SolverKind::jacobi_pcg);
}

TEST(ChooseSolver, SaysTheSameTwice) {
  EXPECT_EQ(choose_solver(box(8)).value(), choose_solver(box(8)).value());
}

}  // namespace
}  // namespace souple::test
