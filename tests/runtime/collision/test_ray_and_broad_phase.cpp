// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include "runtime/collision/broad_phase.hpp"
#include "runtime/collision/ray_pick.hpp"
#include "tests/runtime/collision/collision_bodies.hpp"
#include "tests/support/allocation_count.hpp"

namespace souple {
namespace {

using test::CollisionBody;
using test::random_direction;
using test::random_turn;

// Moeller and Trumbore, over all triangles.
std::optional<double> brute_ray(const CollisionBody& body, const Ray& ray) {
  std::optional<double> first;
  for (const Triangle& t : body.level.boundary) {
    Mat3 system;
    const Vec3 a = node_entry(body.x, t[0]);
    system << node_entry(body.x, t[1]) - a, node_entry(body.x, t[2]) - a, -ray.direction;
    const Vec3 solved = system.fullPivLu().solve(ray.origin - a);
    if (solved[0] < 0 || solved[1] < 0 || solved[0] + solved[1] > 1) continue;
    if (solved[2] < 0 || solved[2] > ray.length) continue;
    if (!first || solved[2] < *first) first = solved[2];
  }
  return first;
}

TEST(RayPick, FindsTheFirstTriangleAsBruteForceDoes) {
  std::mt19937 random(41);
  std::uniform_real_distribution<double> uniform(-1, 1);
  CollisionBody body({3, 4, 2}, {1, 1, 1});
  int hits = 0;
  for (int trial = 0; trial < 5000; ++trial) {
    if (trial % 100 == 0) body.deform(random, 0.04, Vec3::Zero());
    Ray ray;
    ray.origin = Vec3(1.5 * uniform(random), 1.5 * uniform(random), 1.5 * uniform(random));
    ray.direction = random_direction(random);
    if (trial % 5 == 0) ray.length = 0.7;
    const auto expected = brute_ray(body, ray);
    const auto found = pick(body.surface, ray);
    ASSERT_EQ(found.has_value(), expected.has_value()) << trial;
    if (!found) continue;
    ++hits;
    EXPECT_NEAR(found->distance, *expected, 1e-11);
    const Triangle& t = body.level.boundary[std::size_t(found->triangle)];
    Vec3 at = Vec3::Zero();
    for (int k = 0; k < 3; ++k) at += found->weight[k] * node_entry(body.x, t[k]);
    EXPECT_LT((at - ray.origin - found->distance * ray.direction).norm(), 1e-11);
    EXPECT_NEAR(std::abs(found->normal.dot(body.surface.face_normal(found->triangle))), 1, 1e-12);
  }
  EXPECT_GT(hits, 500);
}

TEST(RayPick, DoesNotSlipThroughEdgesAndCorners) {
  CollisionBody box({2, 2, 2}, {1, 1, 1});
  for (int i = -2; i <= 2; ++i)
    for (int j = -2; j <= 2; ++j) {
      Ray ray;
      ray.origin = {0.25 * i, 0.25 * j, 3};
      ray.direction = {0, 0, -1};
      const auto hit = pick(box.surface, ray);
      ASSERT_TRUE(hit) << i << " " << j;
      EXPECT_NEAR(hit->distance, 2.5, 1e-12);
    }
}

TEST(RayPick, OfAShapeIsWhereItsSignedDistanceFirstChangesSign) {
  std::mt19937 random(43);
  RigidShape plane, sphere, box, capsule;
  sphere.kind = RigidShapeKind::sphere;
  sphere.radius_m = 0.4;
  box.kind = RigidShapeKind::box;
  box.half_extents_m = {0.3, 0.5, 0.2};
  capsule.kind = RigidShapeKind::capsule;
  capsule.radius_m = 0.2;
  capsule.half_length_m = 0.4;
  int hits = 0;
  for (const RigidShape& shape : {plane, sphere, box, capsule})
    for (int trial = 0; trial < 500; ++trial) {
      const RigidPlacement at{random_turn(random), 0.2 * random_direction(random)};
      Ray ray;
      ray.origin = (trial % 4 == 0 ? 0.1 : 1.2) * random_direction(random);
      ray.direction = random_direction(random);
      ray.length = 4;
      const auto distance = [&](double t) {
        return signed_distance(shape, at, ray.origin + t * ray.direction).distance;
      };
      // March in steps no longer than the distance to the surface.
      double t = 0;
      while (t < ray.length && std::abs(distance(t)) > 1e-9) t += std::abs(distance(t));
      const auto hit = pick(shape, at, ray);
      ASSERT_EQ(hit.has_value(), t < ray.length) << int(shape.kind) << " " << trial;
      if (!hit) continue;
      ++hits;
      EXPECT_NEAR(distance(hit->distance), 0, 1e-9);
      EXPECT_NEAR(hit->distance, t, 1e-4);
      const Vec3 point = ray.origin + hit->distance * ray.direction;
      EXPECT_LT((signed_distance(shape, at, point + 1e-3 * hit->normal).normal - hit->normal).norm(),
                1e-5);
    }
  EXPECT_GT(hits, 500);
}

Eigen::AlignedBox3d box_at(const Vec3& centre, double half) {
  return {centre - Vec3::Constant(half), centre + Vec3::Constant(half)};
}

TEST(BroadPhase, FindsAllOverlappingPairsThatGroupsAndMasksAllow) {
  std::mt19937 random(45);
  std::uniform_real_distribution<double> uniform(-1, 1);
  std::uniform_int_distribution<std::uint32_t> bits(0, 7);
  const std::size_t count = 60;
  BroadPhase broad;
  broad.resize(count);
  std::vector<Vec3> centre(count), speed(count);
  std::vector<CollisionFilter> filters(count);
  for (std::size_t k = 0; k < count; ++k) {
    centre[k] = Vec3(uniform(random), uniform(random), uniform(random));
    speed[k] = 0.1 * random_direction(random);
    filters[k] = {bits(random), bits(random)};
    broad.set_filter(std::uint32_t(k), filters[k]);
  }
  std::size_t found_count = 0, most = 0;
  const double infinity = std::numeric_limits<double>::infinity();
  for (int step = 0; step < 100; ++step) {
    std::vector<Eigen::AlignedBox3d> boxes(count);
    for (std::size_t k = 0; k < count; ++k) {
      centre[k] += speed[k];
      boxes[k] = box_at(centre[k], 0.05 + 0.005 * double(k));
    }
    boxes[7].setEmpty();
    boxes[8] = {Vec3::Constant(-infinity), Vec3(infinity, infinity, 0)};  // a floor
    for (std::size_t k = 0; k < count; ++k) broad.set_box(std::uint32_t(k), boxes[k]);
    std::vector<BodyPair> expected;
    for (std::uint32_t i = 0; i < count; ++i)
      for (std::uint32_t j = i + 1; j < count; ++j)
        if ((filters[i].groups & filters[j].mask) && (filters[j].groups & filters[i].mask) && i != 7 &&
            j != 7 && boxes[i].intersects(boxes[j]))
          expected.push_back({i, j});
    const std::size_t before = test::allocation_count();
    const auto found = broad.find_pairs();
    if (found.size() <= most) {
      EXPECT_EQ(test::allocation_count(), before);
    }
    most = std::max(most, found.size());
    EXPECT_TRUE(std::ranges::equal(found, expected)) << step;
    found_count += found.size();
  }
  EXPECT_GT(found_count, 1000U);
}

TEST(BroadPhase, BoxesThatAreNotNumbersOverlapNothing) {
  BroadPhase broad;
  broad.resize(3);
  broad.set_box(0, box_at(Vec3::Zero(), 1));
  broad.set_box(1, box_at(Vec3(0, std::nan(""), 0), 1));
  broad.set_box(2, box_at(Vec3(0.5, 0, 0), 1));
  const auto found = broad.find_pairs();
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0], (BodyPair{0, 2}));
}

}  // namespace
}  // namespace souple
