// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/geometry/surface_measure.hpp"

#include <gtest/gtest.h>

namespace souple {
namespace {

const std::vector<Triangle> tetrahedron{{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};

TEST(SurfaceMeasure, FindsAClosedShellSound) {
  const SurfaceTopology found = measure_topology(tetrahedron, 4);
  EXPECT_TRUE(found.closed_oriented_manifold());
  EXPECT_EQ(found.shell_count, 1u);
  const TriangleMesh mesh{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, tetrahedron};
  EXPECT_NEAR(signed_volume(mesh), 1.0 / 6, 1e-15);
}

TEST(SurfaceMeasure, CountsTheEdgesOfAHole) {
  std::vector<Triangle> open = tetrahedron;
  open.pop_back();
  EXPECT_EQ(measure_topology(open, 4).boundary_edge_count, 3u);
}

TEST(SurfaceMeasure, CountsOpposedNeighbours) {
  std::vector<Triangle> turned = tetrahedron;
  std::swap(turned[0][0], turned[0][1]);
  EXPECT_EQ(measure_topology(turned, 4).opposed_edge_count, 3u);
}

TEST(SurfaceMeasure, TellsATouchingVertexFromATouchingEdge) {
  std::vector<Triangle> vertex = tetrahedron;
  for (const Triangle& t : tetrahedron) vertex.push_back({t[0] + 3, t[1] + 3, t[2] + 3});
  const SurfaceTopology at_vertex = measure_topology(vertex, 7);
  EXPECT_EQ(at_vertex.nonmanifold_vertex_count, 1u);
  EXPECT_EQ(at_vertex.nonmanifold_edge_count, 0u);
  std::vector<Triangle> edge = tetrahedron;
  for (const Triangle& t : tetrahedron) edge.push_back({t[0] + 2, t[1] + 2, t[2] + 2});
  EXPECT_EQ(measure_topology(edge, 6).nonmanifold_edge_count, 1u);
}

TEST(SurfaceMeasure, NumbersShellsInTheOrderOfTheirFirstTriangle) {
  EXPECT_EQ(shell_of_triangles({{3, 4, 5}, {0, 1, 2}, {5, 6, 7}}, 8), (std::vector<Index>{0, 1, 0}));
}

}  // namespace
}  // namespace souple
