// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <random>

#include "runtime/collision/local_minima.hpp"
#include "tests/runtime/collision/brute_minima.hpp"
#include "tests/runtime/collision/collision_bodies.hpp"
#include "tests/support/allocation_count.hpp"

namespace souple {
namespace {

using Body = test::CollisionBody;
using test::random_direction;

std::vector<LocalMinimum> minima(const Body& a, const Body& b, double alarm, double reach) {
  ProximityWork work;
  std::vector<LocalMinimum> out;
  find_local_minima(a.surface, b.surface, alarm, reach, work, out);
  return out;
}

Vec3 point_of(const SurfacePoint& p, const Eigen::VectorXd& x) {
  Vec3 sum = Vec3::Zero();
  for (int k = 0; k < p.count; ++k) sum += p.weight[k] * node_entry(x, p.node[k]);
  return sum;
}

double longest_edge(const LocalMinimum& m, const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
  return std::max((node_entry(a, m.a.node[1]) - node_entry(a, m.a.node[0])).norm(),
                  (node_entry(b, m.b.node[1]) - node_entry(b, m.b.node[0])).norm());
}

// Names the first difference, or nothing.
std::string compare(const std::vector<LocalMinimum>& found,
                    const std::vector<test::BrutePair>& expected) {
  const auto name = [](Index a, Index b, double gap) {
    return std::to_string(a) + "-" + std::to_string(b) + " gap " + std::to_string(gap);
  };
  for (std::size_t k = 0; k < std::max(found.size(), expected.size()); ++k) {
    if (k == found.size())
      return "missing " + name(expected[k].feature_a, expected[k].feature_b, expected[k].gap);
    const LocalMinimum& f = found[k];
    if (k == expected.size()) return "extra " + name(f.feature_a, f.feature_b, f.gap);
    const auto& e = expected[k];
    if (f.feature_a != e.feature_a || f.feature_b != e.feature_b)
      return "found " + name(f.feature_a, f.feature_b, f.gap) + " expected " +
             name(e.feature_a, e.feature_b, e.gap);
    if (std::abs(f.gap - e.gap) > 1e-10 || (f.normal - e.normal).norm() > 1e-6 ||
        (f.point_b - e.point_b).norm() > 1e-9)
      return "other geometry of " + name(f.feature_a, f.feature_b, f.gap) + " expected gap " +
             std::to_string(e.gap);
  }
  return {};
}

TEST(LocalMinima, AreThoseOfAllPairsOfFeaturesOnTenThousandDeformedPairs) {
  std::mt19937 random(17);
  std::uniform_real_distribution<double> uniform(0, 1);
  Body block({2, 2, 2}, {1, 1, 1}), brick({3, 2, 1}, {1.4, 1, 0.5}), plate({2, 2, 1}, {1.2, 1.2, 0.1}),
      tip({1, 1, 1}, {0.4, 0.4, 0.4});
  const std::array<Body*, 4> first = {&block, &plate, &brick, &tip};
  Body block2({2, 2, 2}, {1, 1, 1}), plate2({2, 2, 1}, {1.2, 1.2, 0.1});
  const std::array<Body*, 2> second = {&block2, &plate2};
  ProximityWork work;
  std::vector<LocalMinimum> found;
  std::size_t vertex_pairs = 0, edge_pairs = 0, deep = 0, different = 0;
  for (int trial = 0; trial < 10000; ++trial) {
    Body& a = *first[std::size_t(trial) % 4];
    Body& b = *second[std::size_t(trial / 4) % 2];
    // No more than a thin body bears without passing through itself.
    const double shake = (&a == &plate ? 0.02 : 0.08) * uniform(random);
    a.deform(random, shake, (0.3 + 1.2 * uniform(random)) * random_direction(random));
    b.deform(random, 0.02, Vec3::Zero());
    const double alarm = 0.02 + 0.2 * uniform(random), reach = 0.3 * uniform(random);
    found.clear();
    find_local_minima(a.surface, b.surface, alarm, reach, work, found);
    const test::BruteSurface brute_a(a.level.boundary, a.x), brute_b(b.level.boundary, b.x);
    const auto expected = test::brute_minima(brute_a, brute_b, alarm, reach);
    const std::string difference = compare(found, expected);
    if (!difference.empty() && ++different < 10)
      ADD_FAILURE() << "pair " << trial << ": " << difference;
    for (const auto& m : found) {
      const bool is_edges = m.a.count == 2 && m.b.count == 2;
      edge_pairs += is_edges;
      vertex_pairs += !is_edges;
      deep += m.gap < -alarm;
    }
  }
  EXPECT_EQ(different, 0U);
  EXPECT_GT(vertex_pairs, 10000U);
  EXPECT_GT(edge_pairs, 700U);
  EXPECT_GT(deep, 500U);
}

TEST(LocalMinima, PointsWeightsNormalsAndGapsAgree) {
  std::mt19937 random(3);
  Body a({2, 2, 2}, {1, 1, 1}), b({2, 2, 2}, {1, 1, 1});
  for (int trial = 0; trial < 100; ++trial) {
    a.deform(random, 0.05, Vec3(1.2, 0.2, 0.1));
    b.deform(random, 0.05, Vec3::Zero());
    for (const auto& m : minima(a, b, 0.3, 0.3)) {
      EXPECT_NEAR(m.normal.norm(), 1, 1e-12);
      EXPECT_LT((point_of(m.b, b.x) - m.point_b).norm(), 1e-12);
      // Beside a face by up to 2 % of the alarm distance counts as over it; a flat edge that is cut may
      // be cut by 1 % of its length.
      const double left_out =
          m.a.count == 2 && m.b.count == 2 ? 0.01 * longest_edge(m, a.x, b.x) : 0.3 * 0.02;
      EXPECT_LE((point_of(m.a, a.x) - m.point_b - m.gap * m.normal).norm(), left_out + 1e-9);
    }
  }
}

TEST(LocalMinima, ABoxOnALargerOneIsHeldAtItsCornersAndUpright) {
  Body base({2, 2, 1}, {2, 2, 0.5}), box({1, 1, 1}, {0.5, 0.5, 0.5});
  for (const double gap : {0.01, 0.0, -0.01}) {
    box.place(Mat3::Identity(), {0.1, 0.05, 0.5 + gap});
    const auto found = minima(box, base, 0.05, 0.1);
    int corners = 0;
    for (const auto& m : found) {
      EXPECT_NEAR(m.normal.z(), 1, 1e-9);
      EXPECT_NEAR(m.gap, gap, 1e-12);
      corners += m.a.count == 1;
    }
    EXPECT_EQ(corners, 4) << gap;
    EXPECT_LE(found.size(), 8U) << gap;
  }
}

TEST(LocalMinima, EqualBoxesStackedAskewTouchWhereTheirEdgesCross) {
  Body lower({1, 1, 1}, {1, 1, 1}), upper({1, 1, 1}, {1, 1, 1});
  upper.place(Eigen::AngleAxisd(0.78, Vec3::UnitZ()).toRotationMatrix(), {0, 0, 1.01});
  const auto found = minima(upper, lower, 0.05, 0.1);
  EXPECT_EQ(found.size(), 8U);  // of the octagon that both cover
  for (const auto& m : found) {
    EXPECT_NEAR(m.gap, 0.01, 1e-12);
    EXPECT_NEAR(m.normal.z(), 1, 1e-9);
  }
}

TEST(LocalMinima, EqualBoxesStackedFlushHoldEachOtherAtEveryCornerToAnyDepth) {
  Body lower({1, 1, 1}, {1, 1, 1}), upper({1, 1, 1}, {1, 1, 1});
  for (const double shift : {0.0, 1e-12, -1e-12, 3e-4, -3e-4})
    for (const double gap : {0.03, 1e-9, 0.0, -1e-9, -1e-4, -0.03, -0.15}) {
      upper.place(Mat3::Identity(), {shift, -shift, 1 + gap});
      const auto found = minima(upper, lower, 0.05, 0.2);
      std::array<int, 4> held{};
      for (const auto& m : found) {
        EXPECT_GT(m.normal.z(), 0.99) << shift << " " << gap;
        EXPECT_NEAR(m.gap, gap, 1e-6) << shift << " " << gap;
        ++held[(m.point_b.x() > 0 ? 1 : 0) + (m.point_b.y() > 0 ? 2 : 0)];
      }
      for (const int count : held) EXPECT_GE(count, 1) << shift << " " << gap;
    }
}

// A blade cuts into an edge: what both cover is thin, and no vertex is inside.
TEST(LocalMinima, EdgesThatHaveCutThroughEachOtherAreHeldThoughNoVertexIsInside) {
  Body blade({1, 1, 1}, {4, 1, 1}), block({1, 1, 1}, {4, 1, 1});
  const Mat3 on_edge = Eigen::AngleAxisd(M_PI / 4, Vec3::UnitX()).toRotationMatrix();
  const Mat3 across = Eigen::AngleAxisd(1.2, Vec3::UnitZ()).toRotationMatrix();
  const double to_edge = std::sqrt(0.5);
  for (const double depth : {1e-6, 1e-3, 0.03})
    for (const double lean : {0.0, 0.1}) {
      Mat3 sharp = Vec3(1, 0.2, 1).asDiagonal();
      sharp(1, 2) = lean;
      blade.place(sharp * on_edge, to_edge * Vec3(0, lean, 1));
      block.place(across * on_edge, {0, 0, depth - to_edge});
      for (const double alarm : {0.01, 0.3}) {
        const auto found = minima(blade, block, alarm, 0.3);
        ASSERT_EQ(found.size(), 1U) << depth << " " << lean << " " << alarm;
        EXPECT_EQ(found[0].a.count, 2);
        EXPECT_EQ(found[0].b.count, 2);
        EXPECT_NEAR(found[0].gap, -depth, 1e-12);
        EXPECT_GT(found[0].normal.z(), 1 - 1e-9);
      }
    }
}

TEST(LocalMinima, ThinPlatesThatEnterEachOtherArePushedBackTheWayTheyCame) {
  Body lower({4, 4, 1}, {1, 1, 0.02}), upper({4, 4, 1}, {0.7, 0.7, 0.02});
  upper.place(Mat3::Identity(), {0.03, 0.02, 0.02 - 0.013});
  const auto found = minima(upper, lower, 0.01, 0.05);
  ASSERT_GT(found.size(), 10U);
  for (const auto& m : found) {
    EXPECT_GT(m.normal.z(), 0.9);
    EXPECT_NEAR(m.gap, -0.013, 1e-9);
  }
}

TEST(LocalMinima, ABodyBesideAPlateCrushedThroughItselfIsNotInIt) {
  Body plate({4, 4, 1}, {1, 1, 0.02}), tile({2, 2, 1}, {0.4, 0.4, 0.02});
  plate.place(Vec3(1, 1, -1e-4).asDiagonal(), {0.013, 0.011, 0});
  for (const double side : {-1.0, 1.0}) {
    tile.place(Mat3::Identity(), {0, 0, side * 0.05});
    for (const double alarm : {0.02, 0.1})
      for (const auto& m : minima(tile, plate, alarm, 0.3)) EXPECT_GT(m.gap, 0) << side << ' ' << alarm;
  }
}

TEST(LocalMinima, AFingerInAForkMeetsEachProngOnItsOwnSide) {
  Body prong({1, 2, 2}, {0.05, 1, 1}), finger({1, 2, 2}, {0.1, 0.6, 0.6});
  finger.place(Mat3::Identity(), {0.09, 0.01, 0.02});  // right of a prong of half width 0.025
  for (const auto& m : minima(finger, prong, 0.03, 0.3)) {
    EXPECT_NEAR(m.gap, 0.015, 1e-12);
    EXPECT_NEAR(m.normal.x(), 1, 1e-9);
  }
}

TEST(LocalMinima, SearchesAllocateNothingOnceWarm) {
  std::mt19937 random(9);
  Body a({4, 4, 4}, {1, 1, 1}), b({4, 4, 4}, {1, 1, 1});
  a.deform(random, 0.02, Vec3(0.9, 0, 0));
  b.deform(random, 0.02, Vec3::Zero());
  ProximityWork work;
  std::vector<LocalMinimum> found;
  const auto search = [&] {
    found.clear();
    a.surface.refit(a.x);
    b.surface.refit(b.x);
    find_local_minima(a.surface, b.surface, 0.1, 0.3, work, found);
    find_self_minima(a.surface, 0.05, 0.3, work, found);
  };
  search();
  const std::size_t count = found.size();
  const std::size_t before = test::allocation_count();
  search();
  EXPECT_EQ(test::allocation_count(), before);
  EXPECT_EQ(found.size(), count);
  EXPECT_GT(count, 0U);
}

TEST(LocalMinima, AreTheSameFromBothSides) {
  std::mt19937 random(21);
  Body a({2, 2, 2}, {1, 1, 1}), b({3, 2, 1}, {1, 1, 0.4});
  for (int trial = 0; trial < 100; ++trial) {
    a.deform(random, 0.05, 0.9 * random_direction(random));
    b.deform(random, 0.05, Vec3::Zero());
    auto forward = minima(a, b, 0.2, 0.2), backward = minima(b, a, 0.2, 0.2);
    for (auto& m : backward) std::swap(m.feature_a, m.feature_b);
    std::ranges::sort(backward, {}, [](const auto& m) { return std::pair(m.feature_a, m.feature_b); });
    ASSERT_EQ(forward.size(), backward.size());
    for (std::size_t k = 0; k < forward.size(); ++k) {
      EXPECT_EQ(forward[k].feature_a, backward[k].feature_a);
      EXPECT_EQ(forward[k].feature_b, backward[k].feature_b);
      EXPECT_NEAR(forward[k].gap, backward[k].gap, 1e-12);
    }
  }
}

// A horseshoe: a flat strip of cells bent round by `angle`, thickness 0.2.
void bend(Body& body, double angle) {
  for (std::size_t n = 0; n < body.level.mesh.nodes.size(); ++n) {
    const Point& p = body.level.mesh.nodes[n];
    const double radius = 4 / angle, turn = p[0] / 4 * angle;  // length 4
    body.x.segment<3>(3 * Eigen::Index(n)) =
        Vec3((radius - p[2]) * std::sin(turn), p[1], (radius - p[2]) * (1 - std::cos(turn)));
  }
  body.surface.refit(body.x);
}

TEST(SelfMinima, NothingTouchesInABodyAtRestOrCrushed) {
  Body strip({16, 2, 1}, {4, 0.5, 0.2});
  ProximityWork work;
  std::vector<LocalMinimum> found;
  find_self_minima(strip.surface, 0.1, 0.3, work, found);
  EXPECT_TRUE(found.empty());
  strip.place(Vec3(1, 1, 0.4).asDiagonal(), Vec3::Zero());
  find_self_minima(strip.surface, 0.1, 0.3, work, found);
  EXPECT_TRUE(found.empty());
}

TEST(SelfMinima, TheEndsOfABentStripMeetAndAreToldApartWhenTheyEnterEachOther) {
  Body strip({24, 2, 1}, {4, 0.5, 0.2});
  ProximityWork work;
  std::vector<LocalMinimum> found;
  bend(strip, 6.0);  // the ends face each other, a gap of about 0.15 at the inner side
  find_self_minima(strip.surface, 0.25, 0.1, work, found);
  ASSERT_GE(found.size(), 4U);
  for (const auto& m : found) {
    EXPECT_GT(m.gap, 0);
    EXPECT_GT(std::abs(m.normal.x()), 0.9);
    EXPECT_LT(m.feature_a, m.feature_b);
  }
  found.clear();
  bend(strip, 6.35);  // past the full turn: the ends overlap
  find_self_minima(strip.surface, 0.25, 0.3, work, found);
  int inside = 0;
  for (const auto& m : found) inside += m.gap < 0;
  EXPECT_GE(inside, 4);
}

}  // namespace
}  // namespace souple
