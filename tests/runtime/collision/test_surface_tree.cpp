// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <random>

#include "runtime/collision/surface_tree.hpp"
#include "tests/support/box_mesh.hpp"

namespace souple {
namespace {

TEST(DeformedSurface, FindsTheSameTriangleDistanceAsBruteForceAfterDeformation) {
  const MeshLevel level = test::level_of(test::box_mesh({6, 5, 4}, {0, 0, 0}, {1, 1, 1}));
  const SurfaceTree tree(level.mesh.nodes, level.boundary);
  DeformedSurface surface(tree);
  std::mt19937 random(5);
  std::uniform_real_distribution<double> uniform(-0.3, 1.3), shake(-0.04, 0.04);
  Eigen::VectorXd x(3 * Eigen::Index(level.mesh.nodes.size()));
  int inside_hits = 0;
  for (int shape = 0; shape < 20; ++shape) {
    for (Eigen::Index k = 0; k < x.size(); ++k)
      x[k] = level.mesh.nodes[std::size_t(k / 3)][std::size_t(k % 3)] + shake(random);
    surface.refit(x);
    for (int probe = 0; probe < 100; ++probe) {
      const Vec3 p(uniform(random), uniform(random), uniform(random));
      const double radius = 0.3;
      double best = radius;
      for (const Triangle& t : level.boundary)
        best = std::min(best, (p - closest_on_triangle(p, node_entry(x, t[0]), node_entry(x, t[1]),
                                                       node_entry(x, t[2]))
                                       .point)
                                  .norm());
      const SurfaceHit hit = surface.closest(p, radius);
      EXPECT_NEAR(hit.distance, best, 1e-13);
      EXPECT_EQ(hit.triangle >= 0, best < radius);
      inside_hits += hit.triangle >= 0;
    }
  }
  EXPECT_GT(inside_hits, 500);
}

TEST(DeformedSurface, PseudoNormalsTellInsideFromOutside) {
  const MeshLevel level = test::level_of(test::box_mesh({3, 3, 3}, {0, 0, 0}, {1, 1, 1}));
  const SurfaceTree tree(level.mesh.nodes, level.boundary);
  DeformedSurface surface(tree);
  Eigen::VectorXd x(3 * Eigen::Index(level.mesh.nodes.size()));
  for (Eigen::Index k = 0; k < x.size(); ++k)
    x[k] = level.mesh.nodes[std::size_t(k / 3)][std::size_t(k % 3)];
  surface.refit(x);
  std::mt19937 random(6);
  std::uniform_real_distribution<double> uniform(-0.2, 1.2);
  for (int probe = 0; probe < 2000; ++probe) {
    const Vec3 p(uniform(random), uniform(random), uniform(random));
    const bool inside = (p.array() > 0).all() && (p.array() < 1).all();
    const SurfaceHit hit = surface.closest(p, 2);
    ASSERT_GE(hit.triangle, 0);
    EXPECT_EQ((p - hit.closest.point).dot(surface.pseudo_normal(hit)) < 0, inside);
  }
}

TEST(SurfaceTree, EmptySurfaceHasNothingToHit) {
  const SurfaceTree tree(std::vector<Point>{}, {});
  const DeformedSurface surface(tree);
  EXPECT_LT(surface.closest(Vec3::Zero(), 1).triangle, 0);
}

}  // namespace
}  // namespace souple
