// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include "runtime/collision/swept_pairs.hpp"
#include "tests/runtime/collision/collision_bodies.hpp"

namespace souple {
namespace {

using test::CollisionBody;
using test::random_direction;
using test::random_turn;

Vec3 point_of(const SurfacePoint& p, const Eigen::VectorXd& x) {
  Vec3 sum = Vec3::Zero();
  for (int k = 0; k < p.count; ++k) sum += p.weight[k] * node_entry(x, p.node[k]);
  return sum;
}

Eigen::VectorXd moved(const CollisionBody& body, const Vec3& way) {
  return body.x + way.replicate(body.x.size() / 3, 1);
}

std::vector<SweptPair> swept(const CollisionBody& a, const Eigen::VectorXd& a_end,
                             const CollisionBody& b, const Eigen::VectorXd& b_end,
                             double alarm = 0.01) {
  ProximityWork work;
  std::vector<SweptPair> out;
  find_swept_pairs(a.surface, a_end, b.surface, b_end, alarm, work, out);
  return out;
}

RigidShape shape_of(RigidShapeKind kind, double radius, const Point& half, double half_length = 0) {
  RigidShape s;
  s.kind = kind;
  s.radius_m = radius;
  s.half_extents_m = half;
  s.half_length_m = half_length;
  return s;
}

TEST(SweptPairs, AFastThinPlateIsAlwaysStoppedByAThinPlate) {
  std::mt19937 random(31);
  std::uniform_real_distribution<double> uniform(-1, 1);
  CollisionBody still({3, 3, 1}, {1, 1, 0.01}), fast({2, 2, 1}, {0.6, 0.6, 0.01});
  for (int trial = 0; trial < 300; ++trial) {
    const Mat3 tilt = Eigen::AngleAxisd(uniform(random), random_direction(random)).toRotationMatrix();
    still.place(Eigen::AngleAxisd(0.1 * uniform(random), random_direction(random)).toRotationMatrix(),
                Vec3::Zero());
    fast.place(tilt, Vec3(0.3 * uniform(random), 0.3 * uniform(random), 1));
    const Vec3 way(0.2 * uniform(random), 0.2 * uniform(random), -2);
    const auto found = swept(fast, moved(fast, way), still, still.x);
    ASSERT_FALSE(found.empty()) << trial;
    double first = 1;
    for (const SweptPair& p : found) {
      first = std::min(first, p.time);
      const LocalMinimum& m = p.minimum;
      EXPECT_GT(m.gap, 0);
      EXPECT_NEAR(m.normal.norm(), 1, 1e-9);
      // The normal tells the sides apart at the start, and the motion crosses.
      const Vec3 from = point_of(m.a, fast.x) - point_of(m.b, still.x);
      EXPECT_NEAR(from.dot(m.normal), m.gap, 1e-9);
      EXPECT_LT((from + way).dot(m.normal), m.gap);
    }
    // At the first meeting the lowest point of one is at the top of the other: no sooner, no later.
    CollisionBody at_meeting({2, 2, 1}, {0.6, 0.6, 0.01});
    at_meeting.x = moved(fast, first * way);
    at_meeting.surface.refit(at_meeting.x);
    ProximityWork work;
    std::vector<LocalMinimum> near;
    find_local_minima(at_meeting.surface, still.surface, 0.005, 0.1, work, near);
    double least = 1;
    for (const auto& m : near) least = std::min(least, m.gap);
    EXPECT_NEAR(least, 0, 2e-3) << trial;
  }
}

TEST(SweptPairs, TwoBarsThatCrossMeetWithTheirEdges) {
  CollisionBody a({1, 1, 1}, {1, 0.01, 0.01}), b({1, 1, 1}, {0.01, 1, 0.01});
  const Mat3 edge_on_x = Eigen::AngleAxisd(M_PI / 4, Vec3::UnitX()).toRotationMatrix();
  const Mat3 edge_on_y = Eigen::AngleAxisd(M_PI / 4, Vec3::UnitY()).toRotationMatrix();
  a.place(edge_on_x, {0.03, 0.02, 0.5});
  b.place(edge_on_y, Vec3::Zero());
  const auto found = swept(a, moved(a, {0, 0, -1}), b, b.x);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].minimum.a.count, 2);
  EXPECT_EQ(found[0].minimum.b.count, 2);
  EXPECT_NEAR(found[0].minimum.normal.z(), 1, 1e-9);
  EXPECT_NEAR(found[0].time, 0.5 - 0.01 * std::sqrt(2.0), 1e-3);
}

TEST(SweptPairs, BodiesThatStayApartOrPartGiveNone) {
  std::mt19937 random(33);
  CollisionBody a({2, 2, 1}, {1, 1, 0.01}), b({2, 2, 1}, {1, 1, 0.01});
  for (int trial = 0; trial < 50; ++trial) {
    a.place(random_turn(random), {0, 0, 2});
    EXPECT_TRUE(swept(a, moved(a, {5, 0, 0.1}), b, b.x).empty());
    EXPECT_TRUE(swept(a, moved(a, {0, 0, 3}), b, b.x).empty());
    EXPECT_TRUE(swept(a, moved(a, {0, 0, -9}), b, moved(b, {0, 0, -9})).empty());
  }
}

TEST(SweptPairs, PairsThatAreNearAlreadyAreLeftToTheMinima) {
  CollisionBody a({2, 2, 1}, {0.5, 0.5, 0.1}), b({2, 2, 1}, {1, 1, 0.1});
  a.place(Mat3::Identity(), {0, 0, 0.13});
  EXPECT_TRUE(swept(a, moved(a, {0, 0, -0.06}), b, b.x, 0.05).empty());
  EXPECT_FALSE(swept(a, moved(a, {0, 0, -0.06}), b, b.x, 0.02).empty());
}

TEST(SweptShape, ABulletNeitherPassesASoftPlateNorAPlateABullet) {
  std::mt19937 random(35);
  std::uniform_real_distribution<double> uniform(-1, 1);
  CollisionBody plate({1, 1, 1}, {2, 2, 0.01});
  const std::array<RigidShape, 3> bullets = {shape_of(RigidShapeKind::sphere, 0.02, {}),
                                             shape_of(RigidShapeKind::capsule, 0.01, {}, 0.03),
                                             shape_of(RigidShapeKind::box, 0, {0.02, 0.03, 0.01})};
  for (int trial = 0; trial < 300; ++trial) {
    const RigidShape& bullet = bullets[std::size_t(trial % 3)];
    const RigidPlacement start{random_turn(random), {0.8 * uniform(random), 0.8 * uniform(random), 1}};
    RigidPlacement end = start;
    end.translation.z() = -1;
    ProximityWork work;
    std::vector<SweptPair> out;
    find_swept_shape(plate.surface, plate.x, bullet, start, end, 0.01, work, out);
    ASSERT_FALSE(out.empty()) << trial;
    double first = 1;
    for (const SweptPair& p : out) {
      EXPECT_GT(p.minimum.gap, 0);
      first = std::min(first, p.time);
    }
    EXPECT_GT(first, 0.5 - 0.06);
    EXPECT_LT(first, 0.5);
    // The plate moves, the bullet rests.
    out.clear();
    find_swept_shape(plate.surface, moved(plate, {0, 0, 2}), bullet, start, start, 0.01, work, out);
    EXPECT_FALSE(out.empty()) << trial;
  }
}

TEST(SweptShape, VerticesDoNotPassAThinBoxASmallBallOrAPlane) {
  CollisionBody cloud({2, 2, 2}, {0.2, 0.2, 0.2});
  cloud.place(Mat3::Identity(), {0, 0, 1});
  ProximityWork work;
  std::vector<SweptPair> out;
  const auto search = [&](const RigidShape& shape) {
    out.clear();
    find_swept_shape(cloud.surface, moved(cloud, {0, 0, -2}), shape, {}, {}, 0.01, work, out);
    return out.size();
  };
  EXPECT_GE(search(shape_of(RigidShapeKind::box, 0, {1, 1, 1e-3})), 26U);
  for (const SweptPair& p : out) {
    EXPECT_NEAR(p.minimum.normal.z(), 1, 1e-9);
    EXPECT_NEAR(p.minimum.gap, point_of(p.minimum.a, cloud.x).z() - 1e-3, 1e-9);
  }
  EXPECT_GE(search(shape_of(RigidShapeKind::sphere, 1e-3, {})), 1U);
  EXPECT_EQ(search(RigidShape{}), 26U);
}

TEST(SweptShapes, ABulletNeverPassesAThinBox) {
  std::mt19937 random(37);
  std::uniform_real_distribution<double> uniform(-1, 1);
  const RigidShape wall = shape_of(RigidShapeKind::box, 0, {1, 1, 1e-3});
  const std::array<RigidShape, 3> bullets = {shape_of(RigidShapeKind::sphere, 0.005, {}),
                                             shape_of(RigidShapeKind::capsule, 0.004, {}, 0.01),
                                             shape_of(RigidShapeKind::box, 0, {0.01, 0.005, 0.004})};
  ProximityWork work;
  for (int trial = 0; trial < 600; ++trial) {
    const RigidShape& bullet = bullets[std::size_t(trial % 3)];
    const RigidPlacement start{random_turn(random), {0.7 * uniform(random), 0.7 * uniform(random), 2}};
    const RigidPlacement end{random_turn(random), {0.7 * uniform(random), 0.7 * uniform(random), -3}};
    const auto met = find_swept_shapes(bullet, start, end, wall, {}, {}, 0.01, work);
    ASSERT_TRUE(met) << trial;
    EXPECT_NEAR(met->time, 0.4, 0.01);
    EXPECT_GT(met->minimum.normal.z(), 0.9);
    EXPECT_GT(met->minimum.gap, 1.9);
    EXPECT_TRUE(find_swept_shapes(wall, {}, {}, bullet, start, end, 0.01, work)) << trial;
    EXPECT_TRUE(find_swept_shapes(bullet, start, end, RigidShape{}, {}, {}, 0.01, work)) << trial;
    EXPECT_FALSE(find_swept_shapes(bullet, start, start, wall, {}, {}, 0.01, work)) << trial;
  }
}

}  // namespace
}  // namespace souple
