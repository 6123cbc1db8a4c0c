// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <random>

#include "runtime/collision/rigid_mesh.hpp"
#include "runtime/collision/shape_minima.hpp"
#include "tests/runtime/collision/collision_bodies.hpp"

namespace souple {
namespace {

using test::CollisionBody;
using test::random_turn;

RigidShape sphere_of(double radius) {
  RigidShape s;
  s.kind = RigidShapeKind::sphere;
  s.radius_m = radius;
  return s;
}
RigidShape capsule_of(double radius, double half) {
  RigidShape s;
  s.kind = RigidShapeKind::capsule;
  s.radius_m = radius;
  s.half_length_m = half;
  return s;
}
RigidShape box_of(const Point& half) {
  RigidShape s;
  s.kind = RigidShapeKind::box;
  s.half_extents_m = half;
  return s;
}

std::vector<LocalMinimum> minima(const CollisionBody& body, const RigidShape& shape,
                                 const RigidPlacement& at, double alarm) {
  ProximityWork work;
  std::vector<LocalMinimum> out;
  find_shape_minima(body.surface, shape, at, alarm, work, out);
  return out;
}
std::vector<LocalMinimum> minima(const RigidShape& a, const RigidPlacement& at_a, const RigidShape& b,
                                 const RigidPlacement& at_b, double alarm) {
  std::vector<LocalMinimum> out;
  find_rigid_minima(a, at_a, b, at_b, alarm, out);
  return out;
}

double least_gap(const std::vector<LocalMinimum>& found) {
  double least = 1e9;
  for (const auto& m : found) least = std::min(least, m.gap);
  return least;
}

RigidPlacement at(double x, double y, double z) { return {Mat3::Identity(), {x, y, z}}; }

TEST(ShapeMinima, EveryVertexNearAShapeIsFoundWithItsSignedDistance) {
  std::mt19937 random(4);
  CollisionBody body({4, 4, 4}, {1, 1, 1});
  RigidShape plane;
  for (const RigidShape& shape : {plane, sphere_of(0.4), capsule_of(0.2, 0.5), box_of({0.3, 0.5, 0.2})})
    for (int trial = 0; trial < 50; ++trial) {
      body.deform(random, 0.02, Vec3::Zero());
      const RigidPlacement place{random_turn(random), 0.7 * test::random_direction(random)};
      const double alarm = 0.15;
      std::vector<std::pair<Index, double>> expected, found;
      for (Index v = 0; v < body.tree.topology().vertex_count(); ++v) {
        const double d = signed_distance(shape, place, body.surface.position(v)).distance;
        if (d < alarm) expected.emplace_back(v, d);
      }
      for (const auto& m : minima(body, shape, place, alarm)) {
        EXPECT_LT(m.gap, alarm);
        EXPECT_NEAR(m.normal.norm(), 1, 1e-12);
        EXPECT_EQ(m.b.count, 0);
        EXPECT_EQ(m.a.count == 1, m.feature_b == 0);
        if (m.a.count == 1) found.emplace_back(m.feature_a, m.gap);
      }
      ASSERT_EQ(found.size(), expected.size());
      for (std::size_t k = 0; k < found.size(); ++k) {
        EXPECT_EQ(found[k].first, expected[k].first);
        // Where two faces of a box are as near as makes no difference, the one that faces the vertex.
        const bool may_choose = shape.kind == RigidShapeKind::box && expected[k].second < 0.05 * alarm;
        EXPECT_NEAR(found[k].second, expected[k].second, may_choose ? 0.1 * alarm : 0);
      }
    }
}

TEST(ShapeMinima, ASmallShapeOnALargeTriangleIsHeldInItsMiddle) {
  CollisionBody base({1, 1, 1}, {4, 4, 1});
  const double c = std::cos(0.6155), s = std::sin(0.6155);  // a cube on its corner, nearly
  Mat3 tilt;
  tilt << c, 0, s, 0, 1, 0, -s, 0, c;
  tilt = tilt * Eigen::AngleAxisd(0.7854, Vec3::UnitX()).toRotationMatrix();
  for (const double gap : {0.01, -0.02}) {
    auto found = minima(base, sphere_of(0.1), at(0.7, 0.3, 0.6 + gap), 0.05);
    ASSERT_EQ(found.size(), 1U);
    EXPECT_EQ(found[0].a.count, 3);
    EXPECT_NEAR(found[0].gap, gap, 1e-12);
    EXPECT_NEAR(found[0].normal.z(), -1, 1e-12);
    EXPECT_NEAR((found[0].point_b + found[0].gap * found[0].normal).z(), 0.5, 1e-12);

    found = minima(
        base, capsule_of(0.1, 0.3),
        {Eigen::AngleAxisd(M_PI / 2, Vec3::UnitY()).toRotationMatrix(), {0.5, 0.2, 0.6 + gap}}, 0.05);
    ASSERT_EQ(found.size(), 2U);
    for (const auto& m : found) EXPECT_NEAR(m.gap, gap, 1e-12);

    const RigidShape cube = box_of({0.1, 0.1, 0.1});
    double lowest = 0;
    for (int k = 0; k < 8; ++k)
      lowest = std::min(lowest,
                        (tilt * Vec3((k & 1) ? .1 : -.1, (k & 2) ? .1 : -.1, (k & 4) ? .1 : -.1)).z());
    found = minima(base, cube, {tilt, {0.7, 0.3, 0.5 - lowest + gap}}, 0.05);
    ASSERT_GE(found.size(), 1U);
    EXPECT_NEAR(least_gap(found), gap, 1e-12);
    EXPECT_NEAR(found[0].normal.z(), -1, 1e-9);
    // A box lying flat: its four corners.
    found = minima(base, cube, at(0.7, 0.3, 0.6 + gap), 0.05);
    EXPECT_EQ(found.size(), 4U);
  }
}

TEST(ShapeMinima, ABoxEdgeAcrossARidgeIsHeldWhereTheyCross) {
  CollisionBody base({1, 1, 1}, {1, 4, 1});
  base.place(Eigen::AngleAxisd(M_PI / 4, Vec3::UnitY()).toRotationMatrix(), Vec3::Zero());
  const RigidShape bar = box_of({2, 0.1, 0.1});
  const Mat3 edge_down = Eigen::AngleAxisd(M_PI / 4, Vec3::UnitX()).toRotationMatrix();
  const double top = std::sqrt(0.5), bottom = 0.1 * std::sqrt(2.0);
  for (const double gap : {0.02, -0.02}) {
    const auto found = minima(base, bar, {edge_down, {0.01, 0.3, top + bottom + gap}}, 0.05);
    ASSERT_EQ(found.size(), 1U);
    EXPECT_EQ(found[0].a.count, 2);
    EXPECT_NEAR(found[0].gap, gap, 1e-12);
    EXPECT_NEAR(found[0].normal.z(), -1, 1e-9);
  }
}

TEST(RigidMinima, ManifoldsCarryAMoment) {
  RigidShape plane;
  const RigidShape box = box_of({0.5, 0.4, 0.3}), ball = sphere_of(0.2), rod = capsule_of(0.1, 0.5);
  const Mat3 lying = Eigen::AngleAxisd(M_PI / 2, Vec3::UnitY()).toRotationMatrix();
  const auto upright = [](const std::vector<LocalMinimum>& found, std::size_t count, double gap) {
    EXPECT_EQ(found.size(), count);
    for (const auto& m : found) {
      EXPECT_NEAR(m.gap, gap, 1e-12);
      EXPECT_NEAR(m.normal.z(), 1, 1e-12);
    }
  };
  for (const double gap : {0.01, 0.0, -0.01}) {
    upright(minima(box, at(0, 0, 0.3 + gap), plane, {}, 0.05), 4, gap);
    upright(minima(ball, at(0, 0, 0.2 + gap), plane, {}, 0.05), 1, gap);
    upright(minima(rod, {lying, {0, 0, 0.1 + gap}}, plane, {}, 0.05), 2, gap);
    upright(minima(rod, {lying, {0, 0.1, 0.1 + gap}}, rod, {lying, {0.3, 0.1, -0.1}}, 0.05), 2, gap);
    upright(minima(rod, {lying, {0, 0.1, 0.4 + gap}}, box, {}, 0.05), 2, gap);
    upright(minima(ball, at(0.1, 0, 0.5 + gap), box, {}, 0.05), 1, gap);
    upright(minima(box, at(0, 0, 0.6 + gap), box, {}, 0.05), 8, gap);  // flush
    upright(minima(box, at(0.2, 0.1, 0.6 + gap), box, {}, 0.05), 4, gap);
    const Mat3 askew = Eigen::AngleAxisd(0.7, Vec3::UnitZ()).toRotationMatrix();
    const RigidShape square = box_of({0.5, 0.5, 0.3});
    upright(minima(square, {askew, {0, 0, 0.6 + gap}}, square, {}, 0.05), 8, gap);
  }
}

TEST(RigidMinima, TurnAroundWithTheOrderOfTheShapes) {
  std::mt19937 random(12);
  RigidShape plane;
  const std::array<RigidShape, 4> shapes = {plane, sphere_of(0.2), capsule_of(0.1, 0.4),
                                            box_of({0.3, 0.2, 0.4})};
  int compared = 0;
  for (int trial = 0; trial < 4000; ++trial) {
    const RigidShape &a = shapes[std::size_t(trial % 4)], &b = shapes[std::size_t(trial / 4 % 4)];
    const RigidPlacement at_a{random_turn(random), 0.5 * test::random_direction(random)};
    const RigidPlacement at_b{random_turn(random), Vec3::Zero()};
    auto forward = minima(a, at_a, b, at_b, 0.12), backward = minima(b, at_b, a, at_a, 0.12);
    ASSERT_EQ(forward.size(), backward.size()) << trial;
    const auto by_gap = [](const LocalMinimum& m) { return m.gap; };
    std::ranges::sort(forward, {}, by_gap);
    std::ranges::sort(backward, {}, by_gap);
    for (std::size_t k = 0; k < forward.size(); ++k) {
      ++compared;
      // The ends of the stretch that two nearly parallel capsules share are found along one of them.
      const bool stretch = a.kind == RigidShapeKind::capsule && b.kind == RigidShapeKind::capsule;
      EXPECT_NEAR(forward[k].gap, backward[k].gap, stretch ? 1e-4 : 1e-12);
      EXPECT_NEAR(forward[k].normal.norm(), 1, 1e-12);
    }
  }
  EXPECT_GT(compared, 1000);
}

// Alternating projections between convex bodies go down to their distance; the points of a pair that
// lie on both surfaces are no nearer than it.
TEST(RigidMinima, TheLeastGapOfShapesApartIsTheirDistance) {
  std::mt19937 random(13);
  std::uniform_real_distribution<double> uniform(-1, 1);
  const std::array<RigidShape, 3> shapes = {sphere_of(0.2), capsule_of(0.15, 0.3),
                                            box_of({0.3, 0.2, 0.25})};
  int apart = 0;
  for (int trial = 0; trial < 900; ++trial) {
    const RigidShape &a = shapes[std::size_t(trial % 3)], &b = shapes[std::size_t(trial / 3 % 3)];
    const RigidPlacement at_a{random_turn(random), 0.75 * test::random_direction(random)};
    const RigidPlacement at_b{random_turn(random), Vec3::Zero()};
    Vec3 p = at_a.translation;
    for (int k = 0; k < 3000; ++k) {
      const auto to_b = signed_distance(b, at_b, p);
      Vec3 q = p - std::max(to_b.distance, 0.0) * to_b.normal;
      const auto to_a = signed_distance(a, at_a, q);
      p = q - std::max(to_a.distance, 0.0) * to_a.normal;
    }
    const double distance = signed_distance(b, at_b, p).distance;
    if (distance < 1e-3) continue;
    ++apart;
    const auto found = minima(a, at_a, b, at_b, distance + 0.1);
    ASSERT_FALSE(found.empty()) << trial;
    const auto& nearest = *std::ranges::min_element(found, {}, &LocalMinimum::gap);
    EXPECT_LE(nearest.gap, distance + 1e-9) << trial;
    const Vec3 point_a = nearest.point_b + nearest.gap * nearest.normal;
    EXPECT_NEAR(signed_distance(b, at_b, nearest.point_b).distance, 0, 1e-9) << trial;
    EXPECT_NEAR(signed_distance(a, at_a, point_a).distance, 0, 1e-9) << trial;
  }
  EXPECT_GT(apart, 400);
}

TEST(RigidMinima, ARodThroughAThinBoxIsPushedOutBesideIt) {
  const RigidShape plate = box_of({1, 1, 0.02}), rod = capsule_of(0.05, 0.8);
  const Mat3 lying = Eigen::AngleAxisd(M_PI / 2 - 0.1, Vec3::UnitY()).toRotationMatrix();
  const auto found = minima(rod, {lying, {0, 0, 0}}, plate, {}, 0.05);
  ASSERT_GE(found.size(), 2U);
  for (const auto& m : found) EXPECT_NEAR(std::abs(m.normal.z()), 1, 1e-9);
}

TriangleMesh surface_mesh(const std::array<int, 3>& cells, const Point& origin, const Point& size) {
  const MeshLevel level = test::level_of(test::box_mesh(cells, origin, size));
  return {level.mesh.nodes, level.boundary};
}

TEST(MassProperties, OfMeshesAreThoseOfTheirShapes) {
  const auto mesh = RigidMesh::make(surface_mesh({2, 3, 1}, {10, -3, 0.2}, {0.6, 0.4, 1}));
  ASSERT_TRUE(mesh);
  const MassProperties exact = mass_properties(box_of({0.3, 0.2, 0.5}));
  EXPECT_NEAR(mesh->mass().volume, 0.24, 1e-12);
  EXPECT_NEAR(exact.volume, 0.24, 1e-15);
  EXPECT_LT((mesh->mass().centre - Vec3(10.3, -2.8, 0.7)).norm(), 1e-12);
  EXPECT_LT((mesh->mass().inertia - exact.inertia).norm(), 1e-12);
  EXPECT_NEAR(exact.inertia(0, 0), 0.24 / 12 * (0.16 + 1), 1e-15);
}

TEST(MassProperties, OfACapsuleAreThoseOfItsPointsAndOfASphereIfItIsShort) {
  const MassProperties ball = mass_properties(sphere_of(0.3)),
                       dot = mass_properties(capsule_of(0.3, 0));
  EXPECT_NEAR(ball.volume, dot.volume, 1e-15);
  EXPECT_LT((ball.inertia - dot.inertia).norm(), 1e-15);
  const RigidShape rod = capsule_of(0.3, 0.5);
  const MassProperties exact = mass_properties(rod);
  Mat3 inertia = Mat3::Zero();
  double volume = 0;
  const int n = 150;
  const double cell = 1.63 / n;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j)
      for (int k = 0; k < n; ++k) {
        const Vec3 p(-0.81 + i * cell, -0.81 + j * cell, -0.81 + k * cell);
        if (signed_distance(rod, {}, p).distance > 0) continue;
        volume += cell * cell * cell;
        inertia += cell * cell * cell * (p.squaredNorm() * Mat3::Identity() - p * p.transpose());
      }
  EXPECT_NEAR(exact.volume, volume, 0.01 * volume);
  EXPECT_LT((exact.inertia - inertia).norm(), 0.01 * inertia.norm());
}

TEST(RigidMesh, RefusesWhatEnclosesNothing) {
  const TriangleMesh good = surface_mesh({1, 1, 1}, {0, 0, 0}, {1, 1, 1});
  const auto refused = [](TriangleMesh mesh) {
    const auto made = RigidMesh::make(std::move(mesh));
    return !made && made.issue().code == IssueCode::rigid_mesh_invalid;
  };
  EXPECT_TRUE(RigidMesh::make(good));
  TriangleMesh bad = good;
  bad.triangles.pop_back();
  EXPECT_TRUE(refused(bad));
  bad = good;
  for (auto& t : bad.triangles) std::swap(t[0], t[1]);
  EXPECT_TRUE(refused(bad));
  bad = good;
  std::swap(bad.triangles[0][0], bad.triangles[0][1]);
  EXPECT_TRUE(refused(bad));
  bad = good;
  bad.triangles[0][0] = 8;
  EXPECT_TRUE(refused(bad));
  bad.triangles[0][0] = -1;
  EXPECT_TRUE(refused(bad));
  bad = good;
  bad.vertices[0][1] = std::nan("");
  EXPECT_TRUE(refused(bad));
  bad = good;
  for (auto& v : bad.vertices) v[2] = 0;
  EXPECT_TRUE(refused(bad));
  bad = good;
  bad.triangles.insert(bad.triangles.end(), good.triangles.begin(), good.triangles.end());
  EXPECT_TRUE(refused(bad));
  EXPECT_TRUE(refused({}));
}

TEST(PlacedMesh, RefitsOnlyWhereItGoesAndMeetsOtherSurfacesThere) {
  const auto mesh = RigidMesh::make(surface_mesh({1, 1, 1}, {-0.5, -0.5, -0.5}, {1, 1, 1}));
  ASSERT_TRUE(mesh);
  PlacedMesh lower(*mesh), upper(*mesh);
  lower.move_to({});
  upper.move_to(at(0.2, 0.1, 1.01));
  ProximityWork work;
  std::vector<LocalMinimum> found;
  find_local_minima(upper.surface(), lower.surface(), 0.05, 0.1, work, found);
  ASSERT_GE(found.size(), 4U);
  for (const auto& m : found) EXPECT_NEAR(m.gap, 0.01, 1e-12);
  found.clear();
  upper.move_to(at(0.2, 0.1, 2));
  find_local_minima(upper.surface(), lower.surface(), 0.05, 0.1, work, found);
  EXPECT_TRUE(found.empty());
}

}  // namespace
}  // namespace souple
