// SPDX-License-Identifier: MIT
#pragma once
#include "formats/core/result.hpp"
#include "runtime/fem/linear_algebra.hpp"

namespace souple {

/// One degree of freedom: a mass with its own damping that a spring and damper hold to a moving place.
///   m x'' + c x' + b (x' - p') + k (x - p) = F
/// in kg, N s/m, N/m, or kg m^2, N m s/rad, N m/rad.
struct HeldMass {
  double mass = 0;
  double own_damping = 0;   ///< c, of the device, against the world
  double hand_damping = 0;  ///< b
  double hand_stiffness = 0;
};

/// A tick of such a mass with F constant and p going evenly: exact to rounding, from the exponential of
/// the system matrix, at any stiffness.
class HeldMassStep {
 public:
  /// Issue world_parameter_invalid: a mass that is not positive, a negative coefficient, no number.
  static Result<HeldMassStep> create(const HeldMass& parameters, double tick_s);

  /// `offset` = x - p and its rate `x' - p'`, each axis alike, to the end of the tick; `place_rate` =
  /// p'.
  void advance(Vec3& offset, Vec3& rate, const Vec3& place_rate, const Vec3& force) const;

 private:
  double own_damping_ = 0;
  Eigen::Matrix<double, 2, 3> step_ =
      Eigen::Matrix<double, 2, 3>::Zero();  ///< of (offset, rate, force)
};

}  // namespace souple
