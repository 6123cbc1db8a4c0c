// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "runtime/multigrid/galerkin_plan.hpp"
#include "runtime/multigrid/lattice_level.hpp"
#include "tests/support/box_mesh.hpp"

namespace souple {
namespace {

Point combined(const Prolongation& p, const std::vector<Point>& positions, std::size_t row) {
  Point sum{};
  for (auto k = std::size_t(p.row_begin[row]); k < std::size_t(p.row_begin[row + 1]); ++k)
    for (std::size_t axis = 0; axis < 3; ++axis)
      sum[axis] += p.weight[k] * positions[std::size_t(p.column[k])][axis];
  return sum;
}

/// Positions, and with them every linear motion, come out of P; weights are those of a tet.
void expect_linear(const std::vector<Point>& fine, const LatticeLevel& level) {
  const Prolongation& p = level.prolongation;
  ASSERT_EQ(std::size_t(p.fine_count()), fine.size());
  for (std::size_t row = 0; row < fine.size(); ++row) {
    ASSERT_LE(p.row_begin[row + 1] - p.row_begin[row], 4);
    const Point sum = combined(p, level.positions, row);
    for (std::size_t axis = 0; axis < 3; ++axis) EXPECT_NEAR(sum[axis], fine[row][axis], 1e-6);
    for (auto k = std::size_t(p.row_begin[row]); k < std::size_t(p.row_begin[row + 1]); ++k) {
      EXPECT_GT(p.weight[k], 0);
      EXPECT_LE(p.weight[k], 1);
      if (k > std::size_t(p.row_begin[row])) {
        EXPECT_LT(p.column[k - 1], p.column[k]);
      }
    }
  }
}

const Point box_size{0.2, 0.13, 0.1};

TEST(LatticeLevel, CarriesLinearMotions) {
  const TetMesh mesh = test::irregular_box_mesh({9, 6, 5}, {}, box_size, 1);
  const BlockPattern pattern = build_block_pattern(Index(mesh.nodes.size()), mesh.tets);
  expect_linear(mesh.nodes, lattice_level(pattern, mesh.nodes, {}, {{}, 0.031}));
}

TEST(LatticeLevel, OneOfTwiceTheSpacingIsNestedInIt) {
  const TetMesh mesh = test::irregular_box_mesh({9, 6, 5}, {}, box_size, 1);
  const BlockPattern pattern = build_block_pattern(Index(mesh.nodes.size()), mesh.tets);
  const LatticeLevel fine = lattice_level(pattern, mesh.nodes, {}, {{}, 0.031});
  const GalerkinPlan plan = GalerkinPlan::create(pattern, fine.prolongation);
  const LatticeLevel coarse = lattice_level(plan.coarse_pattern(), fine.positions, {}, {{}, 0.062});
  expect_linear(fine.positions, coarse);
  const Prolongation& p = coarse.prolongation;
  for (std::size_t row = 0; row < fine.positions.size(); ++row) {
    EXPECT_LE(p.row_begin[row + 1] - p.row_begin[row], 2);
    for (auto k = std::size_t(p.row_begin[row]); k < std::size_t(p.row_begin[row + 1]); ++k)
      EXPECT_TRUE(p.weight[k] == 1 || p.weight[k] == 0.5) << p.weight[k];
  }
}

TEST(LatticeLevel, PartsThatDoNotHangTogetherShareNoPoint) {
  TetMesh mesh = test::box_mesh({4, 2, 2}, {}, {0.2, 0.1, 0.049});
  const TetMesh other = test::box_mesh({4, 2, 2}, {0, 0, 0.051}, {0.2, 0.1, 0.049});
  const Index first_other = Index(mesh.nodes.size());
  mesh.nodes.insert(mesh.nodes.end(), other.nodes.begin(), other.nodes.end());
  for (Tet tet : other.tets) {
    for (Index& node : tet) node += first_other;
    mesh.tets.push_back(tet);
  }
  const BlockPattern pattern = build_block_pattern(Index(mesh.nodes.size()), mesh.tets);
  const LatticeLevel level = lattice_level(pattern, mesh.nodes, {}, {{}, 0.08});
  std::vector<int> side(level.positions.size(), -1);
  const Prolongation& p = level.prolongation;
  for (Index row = 0; row < p.fine_count(); ++row)
    for (auto k = std::size_t(p.row_begin[std::size_t(row)]);
         k < std::size_t(p.row_begin[std::size_t(row) + 1]); ++k) {
      int& known = side[std::size_t(p.column[k])];
      const int own = row < first_other ? 0 : 1;
      EXPECT_TRUE(known < 0 || known == own);
      known = own;
    }
}

TEST(LatticeLevel, NodesAtRestHangOnNothing) {
  const TetMesh mesh = test::box_mesh({4, 3, 2}, {}, box_size);
  const BlockPattern pattern = build_block_pattern(Index(mesh.nodes.size()), mesh.tets);
  const std::vector<Index> at_rest{0, 1, 7, Index(mesh.nodes.size()) - 1};
  const LatticeLevel level = lattice_level(pattern, mesh.nodes, at_rest, {{}, 0.09});
  const Prolongation& p = level.prolongation;
  for (Index row = 0; row < p.fine_count(); ++row)
    EXPECT_EQ(p.row_begin[std::size_t(row)] == p.row_begin[std::size_t(row) + 1],
              std::ranges::binary_search(at_rest, row));
  std::vector<bool> is_used(level.positions.size());
  for (const Index column : p.column) is_used[std::size_t(column)] = true;
  EXPECT_EQ(std::ranges::count(is_used, false), 0);
}

}  // namespace
}  // namespace souple
