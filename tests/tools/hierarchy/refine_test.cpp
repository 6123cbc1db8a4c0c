// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/hierarchy/refine.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "tools/geometry/vector.hpp"

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

TEST(RefineRed, SplitsAnyTetIntoEightEqualPositiveVolumes) {
  std::mt19937 random(5);
  for (int i = 0; i < 200; ++i) {
    const TetMesh coarse = random_tet(random);
    const RefinedMesh fine = refine_red(coarse);
    ASSERT_EQ(fine.mesh.tets.size(), 8u);
    ASSERT_EQ(fine.mesh.nodes.size(), 10u);
    for (const Tet& child : fine.mesh.tets)
      EXPECT_NEAR(volume6(fine.mesh, child) * 8 / volume6(coarse, coarse.tets[0]), 1, 1e-9);
    EXPECT_EQ(boundary_triangles(fine.mesh.tets).size(), 16u);
  }
}

TEST(RefineRed, TakesTheShortestOfAllThreeDiagonals) {
  std::mt19937 random(9);
  int kinds[3] = {0, 0, 0};
  for (int i = 0; i < 100; ++i) {
    const RefinedMesh fine = refine_red(random_tet(random));
    // Midpoints of opposite edges sum to opposite parents; find the pair that is joined inside.
    const auto parents_are_opposite = [&](std::size_t a, std::size_t b) {
      const auto &p = fine.parents[a], &q = fine.parents[b];
      return p[0] != q[0] && p[0] != q[1] && p[1] != q[0] && p[1] != q[1];
    };
    double lengths[3];
    int pair = 0, joined = -1;
    for (std::size_t a = 4; a < 10; ++a)
      for (std::size_t b = a + 1; b < 10; ++b) {
        if (!parents_are_opposite(a, b)) continue;
        lengths[pair] = norm(subtract(fine.mesh.nodes[a], fine.mesh.nodes[b]));
        for (const Tet& t : fine.mesh.tets) {
          const bool has_a = std::ranges::find(t, static_cast<Index>(a)) != t.end();
          const bool has_b = std::ranges::find(t, static_cast<Index>(b)) != t.end();
          if (has_a && has_b) joined = pair;
        }
        ++pair;
      }
    ASSERT_EQ(pair, 3);
    ASSERT_GE(joined, 0);
    for (const double length : lengths) EXPECT_LE(lengths[joined], length);
    ++kinds[joined];
  }
  for (const int count : kinds) EXPECT_GT(count, 0);
}

}  // namespace
}  // namespace souple
