// SPDX-License-Identifier: MIT
// A body under any rigid rotation: W, forces and positions equal the exact ones of the turned body.
#include <gtest/gtest.h>

#include <random>

#include "runtime/contact/contact.hpp"
#include "tests/support/box_mesh.hpp"
#include "tests/support/dense_compliance.hpp"
#include "tests/support/scenes.hpp"

namespace souple {
namespace {

using namespace test;

std::vector<Mat3> rotations() {
  std::vector<Mat3> list{turned(60, {0, 0, 1}),  turned(180, {0, 0, 1}), turned(60, {1, 0, 0}),
                         turned(180, {0, 1, 0}), turned(60, {1, 2, 3}),  turned(180, {3, -1, 2})};
  std::mt19937 random(9);
  std::normal_distribution<double> normal;
  for (int k = 0; k < 5; ++k)
    list.push_back(Eigen::Quaterniond(normal(random), normal(random), normal(random), normal(random))
                       .normalized()
                       .toRotationMatrix());
  return list;
}

std::shared_ptr<const SoftBodyAsset> test_body() {
  return make_body(irregular_box_mesh({4, 3, 3}, {-0.1, -0.08, -0.07}, {0.2, 0.16, 0.14}, 1),
                   material_of(1e4, 0.4, 1000, 0.1, 0.01), 0.01);
}

struct Outcome {
  Eigen::MatrixXd w;       ///< in world coordinates
  Eigen::VectorXd forces;  ///< by contact, in world coordinates
  std::vector<Point> positions;
  std::vector<Index> surface;  ///< nodes of the compliance
};

// One step of the turned body pressed 2 mm into a plane that cuts its lowest corner off.
Outcome press(const Mat3& rotation, ContactMethod method, const Mat3& world_rotation, bool soft_floor) {
  WorldSettings settings;
  settings.contact_method = method;
  settings.gravity_m_s2 = as_point(world_rotation * Vec3(0, 0, -9.81));
  settings.alarm_distance_m = 0.02;
  World world = make_world(settings);
  const auto body = test_body();
  double lowest = 0;
  for (const Point& p : body->model().rest_positions())
    lowest = std::min(lowest, (rotation * as_vec3(p)).z());
  const BodyId id = add_soft(world, body, world_rotation * Vec3(0, 0, -lowest - 0.002),
                             world_rotation * rotation, world_rotation * Vec3(0.3, 0.1, -0.2));
  if (soft_floor) {
    const auto floor = make_body(box_mesh({6, 6, 1}, {-0.3, -0.3, -0.1}, {0.6, 0.6, 0.1}),
                                 material_of(1e5, 0.3, 1000, 0.1, 0.01), 0.01);
    add_soft(world, floor, Vec3::Zero(), world_rotation);
  } else {
    add_plane(world, world_rotation);
  }
  step(world);
  const auto problem = world.contact_problem();
  const auto size = Eigen::Index(3 * problem.contacts.size());
  Outcome outcome;
  const Eigen::Map<const Eigen::MatrixXd> w(problem.delassus.data(), size, size);
  Eigen::MatrixXd frames = Eigen::MatrixXd::Zero(size, size);
  for (Eigen::Index i = 0; i < size / 3; ++i)
    frames.block<3, 3>(3 * i, 3 * i) = problem.contacts[std::size_t(i)].frame;
  outcome.w = frames * w * frames.transpose();
  outcome.forces = frames * Eigen::Map<const Eigen::VectorXd>(problem.force.data(), size);
  outcome.positions.assign(world.positions(id).begin(), world.positions(id).end());
  outcome.surface = body->compliances()[0].nodes;
  return outcome;
}

// The motion of inner nodes comes from a factor in half precision (RestExtension): exact to 1e-3 of the
// largest correction, here about the 2 mm that the corner is pushed back. Contacts never see it.
constexpr double surface_bound = 1e-6 * 0.2, inner_bound = 1e-3 * 0.002;

double surface_error(const Outcome& a, const Outcome& b, const Mat3& turn) {
  double worst = 0;
  for (const Index k : a.surface)
    worst = std::max(
        worst,
        (turn * as_vec3(a.positions[std::size_t(k)]) - as_vec3(b.positions[std::size_t(k)])).norm());
  return worst;
}

double position_error(const Outcome& a, const Outcome& b, const Mat3& turn) {
  double worst = 0;
  for (std::size_t k = 0; k < a.positions.size(); ++k)
    worst = std::max(worst, (turn * as_vec3(a.positions[k]) - as_vec3(b.positions[k])).norm());
  return worst;
}

class TurnedBody : public testing::TestWithParam<bool> {};  // against a soft floor or a plane

TEST_P(TurnedBody, HasTheExactDelassusOperatorForcesAndPositions) {
  for (const Mat3& rotation : rotations()) {
    const Outcome warped = press(rotation, ContactMethod::warped, Mat3::Identity(), GetParam());
    const Outcome exact = press(rotation, ContactMethod::exact, Mat3::Identity(), GetParam());
    ASSERT_EQ(warped.w.rows(), exact.w.rows());
    ASSERT_GT(exact.forces.norm(), 0);
    EXPECT_LT((warped.w - exact.w).norm() / exact.w.norm(), 1e-6);
    EXPECT_LT((warped.forces - exact.forces).norm() / exact.forces.norm(), 1e-6);
    EXPECT_LT(surface_error(warped, exact, Mat3::Identity()), surface_bound);
    EXPECT_LT(position_error(warped, exact, Mat3::Identity()), inner_bound);
  }
}

TEST_P(TurnedBody, GivesTheTurnedResultInATurnedWorld) {
  const Mat3 rotation = turned(35, {1, 1, 0});
  const Outcome upright = press(rotation, ContactMethod::warped, Mat3::Identity(), GetParam());
  for (const Mat3& turn : rotations()) {
    const Outcome turned_world = press(rotation, ContactMethod::warped, turn, GetParam());
    ASSERT_EQ(turned_world.w.rows(), upright.w.rows());
    const auto blocks = upright.w.rows() / 3;
    Eigen::MatrixXd t = Eigen::MatrixXd::Zero(3 * blocks, 3 * blocks);
    for (Eigen::Index i = 0; i < blocks; ++i) t.block<3, 3>(3 * i, 3 * i) = turn;
    EXPECT_LT((turned_world.w - t * upright.w * t.transpose()).norm() / upright.w.norm(), 1e-6);
    EXPECT_LT((turned_world.forces - t * upright.forces).norm() / upright.forces.norm(), 1e-6);
    EXPECT_LT(position_error(upright, turned_world, turn), 1e-6 * 0.2);
  }
}

INSTANTIATE_TEST_SUITE_P(RigidAndSoftFloor, TurnedBody, testing::Values(false, true),
                         [](const auto& param) { return param.param ? "SoftFloor" : "RigidFloor"; });

}  // namespace
}  // namespace souple
