// SPDX-License-Identifier: MIT
// What only a fine mesh shows of a sphere on an elastic half-space (reference 2.5).
#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/indentation.hpp"

namespace souple::test {
namespace {

// 42 592 cells, a / 8 wide where the sphere touches, of a block of 40 a.
TEST(IndentationFine, OfASphereIsHertzToATwentieth) {
  const GradedBlock block{22, 0.04, 5};
  EXPECT_LT(std::abs(hertz_error(block, 0.01, 1e-4)), 0.05);
}

}  // namespace
}  // namespace souple::test
