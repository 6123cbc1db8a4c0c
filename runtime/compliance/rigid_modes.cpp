// SPDX-License-Identifier: MIT
#include "runtime/compliance/rigid_modes.hpp"

#include "runtime/fem/cross_matrix.hpp"

namespace souple {

RigidModes::RigidModes(std::span<const Point> rest_positions, std::span<const double> masses) {
  double mass = 0;
  for (std::size_t k = 0; k < masses.size(); ++k) {
    mass += masses[k];
    centre_ += masses[k] * as_vec3(rest_positions[k]);
  }
  centre_ /= mass;
  inverse_mass_ = 1 / mass;
  Mat3 inertia = Mat3::Zero();
  for (std::size_t k = 0; k < masses.size(); ++k) {
    const Mat3 arm = cross_matrix(as_vec3(rest_positions[k]) - centre_);
    inertia -= masses[k] * arm * arm;
  }
  inverse_inertia_ = inertia.inverse();
}

Mat3 RigidModes::block(const Vec3& a, const Vec3& b) const {
  return inverse_mass_ * Mat3::Identity() -
         cross_matrix(a - centre_) * inverse_inertia_ * cross_matrix(b - centre_);
}

}  // namespace souple
