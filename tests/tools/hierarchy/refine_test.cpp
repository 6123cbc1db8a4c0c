// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/hierarchy/refine.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <random>
#include <set>

#include "tests/tools/hierarchy/hierarchy_shapes.hpp"
#include "tools/geometry/vector.hpp"
#include "tools/hierarchy/tet_shape.hpp"

namespace souple {
namespace {

double volume6(const TetMesh& mesh, const Tet& tet) {
  const auto x = [&](std::size_t k) { return mesh.nodes[static_cast<std::size_t>(tet[k])]; };
  return signed_volume6(x(0), x(1), x(2), x(3));
}

TetMesh random_tet(std::mt19937& random) {
  std::uniform_real_distribution<double> unit(-1, 1);
  TetMesh mesh{{}, {{0, 1, 2, 3}}};
  for (int k = 0; k < 4; ++k) mesh.nodes.push_back({unit(random), unit(random), unit(random)});
  if (volume6(mesh, mesh.tets[0]) < 0) std::swap(mesh.tets[0][0], mesh.tets[0][1]);
  return mesh;
}

constexpr DiagonalRule rules[] = {DiagonalRule::best_quality, DiagonalRule::shortest,
                                  DiagonalRule::fixed};

double worst_child(const RefinedMesh& fine) {
  double worst = 1;
  for (const Tet& child : fine.mesh.tets) worst = std::min(worst, mean_ratio(child, fine.mesh.nodes));
  return worst;
}

TEST(RefineRed, SplitsAnyTetIntoEightEqualPositiveVolumesByEveryRule) {
  std::mt19937 random(5);
  for (int i = 0; i < 200; ++i)
    for (const DiagonalRule rule : rules) {
      const TetMesh coarse = random_tet(random);
      const RefinedMesh fine = refine_red(coarse, rule);
      ASSERT_EQ(fine.mesh.tets.size(), 8u);
      ASSERT_EQ(fine.mesh.nodes.size(), 10u);
      for (const Tet& child : fine.mesh.tets)
        EXPECT_NEAR(volume6(fine.mesh, child) * 8 / volume6(coarse, coarse.tets[0]), 1, 1e-9);
      EXPECT_EQ(boundary_triangles(fine.mesh.tets).size(), 16u);
    }
}

/// The nodes (4 to 9) that the inner diagonal of a refined tet joins.
std::array<Index, 2> diagonal_of(const RefinedMesh& fine) {
  const Tet &first = fine.mesh.tets[4], &third = fine.mesh.tets[6];
  std::array<Index, 2> ends{-1, -1};
  std::size_t count = 0;
  for (const Index i : first)
    if (std::ranges::find(third, i) != third.end() && count < 2) ends[count++] = i;
  return ends;
}

TEST(RefineRed, TakesTheShortestOfAllThreeDiagonals) {
  std::mt19937 random(9);
  std::set<std::array<Index, 2>> kinds;
  for (int i = 0; i < 100; ++i) {
    const RefinedMesh fine = refine_red(random_tet(random), DiagonalRule::shortest);
    const auto length = [&](std::size_t a, std::size_t b) {
      return norm(subtract(fine.mesh.nodes[a], fine.mesh.nodes[b]));
    };
    const auto [a, b] = diagonal_of(fine);
    const double joined = length(static_cast<std::size_t>(a), static_cast<std::size_t>(b));
    // Midpoints of opposite edges: 01-23, 02-13, 03-12.
    EXPECT_EQ(joined, std::min({length(4, 9), length(5, 8), length(6, 7)}));
    kinds.insert({std::min(a, b), std::max(a, b)});
  }
  EXPECT_EQ(kinds.size(), 3u);
}

TEST(RefineRed, TakesTheThesissDiagonalWhenFixed) {
  std::mt19937 random(2);
  for (int i = 0; i < 50; ++i) {
    const TetMesh coarse = random_tet(random);
    const RefinedMesh fine = refine_red(coarse, DiagonalRule::fixed);
    const Tet& t = coarse.tets[0];
    const auto edge = [](Index a, Index b) { return std::array{std::min(a, b), std::max(a, b)}; };
    const auto [a, b] = diagonal_of(fine);
    EXPECT_EQ(fine.parents[static_cast<std::size_t>(a)], edge(t[0], t[3]));
    EXPECT_EQ(fine.parents[static_cast<std::size_t>(b)], edge(t[1], t[2]));
  }
}

TEST(RefineRed, HasNoBetterWorstChildThanByBestQuality) {
  std::mt19937 random(7);
  bool differs = false;
  for (int i = 0; i < 200; ++i) {
    const TetMesh coarse = random_tet(random);
    const double best = worst_child(refine_red(coarse, DiagonalRule::best_quality));
    for (const DiagonalRule rule : rules) {
      EXPECT_LE(worst_child(refine_red(coarse, rule)), best);
      differs = differs || worst_child(refine_red(coarse, rule)) < 0.9 * best;
    }
  }
  EXPECT_TRUE(differs);
}

TEST(RefineRed, KeepsNeighboursConforming) {
  const TetMesh coarse = kuhn_cube(3);
  for (const DiagonalRule rule : rules) {
    const RefinedMesh fine = refine_red(coarse, rule);
    EXPECT_EQ(boundary_triangles(fine.mesh.tets).size(), 4 * boundary_triangles(coarse.tets).size());
    EXPECT_TRUE(std::ranges::is_sorted(fine.parents.begin() + static_cast<long>(coarse.nodes.size()),
                                       fine.parents.end()));
  }
}

}  // namespace
}  // namespace souple
