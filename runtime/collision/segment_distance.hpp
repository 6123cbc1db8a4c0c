// SPDX-License-Identifier: MIT
#pragma once
#include "runtime/fem/linear_algebra.hpp"

namespace souple {

/// Points of two segments that are nearest to each other: from + along (to - from), 0 to 1.
struct SegmentPair {
  double along_a = 0, along_b = 0;
  Vec3 a = Vec3::Zero(), b = Vec3::Zero();
};

/// Ericson, Real-Time Collision Detection (2005), 5.1.9; segments may be points.
SegmentPair closest_of_segments(const Vec3& a_from, const Vec3& a_to, const Vec3& b_from,
                                const Vec3& b_to);

}  // namespace souple
