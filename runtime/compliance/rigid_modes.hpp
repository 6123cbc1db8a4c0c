// SPDX-License-Identifier: MIT
#pragma once
#include <span>

#include "runtime/fem/linear_algebra.hpp"

namespace souple {

/// The rigid part of the rest compliance of a free body. K has the six rigid motions in its null space,
/// so that (a_M M + a_K K)^-1 holds them exactly as C_rigid = (M^-1 on rigid motions) / a_M, and what
/// is left, C0 - C_rigid, is positive semi-definite.
class RigidModes {
 public:
  RigidModes() = default;
  /// Lumped masses (kg) of the rest positions (m).
  RigidModes(std::span<const Point> rest_positions, std::span<const double> masses);

  /// Block of M^-1 on rigid motions between two points of the rest shape, 1/kg.
  Mat3 block(const Vec3& a, const Vec3& b) const;
  double inverse_mass() const { return inverse_mass_; }
  const Vec3& centre() const { return centre_; }
  const Mat3& inverse_inertia() const { return inverse_inertia_; }

 private:
  double inverse_mass_ = 0;
  Vec3 centre_ = Vec3::Zero();
  Mat3 inverse_inertia_ = Mat3::Zero();
};

}  // namespace souple
