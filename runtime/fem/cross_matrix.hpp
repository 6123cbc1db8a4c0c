// SPDX-License-Identifier: MIT
#pragma once
#include "runtime/fem/linear_algebra.hpp"

namespace souple {

/// The matrix of v -> a x v.
inline Mat3 cross_matrix(const Vec3& a) {
  Mat3 m;
  m << 0, -a.z(), a.y(), a.z(), 0, -a.x(), -a.y(), a.x(), 0;
  return m;
}

}  // namespace souple
