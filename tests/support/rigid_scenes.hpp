// SPDX-License-Identifier: MIT
// Free rigid bodies for small scenes.
#pragma once
#include "tests/support/scenes.hpp"

namespace souple::test {

RigidShape sphere_shape(double radius);
RigidShape box_shape(const Point& half_extents);
RigidShape capsule_shape(double radius, double half_length);  ///< along local z

/// A rigid body that forces move; fails the test if the world refuses.
BodyId add_free(World& world, const RigidShape& shape, const Vec3& position,
                const Mat3& rotation = Mat3::Identity(), const FreeRigidMotion& motion = {});
/// A rigid body that moves along keyframes.
BodyId add_driven(World& world, const RigidShape& shape, std::vector<Keyframe> path);

FreeRigidMotion moving(const Vec3& velocity, const Vec3& spin = Vec3::Zero());
FreeRigidMotion weighing(double mass_kg);
Vec3 place_of(const World& world, BodyId rigid_body);
Vec3 speed_of(const World& world, BodyId rigid_body);
/// Kinetic, elastic and potential.
double energy_of(const StepReport& report);
/// Sum of the contact forces of `body` on `other`, by the contact events.
Vec3 event_force(const World& world, BodyId body, BodyId other);
/// Gravity of 9.81 m/s2 as a slope around y has it: downhill is +x.
Point gravity_on_slope(double degrees);

}  // namespace souple::test
