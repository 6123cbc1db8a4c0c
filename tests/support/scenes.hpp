// SPDX-License-Identifier: MIT
#pragma once
#include <memory>
#include <string>

#include "runtime/fem/linear_algebra.hpp"
#include "runtime/world/soft_body_asset.hpp"
#include "runtime/world/world.hpp"

namespace souple::test {

/// Parts of small scenes. All of them fail the test that calls them if the world refuses.
World make_world(const WorldSettings& settings);
BodyId add_soft(World& world, std::shared_ptr<const SoftBodyAsset> asset, const Vec3& position,
                const Mat3& rotation = Mat3::Identity(), const Vec3& velocity = Vec3::Zero(),
                const std::string& fixed_set = {});
BodyId add_plane(World& world, const Mat3& rotation = Mat3::Identity(),
                 const Vec3& point = Vec3::Zero());
BodyId add_sphere(World& world, double radius, const Vec3& centre);
BodyId add_box(World& world, const Point& half_extents, const Vec3& centre,
               const Mat3& rotation = Mat3::Identity());
StepReport step(World& world);

Pose pose_of(const Mat3& rotation, const Vec3& translation);
Mat3 turned(double degrees, const Vec3& axis);
Vec3 centre_of_mass(const World& world, BodyId body);
Vec3 mean_velocity(const World& world, BodyId body);
/// Sum of the contact forces on `body`.
Vec3 contact_force(const World& world, BodyId body);
/// Gives every node of the body this velocity, positions unchanged.
void set_velocity(World& world, BodyId body, const Vec3& velocity);

}  // namespace souple::test
