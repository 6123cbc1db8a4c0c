// SPDX-License-Identifier: MIT
#include "tests/support/indentation.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/box_mesh.hpp"
#include "tests/support/dense_compliance.hpp"

namespace souple::test {
namespace {

TetMesh mesh_of(const GradedBlock& block) {
  const int n = block.half_cells;
  TetMesh mesh = box_mesh({2 * n, 2 * n, n}, {-1, -1, -1}, {2, 2, 1});
  const auto grade = [&](double s) {
    return block.size * std::sinh(block.grading * s) / std::sinh(block.grading);
  };
  for (Point& p : mesh.nodes) p = {grade(p[0]), grade(p[1]), grade(p[2])};
  return mesh;
}

std::shared_ptr<const SoftBodyAsset> body_of(const GradedBlock& block) {
  TetMesh mesh = mesh_of(block);
  FixedSet bottom{"held", {}};
  for (std::size_t k = 0; k < mesh.nodes.size(); ++k)
    if (mesh.nodes[k][2] < -block.size * (1 - 1e-9)) bottom.nodes.push_back(Index(k));
  SoftBodyContent content;
  content.level = level_of(std::move(mesh));
  content.material = material_of(block.young, block.poisson, 1000);
  content.fixed_sets = {bottom};
  auto asset = SoftBodyAsset::create(std::move(content));
  EXPECT_TRUE(asset.ok());
  return asset.ok() ? *asset : nullptr;
}

Pressed state_of(const World& world, BodyId block) {
  Pressed now;
  for (const ContactRecord& contact : world.contacts()) {
    const double side = contact.body_a.index == block.index ? 1 : -1;
    now.touches.push_back({contact.point_m, side * as_vec3(contact.force_n)});
    now.normal -= now.touches.back().force.z();
    now.tangential += now.touches.back().force;
  }
  now.tangential.z() = 0;
  return now;
}

}  // namespace

double cell_width(const GradedBlock& block, double r) {
  // r = size sinh(g s) / sinh(g), s in steps of 1 / half_cells.
  const double scale = block.size / std::sinh(block.grading);
  return std::hypot(scale, r) * block.grading / block.half_cells;
}

std::vector<Pressed> press(const GradedBlock& block, double radius, double depth,
                           const std::vector<double>& aside, double friction) {
  WorldSettings settings;
  settings.integrator = Integrator::quasi_static;
  settings.contact_method = ContactMethod::exact;
  settings.gravity_m_s2 = {0, 0, 0};
  settings.friction = friction;
  World world = make_world(settings);
  const BodyId body =
      add_soft(world, body_of(block), Vec3::Zero(), Mat3::Identity(), Vec3::Zero(), "held");
  const double h = settings.time_step_s;
  const auto at = [&](double x, double z) { return pose_of(Mat3::Identity(), {x, 0, radius - z}); };
  // Two steps a move and two to settle, as the tangent is that of the step's beginning.
  std::vector<Keyframe> path{{0, at(0, 0)}, {2 * h, at(0, depth)}, {4 * h, at(0, depth)}};
  for (const double x : aside) {
    path.push_back({path.back().time_s + h, at(x, depth)});
    path.push_back({path.back().time_s + h, at(x, depth)});
  }
  add_driven(world, sphere_shape(radius), path);
  std::vector<Pressed> course;
  for (int k = 0; k < 4 + 2 * int(aside.size()); ++k) {
    step(world);
    if (k >= 3 && k % 2 == 1) course.push_back(state_of(world, body));
  }
  return course;
}

double hertz_error(const GradedBlock& block, double radius, double depth) {
  const double modulus = block.young / (1 - block.poisson * block.poisson);
  const double force = 4.0 / 3 * modulus * std::sqrt(radius) * std::pow(depth, 1.5);
  return press(block, radius, depth, {}, 0).front().normal / force - 1;
}

}  // namespace souple::test
