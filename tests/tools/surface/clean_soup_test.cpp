// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/surface/clean_soup.hpp"

#include <gtest/gtest.h>

namespace souple {
namespace {

TEST(CleanSoup, MergesVerticesAtTheSamePosition) {
  const CleanedSoup cleaned = clean_soup(
      {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 0, 0}, {-0.0, 1, 0}, {1, 1, 0}}, {{0, 1, 2}, {3, 5, 4}}});
  EXPECT_EQ(cleaned.merged_vertex_count, 4u);
  EXPECT_EQ(cleaned.mesh.triangles, (std::vector<Triangle>{{0, 1, 2}, {1, 3, 2}}));
}

TEST(CleanSoup, DropsDegenerateAndRepeatedTriangles) {
  const CleanedSoup cleaned = clean_soup({{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {2, 0, 0}, {0, 0, 0}},
                                          {{0, 1, 2}, {2, 1, 0}, {0, 1, 3}, {0, 4, 1}, {1, 2, 4}}});
  EXPECT_EQ(cleaned.mesh.triangles.size(), 1u);
  EXPECT_EQ(cleaned.dropped_triangle_count, 4u);
}

TEST(CleanSoup, LeavesOutVerticesNobodyUses) {
  const CleanedSoup cleaned = clean_soup({{{9, 9, 9}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{1, 2, 3}}});
  EXPECT_EQ(cleaned.mesh.vertices.size(), 3u);
  EXPECT_EQ(cleaned.merged_vertex_count, 4u);
}

TEST(CleanSoup, KeepsTinyTrianglesOfTinyMeshes) {
  const CleanedSoup cleaned = clean_soup({{{0, 0, 0}, {1e-200, 0, 0}, {0, 1e-200, 0}}, {{0, 1, 2}}});
  EXPECT_EQ(cleaned.mesh.triangles.size(), 1u);
}

}  // namespace
}  // namespace souple
