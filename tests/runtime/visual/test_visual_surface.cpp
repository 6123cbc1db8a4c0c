// SPDX-License-Identifier: MIT
#include "runtime/visual/visual_surface.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <random>

#include "tests/support/allocation_count.hpp"
#include "tests/support/box_mesh.hpp"
#include "tests/support/dense_compliance.hpp"
#include "tests/support/scenes.hpp"

namespace souple {
namespace {

TetMesh body_mesh() { return test::irregular_box_mesh({3, 3, 3}, {1, 2, 3}, {0.2, 0.2, 0.2}, 0.5); }

/// Vertices all over the body and up to a tet's size outside of it; the triangles join any three.
VisualMesh scattered_visual(const TetMesh& mesh, std::size_t vertex_count) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> weight(-1, 1);
  VisualMesh visual;
  for (std::size_t v = 0; v < vertex_count; ++v) {
    Embedding row{static_cast<Index>(random() % mesh.tets.size()), {}};
    for (std::size_t k = 0; k < 3; ++k) row.weights[k] = weight(random);
    row.weights[3] = 1 - row.weights[0] - row.weights[1] - row.weights[2];
    Vec3 point = Vec3::Zero();
    for (std::size_t k = 0; k < 4; ++k) {
      const auto node = std::size_t(mesh.tets[std::size_t(row.tet)][k]);
      point += row.weights[k] * as_vec3(mesh.nodes[node]);
    }
    visual.embedding.push_back(row);
    visual.surface.vertices.push_back(as_point(point));
  }
  for (Index v = 0; v + 2 < static_cast<Index>(vertex_count); ++v)
    visual.surface.triangles.push_back({v, v + 1, v + 2});
  return visual;
}

class VisualSurfaceTest : public ::testing::Test {
 protected:
  IssueCode code_of(const VisualMesh& visual) const {
    const auto made = VisualSurface::create(visual, mesh_.tets, mesh_.nodes.size());
    return made ? IssueCode{} : made.issue().code;
  }
  VisualSurface surface() const {
    return *VisualSurface::create(visual_, mesh_.tets, mesh_.nodes.size());
  }

  TetMesh mesh_ = body_mesh();
  VisualMesh visual_ = scattered_visual(mesh_, 500);
};

TEST_F(VisualSurfaceTest, GivesTheRestShapeToRounding) {
  std::vector<Point> vertices(500);
  ASSERT_TRUE(surface().positions(mesh_.nodes, vertices));
  for (std::size_t v = 0; v < vertices.size(); ++v)
    EXPECT_LT((as_vec3(vertices[v]) - as_vec3(visual_.surface.vertices[v])).norm(), 1e-14) << v;
}

TEST_F(VisualSurfaceTest, FollowsAffineMotionsToRounding) {
  Mat3 gradient;
  gradient << 0.3, -1.2, 0.1, 0.9, 0.4, -0.2, 0.0, 0.7, 1.6;
  const Vec3 shift(-3, 0.5, 7);
  const auto moved = [&](const Point& p) { return Vec3(gradient * as_vec3(p) + shift); };
  std::vector<Point> nodes, vertices(500);
  for (const Point& node : mesh_.nodes) nodes.push_back(as_point(moved(node)));
  ASSERT_TRUE(surface().positions(nodes, vertices));
  for (std::size_t v = 0; v < vertices.size(); ++v)
    EXPECT_LT((as_vec3(vertices[v]) - moved(visual_.surface.vertices[v])).norm(), 4e-14) << v;
}

// Where the sum of the weights is only 1 to single precision, a body must not drift from its skin.
TEST_F(VisualSurfaceTest, IsNotLeftBehindFarFromTheOrigin) {
  for (Embedding& row : visual_.embedding)
    for (double& weight : row.weights) weight = static_cast<float>(weight);
  std::vector<Point> nodes, near(500), far(500);
  for (const Point& node : mesh_.nodes) nodes.push_back(as_point(as_vec3(node) + Vec3(1e6, 0, 0)));
  const VisualSurface rounded = surface();
  ASSERT_TRUE(rounded.positions(mesh_.nodes, near) && rounded.positions(nodes, far));
  for (std::size_t v = 0; v < far.size(); ++v) EXPECT_NEAR(far[v][0] - near[v][0], 1e6, 2e-9) << v;
}

TEST_F(VisualSurfaceTest, AllocatesNothing) {
  const VisualSurface made = surface();
  std::vector<Point> vertices(made.vertex_count());
  const std::size_t before = test::allocation_count();
  const bool written = made.positions(mesh_.nodes, vertices);
  EXPECT_EQ(test::allocation_count(), before);
  EXPECT_TRUE(written);
  EXPECT_EQ(made.triangles().size(), 498u);
}

TEST_F(VisualSurfaceTest, WritesNothingWhereSizesDoNotFit) {
  const VisualSurface made = surface();
  std::vector<Point> vertices(made.vertex_count(), Point{9, 9, 9});
  const std::vector<Point> untouched = vertices;
  EXPECT_FALSE(made.positions(std::span(mesh_.nodes).first(5), vertices));
  EXPECT_FALSE(made.positions(mesh_.nodes, std::span(vertices).first(499)));
  EXPECT_EQ(vertices, untouched);
}

TEST_F(VisualSurfaceTest, RefusesWhatPointsOutside) {
  EXPECT_EQ(code_of(visual_), IssueCode{});
  const auto spoilt = [&](auto spoil) {
    VisualMesh visual = visual_;
    spoil(visual);
    return code_of(visual);
  };
  const auto outside = IssueCode::asset_index_out_of_range;
  EXPECT_EQ(spoilt([](auto& v) { v.embedding[3].tet = -1; }), outside);
  EXPECT_EQ(spoilt([&](auto& v) { v.embedding[3].tet = Index(mesh_.tets.size()); }), outside);
  EXPECT_EQ(spoilt([](auto& v) { v.surface.triangles[3][0] = 500; }), outside);
  EXPECT_EQ(spoilt([](auto& v) { v.embedding.pop_back(); }), IssueCode::asset_embedding_invalid);
  EXPECT_EQ(
      spoilt([](auto& v) { v.embedding[0].weights[2] = std::numeric_limits<double>::quiet_NaN(); }),
      IssueCode::asset_embedding_invalid);
  mesh_.tets[std::size_t(visual_.embedding[0].tet)][1] = Index(mesh_.nodes.size());
  EXPECT_EQ(code_of(visual_), outside);
}

TEST_F(VisualSurfaceTest, FollowsABodyOfAWorld) {
  SoftBodyContent content = test::make_content(mesh_, test::material_of(1e4, 0.4, 1000), 0.01);
  content.visual = visual_;
  const auto asset = SoftBodyAsset::create(std::move(content));
  ASSERT_TRUE(asset.ok());
  ASSERT_NE((*asset)->visual(), nullptr);
  World world = test::make_world({});
  const Mat3 rotation = test::turned(40, Vec3(1, 2, 3).normalized());
  const Vec3 shift(0, 5, 0);
  const BodyId body = test::add_soft(world, *asset, shift, rotation);
  std::vector<Point> vertices(500);
  ASSERT_TRUE(world.asset(body).visual()->positions(world.positions(body), vertices));
  for (std::size_t v = 0; v < vertices.size(); ++v) {
    const Vec3 expected = rotation * as_vec3(visual_.surface.vertices[v]) + shift;
    EXPECT_LT((as_vec3(vertices[v]) - expected).norm(), 1e-13) << v;
  }
}

TEST_F(VisualSurfaceTest, IsAbsentUnlessGiven) {
  const auto asset = test::make_body(mesh_, test::material_of(1e4, 0.4, 1000), 0.01);
  ASSERT_NE(asset, nullptr);
  EXPECT_EQ(asset->visual(), nullptr);
}

}  // namespace
}  // namespace souple
