// SPDX-License-Identifier: MIT
// A rigid sphere on an elastic half-space against closed forms (references 2.5, 2.7).
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "tests/support/indentation.hpp"

namespace souple {
namespace {

using namespace test;

constexpr double radius = 0.01, depth = 1e-4;

// Linear tets are too stiff here: 17 % at cells of a / 4, 9 % at a / 5, 8 % at a / 6.
TEST(Indentation, OfASphereIsHertzToATenth) {  // 2.5, block of 20 a
  const double coarse = hertz_error({10, 0.02, 4.5}, radius, depth),
               fine = hertz_error({14, 0.02, 4.5}, radius, depth);
  EXPECT_LT(std::abs(fine), 0.6 * std::abs(coarse)) << "it converges";
  EXPECT_LT(std::abs(fine), 0.1);
}

TEST(Indentation, ASphereMovedAsideIsHeldAsCattaneoAndMindlinHaveIt) {  // 2.7
  const GradedBlock block{10, 0.02, 4.5};
  const double mu = 0.5, shear = block.young / (2 * (1 + block.poisson)), a = std::sqrt(radius * depth);
  const std::vector<double> aside{0, 1e-5, 4e-5};
  const std::vector<Pressed> course = press(block, radius, depth, aside, mu);
  ASSERT_EQ(course.size(), 1 + aside.size());
  // The diagonals of the cells all lean one way: pressing alone leaves a small force aside.
  const double bias = course[1].tangential.x();
  for (std::size_t k = 1; k < aside.size(); ++k) {
    const double limit = mu * course[1 + k].normal;
    // d_t = 3 mu F (2 - nu) / (16 a G) (1 - (1 - Q / (mu F))^(2/3))
    const double full = 3 * limit * (2 - block.poisson) / (16 * a * shear);
    const double expected = aside[k] < full ? limit * (1 - std::pow(1 - aside[k] / full, 1.5)) : limit;
    EXPECT_NEAR(course[1 + k].tangential.x() - bias, expected, 0.12 * expected);
  }
}

// Each contact that carries more than 1e-4 of the load, whether it sticks, by its distance
// from the middle in cells from the circle of Cattaneo: negative within.
struct Stick {
  double cells;
  bool holds;
};

std::vector<Stick> sticking(const GradedBlock& block, const Pressed& now, double mu) {
  const double a = std::sqrt(radius * depth);
  const double c = a * std::cbrt(1 - now.tangential.norm() / (mu * now.normal));
  std::vector<Stick> found;
  for (const Touch& touch : now.touches) {
    const double normal = -touch.force.z(), tangential = touch.force.head<2>().norm();
    if (normal < 1e-4 * now.normal) continue;
    const double r = std::hypot(touch.point[0], touch.point[1]);
    found.push_back({(r - c) / cell_width(block, c), tangential < (1 - 1e-6) * mu * normal});
  }
  return found;
}

TEST(Indentation, SticksWithinTheCircleOfCattaneo) {  // 2.7: c = a (1 - Q / (mu F))^(1/3)
  const GradedBlock block{14, 0.02, 4.5};
  const double mu = 0.5;
  for (const double x : {0.8e-5, 2.4e-5, 3.6e-5}) {
    std::vector<Stick> found = sticking(block, press(block, radius, depth, {x}, mu).back(), mu);
    std::size_t holding = 0;
    for (const Stick& stick : found) {
      holding += stick.holds;
      EXPECT_TRUE(stick.holds || stick.cells > -1) << -stick.cells << " cells within, " << x;
    }
    std::sort(found.begin(), found.end(), [](auto& s, auto& t) { return s.cells < t.cells; });
    ASSERT_LT(holding, found.size()) << "an outer ring always slips";
    EXPECT_NEAR(found[holding].cells, 0, 0.4) << "the circle with as many as hold, " << x;
  }
}

}  // namespace
}  // namespace souple
