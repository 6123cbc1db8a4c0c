// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <cmath>

#include "tools/volume/tetrahedralize.hpp"

namespace souple {
namespace {

TEST(TetQuality, OfTheRegularTetIsTheBest) {
  const TetMesh regular{{{1, 1, 1}, {-1, -1, 1}, {-1, 1, -1}, {1, -1, -1}}, {{0, 2, 1, 3}}};
  TetQuality quality = measure_tet_quality(regular);
  if (quality.volume_m3 < 0) quality = measure_tet_quality({regular.nodes, {{0, 1, 2, 3}}});
  EXPECT_NEAR(quality.min_dihedral_deg, std::acos(1.0 / 3) * 180 / M_PI, 1e-12);
  EXPECT_NEAR(quality.median_dihedral_deg, quality.min_dihedral_deg, 1e-12);
  EXPECT_NEAR(quality.worst_radius_ratio, 1, 1e-12);
  EXPECT_NEAR(quality.worst_aspect, 1, 1e-12);
  EXPECT_NEAR(quality.volume_m3, 8.0 / 3, 1e-12);
}

TEST(TetQuality, OfTheCornerOfACube) {
  const TetQuality quality =
      measure_tet_quality({{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {{0, 1, 2, 3}}});
  EXPECT_NEAR(quality.min_dihedral_deg, std::acos(1 / std::sqrt(3)) * 180 / M_PI, 1e-12);
  // r_in = 1 / (3 + sqrt 3), r_circ = sqrt(3) / 2
  EXPECT_NEAR(quality.worst_radius_ratio, 3 / (3 + std::sqrt(3)) * 2 / std::sqrt(3), 1e-12);
  // Longest edge sqrt 2 over the height 1 / sqrt 3 above the slanted face, over sqrt(3/2).
  EXPECT_NEAR(quality.worst_aspect, 2, 1e-12);
}

TEST(TetQuality, OfFlatAndInvertedTetsIsZero) {
  const TetQuality flat =
      measure_tet_quality({{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}}, {{0, 1, 2, 3}}});
  EXPECT_EQ(flat.min_dihedral_deg, 0);
  EXPECT_EQ(flat.worst_radius_ratio, 0);
  EXPECT_GT(flat.worst_aspect, 1e100);
  const TetQuality inverted =
      measure_tet_quality({{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {{0, 2, 1, 3}}});
  EXPECT_EQ(inverted.min_dihedral_deg, 0);
  EXPECT_LT(inverted.volume_m3, 0);
}

TEST(TetQuality, IsTheSameInAnyUnit) {
  for (const double unit : {1e-6, 1.0, 1e6}) {
    const TetQuality quality = measure_tet_quality(
        {{{0, 0, 0}, {unit, 0, 0}, {0, 2 * unit, 0}, {0, 0, 3 * unit}}, {{0, 1, 2, 3}}});
    // r_in = 1/3 and r_circ = sqrt(14) / 2 of the corner of a box of sides 1, 2, 3.
    EXPECT_NEAR(quality.worst_radius_ratio, 2 / std::sqrt(14), 1e-12) << unit;
  }
}

}  // namespace
}  // namespace souple
