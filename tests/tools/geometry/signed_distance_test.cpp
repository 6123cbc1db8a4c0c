// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/geometry/signed_distance.hpp"

#include <gtest/gtest.h>

#include <random>

#include "tests/tools/real_surface.hpp"
#include "tools/geometry/surface_measure.hpp"
#include "tools/geometry/vector.hpp"
#include "tools/geometry/winding_number.hpp"

namespace souple {
namespace {

/// Outward cube [low, low + side]^3.
TriangleMesh cube(const Point& low, double side) {
  TriangleMesh mesh;
  for (int i = 0; i < 8; ++i)
    mesh.vertices.push_back(
        {low[0] + side * (i & 1), low[1] + side * (i >> 1 & 1), low[2] + side * (i >> 2 & 1)});
  mesh.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                    {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return mesh;
}

void append(TriangleMesh& mesh, const TriangleMesh& other, bool turned) {
  const auto shift = static_cast<Index>(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), other.vertices.begin(), other.vertices.end());
  for (Triangle t : other.triangles) {
    for (Index& i : t) i += shift;
    if (turned) std::swap(t[0], t[1]);
    mesh.triangles.push_back(t);
  }
}

std::vector<Point> points_around(const TriangleMesh& mesh, int count) {
  const Box box = bounding_box(mesh.vertices);
  const double margin = 0.2 * longest_side(box);
  std::mt19937 random(1);
  std::uniform_real_distribution<double> unit(0, 1);
  std::vector<Point> points;
  for (int i = 0; i < count; ++i) {
    Point& p = points.emplace_back();
    for (std::size_t k = 0; k < 3; ++k)
      p[k] = box.low[k] - margin + unit(random) * (box.high[k] - box.low[k] + 2 * margin);
  }
  return points;
}

TEST(SignedDistance, IsNegativeInsideAndExactForACube) {
  const SignedDistance distance(cube({-1, -1, -1}, 2));
  EXPECT_NEAR(distance.distance({0, 0, 0.25}), -0.75, 1e-14);
  EXPECT_NEAR(distance.distance({3, 0, 0}), 2, 1e-14);
  EXPECT_NEAR(distance.distance({2, 2, 2}), std::sqrt(3), 1e-14);
  EXPECT_NEAR(std::abs(distance.distance({1, 0.3, 0.2})), 0, 1e-14);
  EXPECT_TRUE(distance.contains({0.999999, 0.999999, 0.999999}));
  EXPECT_FALSE(distance.contains({1.000001, 0.999999, 0.999999}));
}

TEST(SignedDistance, SeesACavityAsOutside) {
  TriangleMesh mesh = cube({-2, -2, -2}, 4);
  append(mesh, cube({-1, -1, -1}, 2), true);
  const SignedDistance distance(mesh);
  EXPECT_NEAR(distance.distance({0, 0, 0.25}), 0.75, 1e-14);
  EXPECT_NEAR(distance.distance({0, 0, 1.25}), -0.25, 1e-14);
}

TEST(SignedDistance, SeesTheOverlapOfTwoShellsAsInside) {
  TriangleMesh mesh = cube({0, 0, 0}, 2);
  append(mesh, cube({1, 1, 1}, 2), false);
  const SignedDistance distance(mesh);
  EXPECT_TRUE(distance.contains({1.5, 1.5, 1.5}));
  EXPECT_TRUE(distance.contains({0.5, 0.5, 0.5}));
  EXPECT_TRUE(distance.contains({2.5, 2.5, 2.5}));
  EXPECT_FALSE(distance.contains({2.5, 0.5, 0.5}));
}

TEST(SignedDistance, OfNothingIsInfinitelyFar) {
  const SignedDistance distance(TriangleMesh{});
  EXPECT_FALSE(distance.contains({0, 0, 0}));
  EXPECT_EQ(distance.distance({0, 0, 0}), HUGE_VAL);
}

TEST(SignedDistance, OfNoNumberIsNotInside) {
  const SignedDistance distance(cube({0, 0, 0}, 1));
  EXPECT_FALSE(distance.contains({std::nan(""), 0.5, 0.5}));
  EXPECT_FALSE(distance.contains({HUGE_VAL, 0.5, 0.5}));
}

TEST(WindingNumber, IsAWholeNumberAroundRealSurfaces) {
  SOUPLE_NEEDS_REAL_SURFACES();
  for (const char* name : {"liver-smooth.obj", "dino.off", "cheese.off", "anchor.off"}) {
    const TriangleMesh surface = closed_real_surface(name);
    const WindingNumber winding(surface);
    const TriangleBvh triangles(surface);
    double worst = 0;
    for (const Point& p : points_around(surface, 20'000)) {
      if (triangles.closest(p).squared_distance < 1e-14) continue;
      const double w = winding.at(p);
      worst = std::max(worst, std::abs(w - std::round(w)));
    }
    EXPECT_LT(worst, 0.1) << name;
  }
}

TEST(SignedDistance, AgreesWithTheVolume) {
  SOUPLE_NEEDS_REAL_SURFACES();
  const TriangleMesh surface = closed_real_surface("dino.off");
  const SignedDistance distance(surface);
  const Box box = bounding_box(surface.vertices);
  double whole = 1;
  for (std::size_t k = 0; k < 3; ++k) whole *= box.high[k] - box.low[k] + 0.08;
  const int count = 40'000;
  int inside = 0;
  for (const Point& p : points_around(surface, count)) inside += distance.contains(p) ? 1 : 0;
  const double share = signed_volume(surface) / whole;
  // Four standard deviations of a count by chance.
  EXPECT_NEAR(inside / double{count}, share, 4 * std::sqrt(share * (1 - share) / count));
}

}  // namespace
}  // namespace souple
