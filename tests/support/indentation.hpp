// SPDX-License-Identifier: MIT
// A rigid sphere pressed into an elastic block and moved aside: Hertz, Cattaneo and Mindlin.
#pragma once
#include <vector>

#include "tests/support/rigid_scenes.hpp"

namespace souple::test {

/// Of the block: a cube's upper half of 2n x 2n x n cells, `size` m deep and to each side, graded by
/// sinh towards the middle of its top.
struct GradedBlock {
  int half_cells;
  double size;
  double grading;
  double young = 1e4;
  double poisson = 0.3;
};

/// The width of the block's cells `r` m from the middle along x or y.
double cell_width(const GradedBlock& block, double r);

/// Where the sphere touches, with the force on the block there.
struct Touch {
  Point point{};
  Vec3 force = Vec3::Zero();
};

struct Pressed {
  double normal = 0;  ///< N
  Vec3 tangential = Vec3::Zero();
  std::vector<Touch> touches;
};

/// The sphere of `radius` goes `depth` down, then aside along x to each place of `aside` (m) in turn:
/// how the block is pressed after the descent, then after each of them.
std::vector<Pressed> press(const GradedBlock& block, double radius, double depth,
                           const std::vector<double>& aside, double friction);

/// By what part the force is not the one of Hertz, 4/3 E / (1 - nu^2) sqrt(R) d^(3/2).
double hertz_error(const GradedBlock& block, double radius, double depth);

}  // namespace souple::test
