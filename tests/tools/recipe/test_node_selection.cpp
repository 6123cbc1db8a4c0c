// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/recipe/node_selection.hpp"

#include <gtest/gtest.h>

namespace souple {
namespace {

/// 4 x 4 x 4 points of spacing 1 from the origin; index = x + 4 y + 16 z.
std::vector<Point> grid() {
  std::vector<Point> nodes;
  for (int z = 0; z < 4; ++z)
    for (int y = 0; y < 4; ++y)
      for (int x = 0; x < 4; ++x)
        nodes.push_back({static_cast<double>(x), static_cast<double>(y), static_cast<double>(z)});
  return nodes;
}

std::vector<Index> selected(const NodeSelection& selection) {
  const auto set = select_nodes({"s", selection}, grid());
  EXPECT_TRUE(set.ok());
  return set.ok() ? set->nodes : std::vector<Index>{};
}

TEST(NodeSelection, BoxHoldsItsBorder) {
  EXPECT_EQ(selected(BoxSelection{{0, 0, 0}, {1, 0, 1}}), (std::vector<Index>{0, 1, 16, 17}));
}

TEST(NodeSelection, SphereHoldsItsBorder) {
  EXPECT_EQ(selected(SphereSelection{{0, 0, 0}, 1}), (std::vector<Index>{0, 1, 4, 16}));
}

TEST(NodeSelection, PlaneSelectsBelowWhateverTheLengthOfTheNormal) {
  std::vector<Index> lowest;
  for (Index i = 0; i < 16; ++i) lowest.push_back(i);
  EXPECT_EQ(selected(PlaneSelection{{5, 5, 0.5}, {0, 0, 7}, 0}), lowest);
  EXPECT_EQ(selected(PlaneSelection{{0, 0, 0}, {0, 0, 7}, 0.5}), lowest);
  EXPECT_EQ(selected(PlaneSelection{{0, 0, 0}, {0, 0, 7}, 0}), lowest);
}

TEST(NodeSelection, NearestBreaksTiesByIndex) {
  EXPECT_EQ(selected(NearestSelection{{0, 0, 0}, 2}), (std::vector<Index>{0, 1}));
  EXPECT_EQ(selected(NearestSelection{{3, 3, 3}, 1}), (std::vector<Index>{63}));
}

TEST(NodeSelection, RefusesNoneAndAllAndNamesTheBox) {
  for (const NodeSelection& selection :
       {NodeSelection{SphereSelection{{9, 9, 9}, 1}}, NodeSelection{NearestSelection{{0, 0, 0}, 64}},
        NodeSelection{NearestSelection{{0, 0, 0}, 1'000'000'000}},
        NodeSelection{BoxSelection{{-1, -1, -1}, {9, 9, 9}}}}) {
    const auto set = select_nodes({"s", selection}, grid());
    ASSERT_FALSE(set.ok());
    EXPECT_EQ(set.issue().code, IssueCode::fixed_set_invalid);
    EXPECT_NE(set.issue().mend.find("[3, 3, 3]"), std::string::npos) << set.issue().mend;
  }
}

TEST(NodeSelection, ARegionMayHoldAllNodesButNotNone) {
  const auto all = select_region(BoxSelection{{-1, -1, -1}, {9, 9, 9}}, grid(), "here");
  ASSERT_TRUE(all.ok());
  EXPECT_EQ(all->size(), 64u);
  const auto none = select_region(SphereSelection{{9, 9, 9}, 1}, grid(), "[[compliance]] tip");
  ASSERT_FALSE(none.ok());
  EXPECT_EQ(none.issue().code, IssueCode::compliance_region_empty);
  EXPECT_EQ(none.issue().where, "[[compliance]] tip");
  EXPECT_NE(none.issue().mend.find("[3, 3, 3]"), std::string::npos) << none.issue().mend;
}

}  // namespace
}  // namespace souple
