// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <random>

#include "runtime/collision/rigid_distance.hpp"
#include "runtime/collision/triangle_distance.hpp"

namespace souple {
namespace {

std::mt19937 random_engine(11);

Vec3 random_point(double size) {
  std::uniform_real_distribution<double> uniform(-size, size);
  return {uniform(random_engine), uniform(random_engine), uniform(random_engine)};
}

TEST(ClosestOnTriangle, BeatsEveryPointOfAFineGrid) {
  for (int k = 0; k < 300; ++k) {
    const Vec3 a = random_point(1), b = random_point(1), c = random_point(1), p = random_point(2);
    const auto found = closest_on_triangle(p, a, b, c);
    const Vec3 rebuilt = found.weight[0] * a + found.weight[1] * b + found.weight[2] * c;
    EXPECT_LT((rebuilt - found.point).norm(), 1e-12);
    EXPECT_NEAR(found.weight[0] + found.weight[1] + found.weight[2], 1, 1e-12);
    for (const double w : found.weight) EXPECT_GE(w, -1e-12);
    const double distance = (p - found.point).norm();
    double best = 1e9;
    for (int i = 0; i <= 100; ++i)
      for (int j = 0; i + j <= 100; ++j)
        best = std::min(best, (p - (a + i / 100.0 * (b - a) + j / 100.0 * (c - a))).norm());
    EXPECT_LE(distance, best + 1e-12);
    EXPECT_NEAR(distance, best, 0.03);
  }
}

TEST(ClosestOnTriangle, NamesTheFeature) {
  const Vec3 a(0, 0, 0), b(1, 0, 0), c(0, 1, 0);
  EXPECT_EQ(closest_on_triangle({-1, -1, 1}, a, b, c).feature, 0);
  EXPECT_EQ(closest_on_triangle({2, -0.5, 0}, a, b, c).feature, 1);
  EXPECT_EQ(closest_on_triangle({-0.5, 2, 0}, a, b, c).feature, 2);
  EXPECT_EQ(closest_on_triangle({0.5, -1, 0.3}, a, b, c).feature, 3);
  EXPECT_EQ(closest_on_triangle({1, 1, 0.3}, a, b, c).feature, 4);
  EXPECT_EQ(closest_on_triangle({-1, 0.5, 0.3}, a, b, c).feature, 5);
  EXPECT_EQ(closest_on_triangle({0.2, 0.2, 0.3}, a, b, c).feature, 6);
}

TEST(SignedDistance, IsADistanceWithAUnitGradientAlongItsNormal) {
  Pose pose;
  const double c = std::cos(0.4), s = std::sin(0.4) / std::sqrt(3.0);
  pose.rotation = {c, s, s, s};
  pose.translation = {0.1, -0.2, 0.3};
  const RigidPlacement at = placement(pose);
  RigidShape plane, sphere, box;
  sphere.kind = RigidShapeKind::sphere;
  sphere.radius_m = 0.4;
  box.kind = RigidShapeKind::box;
  box.half_extents_m = {0.3, 0.2, 0.5};
  for (const RigidShape& shape : {plane, sphere, box})
    for (int k = 0; k < 500; ++k) {
      const Vec3 p = random_point(1);
      const auto here = signed_distance(shape, at, p);
      EXPECT_NEAR(here.normal.norm(), 1, 1e-12);
      // The foot point lies on the surface, and a step along the normal changes the distance as much.
      EXPECT_NEAR(signed_distance(shape, at, p - here.distance * here.normal).distance, 0, 1e-12);
      if (here.distance <= 0) continue;
      EXPECT_NEAR(signed_distance(shape, at, p + 0.1 * here.normal).distance, here.distance + 0.1,
                  1e-12);
    }
}

TEST(SignedDistance, IsFiniteAtTheCentreOfASphereAndOfABox) {
  RigidShape sphere, box;
  sphere.kind = RigidShapeKind::sphere;
  sphere.radius_m = 2;
  box.kind = RigidShapeKind::box;
  box.half_extents_m = {1, 2, 3};
  EXPECT_EQ(signed_distance(sphere, {}, Vec3::Zero()).distance, -2);
  EXPECT_EQ(signed_distance(box, {}, Vec3::Zero()).distance, -1);
  EXPECT_NEAR(signed_distance(box, {}, Vec3::Zero()).normal.norm(), 1, 0);
}

}  // namespace
}  // namespace souple
