// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/hierarchy/embed_points.hpp"

#include <cmath>
#include <limits>
#include <numeric>
#include <random>

#include "tests/tools/hierarchy/hierarchy_shapes.hpp"
#include "tests/tools/real_surface.hpp"
#include "tools/geometry/vector.hpp"

namespace souple {
namespace {

Point carried(const Embedding& row, const TetMesh& mesh) {
  Point sum{};
  for (std::size_t k = 0; k < 4; ++k) {
    const Index i = mesh.tets[static_cast<std::size_t>(row.tet)][k];
    sum = add_scaled(sum, row.weights[k], mesh.nodes[static_cast<std::size_t>(i)]);
  }
  return sum;
}

std::vector<Point> random_points(std::size_t count, double low, double high) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> uniform(low, high);
  std::vector<Point> points;
  for (std::size_t i = 0; i < count; ++i)
    points.push_back({uniform(random), uniform(random), uniform(random)});
  return points;
}

TEST(EmbedPoints, FindsTheTetOfEveryPointInside) {
  const TetMesh mesh = kuhn_cube(4);
  const std::vector<Point> points = random_points(5000, 0, 1);
  const auto embedded = embed_points(points, mesh);
  ASSERT_TRUE(embedded.ok());
  EXPECT_EQ(embedded->outside_count, 0u);
  EXPECT_EQ(embedded->farthest_outside_m, 0);
  EXPECT_LE(embedded->largest_weight, 1 + 1e-9);
  ASSERT_EQ(embedded->rows.size(), points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Embedding& row = embedded->rows[i];
    EXPECT_GE(std::ranges::min(row.weights), -1e-9);
    EXPECT_NEAR(std::accumulate(row.weights.begin(), row.weights.end(), 0.0), 1, 1e-14);
    EXPECT_LT(norm(subtract(carried(row, mesh), points[i])), 1e-14);
  }
}

TEST(EmbedPoints, GivesSharedNodesFacesAndEdgesToTheLowestTet) {
  const TetMesh mesh = kuhn_cube(2);
  std::vector<Point> points = mesh.nodes;
  for (const Tet& t : mesh.tets) {
    const auto x = [&](std::size_t k) { return mesh.nodes[static_cast<std::size_t>(t[k])]; };
    points.push_back(scaled(add(x(0), x(1)), 0.5));
    points.push_back(scaled(add(add(x(0), x(1)), x(2)), 1.0 / 3));
  }
  const auto embedded = embed_points(points, mesh);
  ASSERT_TRUE(embedded.ok());
  EXPECT_EQ(embedded->outside_count, 0u);
  for (std::size_t i = 0; i < mesh.nodes.size(); ++i) {
    const auto holds = [&](const Tet& t) {
      return std::ranges::find(t, static_cast<Index>(i)) != t.end();
    };
    const auto lowest = std::ranges::find_if(mesh.tets, holds) - mesh.tets.begin();
    EXPECT_EQ(embedded->rows[i].tet, lowest);
  }
}

TEST(EmbedPoints, CarriesAffineMotionsExactlyFarOutsideToo) {
  const TetMesh mesh = kuhn_cube(3);
  const std::vector<Point> points = random_points(2000, -1.5, 2.5);
  const auto embedded = embed_points(points, mesh);
  ASSERT_TRUE(embedded.ok());
  EXPECT_GT(embedded->outside_count, 1000u);
  EXPECT_GT(embedded->largest_weight, 2);
  EXPECT_LT(embedded->largest_weight, 50);
  EXPECT_NEAR(embedded->farthest_outside_m, 2.4, 0.3);  // near a corner, sqrt(3) 1.5
  const auto moved = [](const Point& x) {
    return Point{2 * x[0] - x[1] + 3, 0.5 * x[1] + 4 * x[2] - 1, x[0] + x[1] - 2 * x[2] + 7};
  };
  TetMesh moved_mesh = mesh;
  for (Point& x : moved_mesh.nodes) x = moved(x);
  for (std::size_t i = 0; i < points.size(); ++i)
    EXPECT_LT(norm(subtract(carried(embedded->rows[i], moved_mesh), moved(points[i]))), 1e-12);
}

TEST(EmbedPoints, OutsideTakesABoundaryTetNearby) {
  const TetMesh mesh = kuhn_cube(5);
  const std::vector<Point> points{{0.5, 0.5, 1.01}, {1.001, 0.3, 0.3}, {-0.01, -0.01, -0.01}};
  const auto embedded = embed_points(points, mesh);
  ASSERT_TRUE(embedded.ok());
  EXPECT_EQ(embedded->outside_count, 3u);
  EXPECT_NEAR(embedded->farthest_outside_m, 0.01 * std::sqrt(3.0), 1e-12);
  EXPECT_LT(embedded->largest_weight, 1.3);
}

TEST(EmbedPoints, BindsAHundredThousandPointsInAndAroundARealBody) {
  SOUPLE_NEEDS_REAL_SURFACES();
  const TriangleMesh surface = closed_real_surface("liver-smooth.obj");
  const TetMesh mesh = coarse_mesh(surface, 10000);
  std::vector<Point> points;
  for (const Point& p : random_points(100'000, 0, 1)) {
    // Within and around: between a vertex of the surface and a node of the mesh, and a little beyond.
    const Point& a =
        surface.vertices[static_cast<std::size_t>(p[0] * 0.999 * double(surface.vertices.size()))];
    const Point& b = mesh.nodes[static_cast<std::size_t>(p[1] * 0.999 * double(mesh.nodes.size()))];
    points.push_back(add_scaled(a, 1.1 * p[2] - 0.05, subtract(b, a)));
  }
  const auto embedded = embed_points(points, mesh);
  ASSERT_TRUE(embedded.ok());
  RecordProperty("outside", std::to_string(embedded->outside_count));
  RecordProperty("largest_weight", std::to_string(embedded->largest_weight));
  for (std::size_t i = 0; i < points.size(); ++i)
    ASSERT_LT(norm(subtract(carried(embedded->rows[i], mesh), points[i])), 1e-12);
}

TEST(EmbedPoints, RefusesBadMeshesAndPoints) {
  const auto code = [](const std::vector<Point>& points, const TetMesh& mesh) {
    const auto embedded = embed_points(points, mesh);
    return embedded.ok() ? IssueCode{} : embedded.issue().code;
  };
  EXPECT_EQ(code({}, unit_tet()), IssueCode{});
  EXPECT_EQ(code({{0.1, 0.1, 0.1}}, {}), IssueCode::mesh_element_invalid);
  TetMesh bad = unit_tet();
  std::swap(bad.tets[0][0], bad.tets[0][1]);
  EXPECT_EQ(code({{0.1, 0.1, 0.1}}, bad), IssueCode::mesh_element_invalid);
  bad = unit_tet();
  bad.tets[0][2] = -1;
  EXPECT_EQ(code({{0.1, 0.1, 0.1}}, bad), IssueCode::mesh_element_invalid);
  bad = unit_tet();
  bad.nodes[3] = bad.nodes[2];
  EXPECT_EQ(code({{0.1, 0.1, 0.1}}, bad), IssueCode::mesh_element_invalid);
  bad = unit_tet();
  bad.nodes[3][0] = 1e300;
  EXPECT_EQ(code({{0.1, 0.1, 0.1}}, bad), IssueCode::mesh_element_invalid);
  for (const double x : {std::nan(""), std::numeric_limits<double>::infinity(), 3e38, 1e4, -1e4})
    EXPECT_EQ(code({{x, 0, 0}}, unit_tet()), IssueCode::embedding_failed) << x;
  EXPECT_EQ(code({{400, 0, 0}}, unit_tet()), IssueCode{});
}

}  // namespace
}  // namespace souple
