// SPDX-License-Identifier: MIT
#pragma once
#include "runtime/fem/corotational_model.hpp"

namespace souple {

/// Of a body that moves as one piece.
struct RigidVelocity {
  Vec3 centre = Vec3::Zero();   ///< m
  Vec3 linear = Vec3::Zero();   ///< of the centre, m/s
  Vec3 angular = Vec3::Zero();  ///< rad/s
  Vec3 at(const Vec3& point) const { return linear + angular.cross(point - centre); }
};

/// The one with the linear and angular momentum of a body at `x` with velocities `v` (3n, m and m/s).
RigidVelocity rigid_velocity(const CorotationalModel& model, const Eigen::VectorXd& x,
                             const Eigen::VectorXd& v);

}  // namespace souple
