// SPDX-License-Identifier: MIT
#include "tests/support/scenes.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace souple::test {
namespace {

BodyId added(const Result<BodyId>& body) {
  EXPECT_TRUE(body.ok()) << (body.ok() ? "" : format_issue(body.issue()));
  return *body;
}

RigidBodyDescription fixed(const std::string& name, const Pose& pose) {
  RigidBodyDescription description;
  description.name = name;
  description.path = {{0, pose}};
  return description;
}

}  // namespace

World make_world(const WorldSettings& settings) {
  auto world = World::create(settings);
  EXPECT_TRUE(world.ok());
  return std::move(*world);
}

BodyId add_soft(World& world, std::shared_ptr<const SoftBodyAsset> asset, const Vec3& position,
                const Mat3& rotation, const Vec3& velocity, const std::string& fixed_set) {
  SoftBodyDescription description;
  description.name = "soft";
  description.pose = pose_of(rotation, position);
  description.velocity_m_s = as_point(velocity);
  description.fixed_set = fixed_set;
  return added(world.add_soft_body(std::move(asset), description));
}

BodyId add_plane(World& world, const Mat3& rotation, const Vec3& point) {
  return added(world.add_rigid_body(fixed("plane", pose_of(rotation, point))));
}

BodyId add_sphere(World& world, double radius, const Vec3& centre) {
  auto description = fixed("sphere", pose_of(Mat3::Identity(), centre));
  description.shape.kind = RigidShapeKind::sphere;
  description.shape.radius_m = radius;
  return added(world.add_rigid_body(description));
}

BodyId add_box(World& world, const Point& half_extents, const Vec3& centre, const Mat3& rotation) {
  auto description = fixed("box", pose_of(rotation, centre));
  description.shape.kind = RigidShapeKind::box;
  description.shape.half_extents_m = half_extents;
  return added(world.add_rigid_body(description));
}

StepReport step(World& world) {
  auto report = world.step();
  EXPECT_TRUE(report.ok()) << (report.ok() ? "" : format_issue(report.issue()));
  return report.ok() ? *report : StepReport{};
}

Pose pose_of(const Mat3& rotation, const Vec3& translation) {
  const Eigen::Quaterniond q(rotation);
  return {{q.w(), q.x(), q.y(), q.z()}, as_point(translation)};
}

Mat3 turned(double degrees, const Vec3& axis) {
  return Eigen::AngleAxisd(degrees * std::numbers::pi / 180, axis.normalized()).toRotationMatrix();
}

namespace {

Vec3 mass_mean(const World& world, BodyId body, std::span<const Point> values) {
  const auto& model = world.asset(body).model();
  Vec3 mean = Vec3::Zero();
  for (std::size_t k = 0; k < values.size(); ++k)
    mean += model.masses()[k] / model.total_mass() * as_vec3(values[k]);
  return mean;
}

}  // namespace

Vec3 centre_of_mass(const World& world, BodyId body) {
  return mass_mean(world, body, world.positions(body));
}
Vec3 mean_velocity(const World& world, BodyId body) {
  return mass_mean(world, body, world.velocities(body));
}

Vec3 contact_force(const World& world, BodyId body) {
  Vec3 sum = Vec3::Zero();
  for (const auto& contact : world.contacts()) {
    if (contact.body_a.index == body.index) sum += as_vec3(contact.force_n);
    if (contact.body_b.index == body.index) sum -= as_vec3(contact.force_n);
  }
  return sum;
}

void set_velocity(World& world, BodyId body, const Vec3& velocity) {
  const std::vector<Point> positions(world.positions(body).begin(), world.positions(body).end());
  const std::vector<Point> velocities(positions.size(), as_point(velocity));
  EXPECT_TRUE(world.set_state(body, positions, velocities).ok());
}

}  // namespace souple::test
