// SPDX-License-Identifier: MIT
#include "runtime/collision/rigid_distance.hpp"

#include <algorithm>
#include <limits>

namespace souple {
namespace {

SignedDistance sphere_distance(double radius, const Vec3& local) {
  const double length = local.norm();
  return {length - radius, length > 0 ? Vec3(local / length) : Vec3::UnitZ()};
}

SignedDistance box_distance(const Vec3& half, const Vec3& local) {
  const Vec3 beyond = local.cwiseAbs() - half;
  if ((beyond.array() > 0).any()) {
    const Vec3 outside = local - local.cwiseMax(-half).cwiseMin(half);
    const double length = outside.norm();
    return {length, outside / length};
  }
  Eigen::Index face = 0;
  const double depth = beyond.maxCoeff(&face);
  return {depth, (local[face] < 0 ? -1.0 : 1.0) * Vec3::Unit(face)};
}

}  // namespace

RigidPlacement placement(const Pose& pose) {
  const Eigen::Quaterniond q(pose.rotation[0], pose.rotation[1], pose.rotation[2], pose.rotation[3]);
  return {q.normalized().toRotationMatrix(), as_vec3(pose.translation)};
}

SignedDistance signed_distance(const RigidShape& shape, const RigidPlacement& at, const Vec3& point) {
  const Vec3 local = at.rotation.transpose() * (point - at.translation);
  SignedDistance result;
  switch (shape.kind) {
    case RigidShapeKind::plane:
      result = {local.z(), Vec3::UnitZ()};
      break;
    case RigidShapeKind::sphere:
      result = sphere_distance(shape.radius_m, local);
      break;
    case RigidShapeKind::box:
      result = box_distance(as_vec3(shape.half_extents_m), local);
      break;
    case RigidShapeKind::capsule:
      result = sphere_distance(
          shape.radius_m,
          local - std::clamp(local.z(), -shape.half_length_m, shape.half_length_m) * Vec3::UnitZ());
      break;
    case RigidShapeKind::mesh:
      result = {std::numeric_limits<double>::infinity(), Vec3::UnitZ()};
      break;
  }
  result.normal = at.rotation * result.normal;
  return result;
}

}  // namespace souple
