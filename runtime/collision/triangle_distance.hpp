// SPDX-License-Identifier: MIT
#pragma once
#include <array>

#include "runtime/fem/linear_algebra.hpp"

namespace souple {

/// The point of a triangle nearest to another point, and which feature holds it.
struct ClosestOnTriangle {
  Vec3 point = Vec3::Zero();
  std::array<double, 3> weight{};  ///< barycentric
  /// 0-2: vertex k. 3-5: edge from vertex k-3 to the next. 6: the face.
  int feature = 6;
};

/// Ericson, Real-Time Collision Detection (2005), 5.1.5.
ClosestOnTriangle closest_on_triangle(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c);

}  // namespace souple
