// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/exchange/tets/sort_out_tets.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tools/exchange/tets/mesh_transfer.hpp"
#include "tools/exchange/tets/tet_pieces.hpp"

namespace souple {
namespace {

/// A corner tet at `origin` with legs of `size`; its nodes are added.
Tet add_corner(std::vector<Point>& nodes, const Point& origin, double size) {
  const auto first = static_cast<Index>(nodes.size());
  nodes.push_back(origin);
  for (std::size_t k = 0; k < 3; ++k) {
    Point p = origin;
    p[k] += size;
    nodes.push_back(p);
  }
  return {first, first + 1, first + 2, first + 3};
}

IssueCode refusal(const std::vector<Point>& nodes, const std::vector<Tet>& tets, bool mend = false) {
  const auto sorted = sort_out_tets(nodes, tets, {}, mend);
  EXPECT_FALSE(sorted.ok());
  return sorted.ok() ? IssueCode{} : sorted.issue().code;
}

TEST(SortOutTets, LetsPiecesThatTouchNowhereBe) {
  std::vector<Point> nodes;
  const std::vector<Tet> tets{add_corner(nodes, {0, 0, 0}, 1), add_corner(nodes, {5, 0, 0}, 1)};
  const auto sorted = sort_out_tets(nodes, tets, {3, 4}, false);
  ASSERT_TRUE(sorted.ok()) << format_issue(sorted.issue());
  EXPECT_EQ(sorted->tets, tets);
  EXPECT_EQ(sorted->labels, (std::vector<std::int64_t>{3, 4}));
}

TEST(SortOutTets, LeavesOutThePieceThatTouchesALargerOneAtANodeOrAnEdge) {
  for (const bool at_edge : {false, true}) {
    std::vector<Point> nodes;
    Tet small = add_corner(nodes, {1, 0, 0}, 0.5);
    Tet large = add_corner(nodes, {0, 0, 0}, 1);
    small[0] = large[1];
    if (at_edge) small[2] = large[2];
    EXPECT_EQ(refusal(nodes, {small, large}), IssueCode::tet_not_manifold);
    const auto sorted = sort_out_tets(nodes, {small, large}, {3, 4}, true);
    ASSERT_TRUE(sorted.ok()) << format_issue(sorted.issue());
    EXPECT_EQ(sorted->dropped_count, 1u);
    EXPECT_EQ(sorted->labels, std::vector<std::int64_t>{4});
  }
}

/// Tet i has the nodes i … i + 3 of a helix.
TEST(SortOutTets, SplitsTheNodeAtWhichAPieceMeetsItself) {
  std::vector<Point> nodes;
  for (int i = 0; i < 12; ++i) nodes.push_back({std::cos(2.4 * i), std::sin(2.4 * i), 0.4 * i});
  std::vector<Tet> tets;
  for (Index i = 0; i + 3 < 12; ++i) tets.push_back({i, i + 1, i + 2, i + 3});
  ASSERT_TRUE(sort_out_tets(nodes, tets, {}, true).ok());
  tets.back() = {9, 8, 10, 0};  // the strip bites its tail
  EXPECT_EQ(refusal(nodes, tets), IssueCode::tet_not_manifold);
  const auto sorted = sort_out_tets(nodes, tets, {}, true);
  ASSERT_TRUE(sorted.ok()) << format_issue(sorted.issue());
  EXPECT_EQ(sorted->split_node_count, 1u);
  EXPECT_EQ(sorted->tets.size(), 9u);
  EXPECT_EQ(sorted->nodes.back(), nodes.front());
}

TEST(SplitPinchedNodes, CopiesTheNodeForEveryFurtherGroup) {
  std::vector<Point> nodes;
  Tet a = add_corner(nodes, {0, 0, 0}, 1), b = add_corner(nodes, {1, 0, 0}, 1);
  b[0] = a[1];
  std::vector<Tet> tets{a, b};
  EXPECT_EQ(split_pinched_nodes(nodes, tets), 1u);
  EXPECT_EQ(tets[0], a);
  EXPECT_EQ(tets[1][0], static_cast<Index>(nodes.size() - 1));
  EXPECT_EQ(nodes.back(), (Point{1, 0, 0}));
  EXPECT_EQ(split_pinched_nodes(nodes, tets), 0u);
}

TEST(SortOutTets, CallsATetFlatByItsShapeNotItsSize) {
  for (const double size : {1e-50, 1e-3, 1.0, 1e12}) {
    const std::vector<Point> thin{{0, 0, 0}, {size, 0, 0}, {0, size, 0}, {0, 0, 1e-6 * size}};
    EXPECT_TRUE(sort_out_tets(thin, {{0, 1, 2, 3}}, {}, false).ok()) << size;
    const std::vector<Point> flat{{0, 0, 0}, {size, 0, 0}, {0, size, 0}, {size, size, 1e-13 * size}};
    EXPECT_EQ(refusal(flat, {{0, 1, 2, 3}}), IssueCode::tet_degenerate) << size;
  }
}

TEST(MeshTransfer, HandsBackTheMeshAndRefusesEveryTruncation) {
  RawMesh mesh;
  mesh.format = "gmsh 9";
  mesh.nodes = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  mesh.tets = {{0, 1, 2, 3}};
  mesh.triangles = {{0, 1, 2}};
  mesh.labels = {-5};
  mesh.label_names = {{-5, "bone"}, {7, ""}};
  mesh.other_cell_count = 11;
  const std::string packed = pack_raw_mesh(mesh);
  const auto read = unpack_raw_mesh(packed);
  ASSERT_TRUE(read.ok());
  EXPECT_EQ(read->format, mesh.format);
  EXPECT_EQ(read->nodes, mesh.nodes);
  EXPECT_EQ(read->tets, mesh.tets);
  EXPECT_EQ(read->triangles, mesh.triangles);
  EXPECT_EQ(read->labels, mesh.labels);
  EXPECT_EQ(read->label_names, mesh.label_names);
  EXPECT_EQ(read->other_cell_count, 11u);
  for (std::size_t size = 0; size < packed.size(); ++size)
    EXPECT_FALSE(unpack_raw_mesh(std::string_view(packed).substr(0, size)).ok()) << size;
  EXPECT_FALSE(unpack_raw_mesh(packed + "x").ok());
  mesh.tets = {{0, 1, 2, 4}};
  EXPECT_FALSE(unpack_raw_mesh(pack_raw_mesh(mesh)).ok());
  mesh.tets = {{0, 1, 2, 3}};
  mesh.nodes[0][0] = std::numeric_limits<double>::infinity();
  EXPECT_FALSE(unpack_raw_mesh(pack_raw_mesh(mesh)).ok());
}

}  // namespace
}  // namespace souple
