// SPDX-License-Identifier: MIT
#pragma once
#include "runtime/fem/linear_algebra.hpp"
#include "runtime/world/settings.hpp"

namespace souple {

/// Where a rigid body is: x_world = rotation x_local + translation.
struct RigidPlacement {
  Mat3 rotation = Mat3::Identity();
  Vec3 translation = Vec3::Zero();
};

/// `pose` with its quaternion normalised, as a matrix.
RigidPlacement placement(const Pose& pose);

/// Signed distance of a point from a shape's surface (< 0 inside) and the outward unit normal there.
/// The normal at a centre or a ridge, where it is not unique, is one of those that are nearest. Of
/// analytic shapes only: a mesh has its surface tree, here it is nowhere near.
struct SignedDistance {
  double distance = 0;
  Vec3 normal = Vec3::UnitZ();
};
SignedDistance signed_distance(const RigidShape& shape, const RigidPlacement& at, const Vec3& point);

}  // namespace souple
