// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/surface/soup_transfer.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace souple {
namespace {

TriangleSoup one_triangle() {
  TriangleSoup soup;
  soup.mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  soup.mesh.triangles = {{0, 1, 2}};
  soup.raw_vertex_count = 7;
  return soup;
}

TEST(SoupTransfer, CarriesASoupAcross) {
  const auto back = unpack_answer(pack_answer(one_triangle()));
  ASSERT_TRUE(back.ok());
  EXPECT_EQ(back->mesh.vertices, one_triangle().mesh.vertices);
  EXPECT_EQ(back->mesh.triangles, one_triangle().mesh.triangles);
  EXPECT_EQ(back->raw_vertex_count, 7u);
}

TEST(SoupTransfer, CarriesAnIssueAcrossWithPrintableText) {
  const auto back =
      unpack_answer(pack_answer(make_issue(IssueCode::surface_malformed, "a\nb\x1b[31m")));
  ASSERT_FALSE(back.ok());
  EXPECT_EQ(back.issue().code, IssueCode::surface_malformed);
  EXPECT_EQ(back.issue().what, "a b [31m");
}

TEST(SoupTransfer, RefusesEveryTruncation) {
  const std::string whole = pack_answer(one_triangle());
  for (std::size_t n = 0; n < whole.size(); ++n)
    EXPECT_FALSE(unpack_answer(std::string_view(whole).substr(0, n)).ok()) << n;
}

TEST(SoupTransfer, RefusesEveryFlippedByte) {
  const std::string whole = pack_answer(one_triangle());
  for (std::size_t n = 0; n < whole.size(); ++n) {
    std::string bytes = whole;
    bytes[n] = static_cast<char>(bytes[n] ^ 0x40);
    EXPECT_FALSE(unpack_answer(bytes).ok()) << n;
  }
}

TEST(SoupTransfer, RefusesIndicesOutOfRangeAndNumbersThatAreNotFinite) {
  TriangleSoup soup = one_triangle();
  soup.mesh.triangles[0][2] = 3;
  EXPECT_FALSE(unpack_answer(pack_answer(soup)).ok());
  soup = one_triangle();
  soup.mesh.vertices[1][1] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(unpack_answer(pack_answer(soup)).ok());
}

}  // namespace
}  // namespace souple
