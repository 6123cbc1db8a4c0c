// SPDX-License-Identifier: MIT
// A turned soft body against a free rigid body and against itself turned: W and forces are the exact
// ones.
#include <gtest/gtest.h>

#include "runtime/contact/contact.hpp"
#include "tests/support/box_mesh.hpp"
#include "tests/support/dense_compliance.hpp"
#include "tests/support/rigid_scenes.hpp"

namespace souple {
namespace {

using namespace test;

struct Outcome {
  Eigen::VectorXd w, forces;
  Vec3 rigid_velocity;
};

// A rigid ball and a turned soft body that press on a soft block, itself turned.
Outcome press(const Mat3& rotation, ContactMethod method) {
  WorldSettings settings;
  settings.contact_method = method;
  settings.contact_solver = {1e-13, 5000};
  settings.free_motion.tolerance = 1e-12;
  settings.gravity_m_s2 = {0, 0, 0};
  World world = make_world(settings);
  static const auto block =
      make_body(irregular_box_mesh({3, 3, 3}, {-0.1, -0.1, -0.1}, {0.2, 0.2, 0.2}, 0.5),
                material_of(1e4, 0.4, 1000, 0.1, 0.01), 0.01);
  add_soft(world, block, Vec3::Zero(), rotation);
  add_soft(world, block, rotation * Vec3(0.03, 0.02, 0.2), rotation * turned(90, {0, 0, 1}),
           rotation * Vec3(0.1, 0, -0.2));
  const BodyId ball = add_free(world, sphere_shape(0.05), rotation * Vec3(0.15, 0.013, 0.017),
                               Mat3::Identity(), moving(rotation * Vec3(-0.3, 0.1, 0)));
  step(world);
  const auto problem = world.contact_problem();
  Outcome outcome;
  outcome.w =
      Eigen::Map<const Eigen::VectorXd>(problem.delassus.data(), Eigen::Index(problem.delassus.size()));
  outcome.forces =
      Eigen::Map<const Eigen::VectorXd>(problem.force.data(), Eigen::Index(problem.force.size()));
  outcome.rigid_velocity = speed_of(world, ball);
  return outcome;
}

TEST(ContactRotation, AgainstRigidAndSoftTheWarpedProblemIsTheExactOne) {
  for (const Mat3& rotation :
       {turned(60, {1, 2, 3}), turned(180, {0, 1, 0}), turned(137, {3, -1, 2})}) {
    const Outcome warped = press(rotation, ContactMethod::warped),
                  exact = press(rotation, ContactMethod::exact);
    ASSERT_EQ(warped.w.size(), exact.w.size());
    ASSERT_GT(exact.forces.norm(), 0);
    EXPECT_LT((warped.w - exact.w).norm(), 1e-6 * exact.w.norm());
    EXPECT_LT((warped.forces - exact.forces).norm(), 1e-6 * exact.forces.norm());
    EXPECT_LT((warped.rigid_velocity - exact.rigid_velocity).norm(), 1e-6);
  }
}

}  // namespace
}  // namespace souple
