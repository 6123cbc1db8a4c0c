// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/surface/ply_text.hpp"

#include <gtest/gtest.h>

#include "tests/tools/real_surface.hpp"

namespace souple {
namespace {

const std::string header =
    "ply\nformat ascii 1.0\ncomment x\nelement vertex 3\nproperty float x\nproperty float y\n"
    "property uchar red\nproperty float z\nelement face 1\nproperty list uchar float texcoord\n"
    "property list uchar int vertex_indices\nend_header\n";
const std::string vertices = "0 0 9 1\n1 0 9 2\n\n0 1 9 3\n";

TEST(PlyText, KeepsPositionsAndCornersOfLinesWithMoreThanTheHeaderSays) {
  const auto plain = plain_ply_text(header + vertices + "2 0.5 0.5 3 0 1 2 7 7 7\r\n");
  ASSERT_TRUE(plain.has_value());
  EXPECT_EQ(*plain,
            "ply\nformat ascii 1.0\nelement vertex 3\nproperty double x\nproperty double y\n"
            "property double z\nelement face 1\nproperty list int int vertex_indices\nend_header\n"
            "0 0 1 \n1 0 2 \n0 1 3 \n3 0 1 2 \n");
}

TEST(PlyText, GivesUpOnEveryTruncationAndOnImpossibleCounts) {
  const std::string whole = header + vertices + "2 0.5 0.5 3 0 1 2";
  ASSERT_TRUE(plain_ply_text(whole).has_value());
  for (std::size_t length = 0; length < whole.size(); ++length)
    EXPECT_FALSE(plain_ply_text(whole.substr(0, length)).has_value()) << length;
  EXPECT_FALSE(plain_ply_text(header + vertices + "2 0.5 0.5 99999999999 0 1 2").has_value());
  EXPECT_FALSE(plain_ply_text(header + vertices + "2 0.5 0.5 18446744073709551615 0").has_value());
  EXPECT_FALSE(plain_ply_text("ply\nformat binary_little_endian 1.0\nend_header\n").has_value());
}

TEST(PlyText, LetsTheFuzeBeRead) {
  SOUPLE_NEEDS_REAL_SURFACES();
  const auto fuze = import_surface(real_surface_dir() / "fuze_ascii.ply", {});
  ASSERT_TRUE(fuze.ok()) << format_issue(fuze.issue());
  EXPECT_EQ(fuze->mesh.vertices.size(), 502u);
  EXPECT_EQ(fuze->mesh.triangles.size(), 1000u);
}

}  // namespace
}  // namespace souple
