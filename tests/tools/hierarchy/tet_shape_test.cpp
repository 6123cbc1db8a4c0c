// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/hierarchy/tet_shape.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tools/geometry/vector.hpp"

namespace souple {
namespace {

TEST(MeanRatio, IsOneForTheRegularTetAndSignedByOrientation) {
  const Point a{1, 1, 1}, b{1, -1, -1}, c{-1, 1, -1}, d{-1, -1, 1};
  EXPECT_NEAR(std::abs(mean_ratio(a, b, c, d)), 1, 1e-15);
  EXPECT_EQ(mean_ratio(a, b, c, d), -mean_ratio(b, a, c, d));
  EXPECT_EQ(mean_ratio(a, b, c, scaled(add(a, b), 0.5)), 0);
  EXPECT_EQ(mean_ratio(a, a, a, a), 0);
}

TEST(MeanRatio, KnowsNoScale) {
  const Point a{0, 0, 0}, b{1, 0.1, 0}, c{0.2, 1, 0}, d{0.1, 0.3, 0.8};
  const double s = 1e-3;
  EXPECT_NEAR(mean_ratio(a, b, c, d),
              mean_ratio(scaled(a, s), scaled(b, s), scaled(c, s), scaled(d, s)), 1e-15);
}

TEST(Distortion, IsTheInverseCubeOfTheMeanRatio) {
  const Point a{0, 0, 0}, b{1, 0.1, 0}, c{0.2, 1, 0}, d{0.1, 0.3, 0.8};
  const double q = mean_ratio(a, b, c, d);
  ASSERT_GT(q, 0);
  EXPECT_NEAR(distortion_value(a, b, c, d) * q * q * q, 1, 1e-14);
  EXPECT_NEAR(distortion(a, b, c, d).value / distortion_value(a, b, c, d), 1, 1e-14);
  EXPECT_EQ(distortion_value(a, c, b, d), std::numeric_limits<double>::infinity());
}

TEST(Distortion, HasTheDerivativesOfFiniteDifferences) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> noise(-0.3, 0.3);
  for (int i = 0; i < 20; ++i) {
    const auto near = [&](double x, double y, double z) {
      return Point{x + noise(random), y + noise(random), z + noise(random)};
    };
    const Point x = near(0, 0, 0), b = near(2, 0, 0), c = near(0, 2, 0), d = near(0, 0, 2);
    const Distortion here = distortion(x, b, c, d);
    constexpr double h = 1e-5;
    constexpr std::size_t entry[3][3] = {{0, 3, 4}, {3, 1, 5}, {4, 5, 2}};
    for (std::size_t k = 0; k < 3; ++k) {
      Point up = x, down = x;
      up[k] += h;
      down[k] -= h;
      const Distortion above = distortion(up, b, c, d), below = distortion(down, b, c, d);
      EXPECT_NEAR(here.log_gradient[k], (std::log(above.value) - std::log(below.value)) / (2 * h),
                  1e-7);
      for (std::size_t j = 0; j < 3; ++j)
        EXPECT_NEAR(here.log_hessian[entry[k][j]],
                    (above.log_gradient[j] - below.log_gradient[j]) / (2 * h), 1e-6);
    }
  }
}

}  // namespace
}  // namespace souple
