// SPDX-License-Identifier: MIT
// Rotations of device poses as quaternions and rotation vectors. Internal to devices.
#pragma once
#include <Eigen/Geometry>
#include <cmath>

#include "runtime/fem/linear_algebra.hpp"
#include "runtime/world/settings.hpp"

namespace souple {

inline Eigen::Quaterniond quaternion_of(const Pose& pose) {
  return {pose.rotation[0], pose.rotation[1], pose.rotation[2], pose.rotation[3]};
}

inline void set_rotation(Pose& pose, const Eigen::Quaterniond& q) {
  pose.rotation = {q.w(), q.x(), q.y(), q.z()};
}

/// Axis times angle, the shorter way round: angle in [0, pi].
inline Vec3 rotation_vector(Eigen::Quaterniond q) {
  if (q.w() < 0) q.coeffs() = -q.coeffs();
  const double sine = q.vec().norm();
  if (sine < 1e-12) return 2 * q.vec();
  return q.vec() * (2 * std::atan2(sine, q.w()) / sine);
}

inline Eigen::Quaterniond turn_by(const Vec3& rotation_vector) {
  const double angle = rotation_vector.norm();
  Eigen::Quaterniond q;
  q.w() = std::cos(angle / 2);
  q.vec() = rotation_vector * (angle < 1e-12 ? 0.5 : std::sin(angle / 2) / angle);
  return q.normalized();
}

}  // namespace souple
