// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/geometry/triangle_bvh.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "tools/geometry/vector.hpp"

namespace souple {
namespace {

Point random_point(std::mt19937& random) {
  std::uniform_real_distribution<double> unit(-1, 1);
  return {unit(random), unit(random), unit(random)};
}

TriangleMesh random_soup(int triangles, std::mt19937& random) {
  TriangleMesh mesh;
  for (int t = 0; t < triangles; ++t) {
    const Point middle = random_point(random);
    for (int k = 0; k < 3; ++k)
      mesh.vertices.push_back(add_scaled(middle, t % 7 == 0 ? 0.0 : 0.2, random_point(random)));
    mesh.triangles.push_back({3 * t, 3 * t + 1, 3 * t + 2});
  }
  return mesh;
}

TEST(TriangleBvh, FindsTheSameNearestTrianglesAsASearchOfAll) {
  std::mt19937 random(7);
  const TriangleMesh mesh = random_soup(300, random);
  const TriangleBvh bvh(mesh);
  for (int q = 0; q < 200; ++q) {
    const Point p = scaled(random_point(random), 2);
    std::vector<std::pair<double, Index>> all;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
      const Point c = closest_point_on_triangle(p, mesh.vertices[3 * t], mesh.vertices[3 * t + 1],
                                                mesh.vertices[3 * t + 2]);
      all.emplace_back(squared_norm(subtract(c, p)), static_cast<Index>(t));
    }
    std::ranges::sort(all);
    std::array<ClosestPoint, 5> nearest;
    ASSERT_EQ(bvh.nearest(p, nearest), nearest.size());
    for (std::size_t k = 0; k < nearest.size(); ++k) {
      EXPECT_EQ(nearest[k].triangle, all[k].second);
      EXPECT_EQ(nearest[k].squared_distance, all[k].first);
    }
  }
}

TEST(TriangleBvh, ClosestPointBeatsEverySampleOfTheTriangle) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> unit(0, 1);
  for (int i = 0; i < 300; ++i) {
    const Point a = random_point(random), b = random_point(random), c = random_point(random);
    const Point p = scaled(random_point(random), 2);
    const double best = norm(subtract(closest_point_on_triangle(p, a, b, c), p));
    for (int s = 0; s < 50; ++s) {
      double u = unit(random), v = unit(random);
      if (u + v > 1) {
        u = 1 - u;
        v = 1 - v;
      }
      const Point x = add_scaled(add_scaled(a, u, subtract(b, a)), v, subtract(c, a));
      EXPECT_GE(norm(subtract(x, p)), best - 1e-12);
    }
  }
}

TEST(TriangleBvh, SurvivesDegenerateTrianglesAndTooManyAsked) {
  const TriangleBvh bvh({{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}, {{0, 1, 2}, {0, 0, 0}}});
  std::array<ClosestPoint, 3> nearest;
  EXPECT_EQ(bvh.nearest({1, 1, 0}, nearest), 2u);
  EXPECT_EQ(nearest[0].point, (Point{1, 0, 0}));
  EXPECT_EQ(bvh.closest({3, 0, 0}).point, (Point{2, 0, 0}));
  EXPECT_EQ(TriangleBvh(TriangleMesh{}).closest({0, 0, 0}).triangle, -1);
}

}  // namespace
}  // namespace souple
