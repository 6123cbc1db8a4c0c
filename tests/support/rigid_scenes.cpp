// SPDX-License-Identifier: MIT
#include "tests/support/rigid_scenes.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace souple::test {

RigidShape sphere_shape(double radius) {
  RigidShape shape;
  shape.kind = RigidShapeKind::sphere;
  shape.radius_m = radius;
  return shape;
}

RigidShape box_shape(const Point& half_extents) {
  RigidShape shape;
  shape.kind = RigidShapeKind::box;
  shape.half_extents_m = half_extents;
  return shape;
}

RigidShape capsule_shape(double radius, double half_length) {
  RigidShape shape;
  shape.kind = RigidShapeKind::capsule;
  shape.radius_m = radius;
  shape.half_length_m = half_length;
  return shape;
}

namespace {

BodyId added(World& world, const RigidBodyDescription& description) {
  const auto body = world.add_rigid_body(description);
  EXPECT_TRUE(body.ok()) << (body.ok() ? "" : format_issue(body.issue()));
  return body.ok() ? *body : BodyId{};
}

}  // namespace

BodyId add_free(World& world, const RigidShape& shape, const Vec3& position, const Mat3& rotation,
                const FreeRigidMotion& motion) {
  RigidBodyDescription description;
  description.name = "free";
  description.shape = shape;
  description.path = {{0, pose_of(rotation, position)}};
  description.free = motion;
  return added(world, description);
}

BodyId add_driven(World& world, const RigidShape& shape, std::vector<Keyframe> path) {
  RigidBodyDescription description;
  description.name = "driven";
  description.shape = shape;
  description.path = std::move(path);
  return added(world, description);
}

FreeRigidMotion moving(const Vec3& velocity, const Vec3& spin) {
  FreeRigidMotion motion;
  motion.velocity_m_s = as_point(velocity);
  motion.angular_velocity_rad_s = as_point(spin);
  return motion;
}

FreeRigidMotion weighing(double mass_kg) {
  FreeRigidMotion motion;
  motion.mass_kg = mass_kg;
  return motion;
}

Vec3 place_of(const World& world, BodyId rigid_body) {
  return as_vec3(world.rigid_pose(rigid_body).translation);
}

Vec3 speed_of(const World& world, BodyId rigid_body) {
  return as_vec3(world.rigid_velocity(rigid_body));
}

double energy_of(const StepReport& report) {
  return report.kinetic_energy_j + report.elastic_energy_j + report.potential_energy_j;
}

Vec3 event_force(const World& world, BodyId body, BodyId other) {
  for (const ContactEvent& event : world.contact_events()) {
    if (event.body_a == other && event.body_b == body) return as_vec3(event.force_n);
    if (event.body_a == body && event.body_b == other) return -as_vec3(event.force_n);
  }
  return Vec3::Zero();
}

Point gravity_on_slope(double degrees) {
  const double slope = degrees * std::numbers::pi / 180;
  return {9.81 * std::sin(slope), 0, -9.81 * std::cos(slope)};
}

}  // namespace souple::test
