// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/box_mesh.hpp"
#include "tests/support/dense_compliance.hpp"
#include "tests/support/scenes.hpp"

namespace souple {
namespace {

using namespace test;

std::shared_ptr<const SoftBodyAsset> small_body() {
  return make_body(box_mesh({2, 2, 2}, {0, 0, 0}, {0.1, 0.1, 0.1}), material_of(1e4, 0.4, 1000), 0.01);
}

TEST(WorldInput, RefusesBadSettings) {
  const auto refused = [](auto spoil) {
    WorldSettings settings;
    spoil(settings);
    const auto world = World::create(settings);
    return !world && world.issue().code == IssueCode::world_parameter_invalid;
  };
  EXPECT_FALSE(refused([](auto&) {}));
  EXPECT_TRUE(refused([](auto& s) { s.time_step_s = 0; }));
  EXPECT_TRUE(refused([](auto& s) { s.time_step_s = NAN; }));
  EXPECT_TRUE(refused([](auto& s) { s.time_step_s = -0.01; }));
  EXPECT_TRUE(refused([](auto& s) { s.gravity_m_s2[1] = INFINITY; }));
  EXPECT_TRUE(refused([](auto& s) { s.friction = -0.1; }));
  EXPECT_TRUE(refused([](auto& s) { s.friction = NAN; }));
  EXPECT_TRUE(refused([](auto& s) { s.alarm_distance_m = -1; }));
  EXPECT_TRUE(refused([](auto& s) { s.contact_solver.max_sweeps = 0; }));
  EXPECT_TRUE(refused([](auto& s) { s.free_motion.tolerance = NAN; }));
}

TEST(WorldInput, RefusesPairsThatAreNone) {
  World world = make_world(WorldSettings{});
  const BodyId soft = add_soft(world, small_body(), Vec3::Zero()), plane = add_plane(world);
  const auto code = [&](BodyId a, BodyId b, const PairRule& rule) {
    const Status status = world.set_pair(a, b, rule);
    return status.ok() ? IssueCode{} : status.issue().code;
  };
  EXPECT_EQ(code(soft, plane, {10, true}), IssueCode{});
  EXPECT_EQ(code(soft, soft, {}), IssueCode::world_parameter_invalid);
  EXPECT_EQ(code(soft, {7}, {}), IssueCode::world_parameter_invalid);
  EXPECT_EQ(code({7}, soft, {}), IssueCode::world_parameter_invalid);
  for (const double friction : {-1e-9, 10.1, double(NAN), double(INFINITY)})
    EXPECT_EQ(code(soft, plane, {friction, true}), IssueCode::world_parameter_invalid) << friction;
}

TEST(WorldInput, RefusesBadBodies) {
  World world = make_world(WorldSettings{});
  const auto soft_code = [&](auto spoil) {
    SoftBodyDescription description;
    spoil(description);
    const auto body = world.add_soft_body(small_body(), description);
    return body ? IssueCode{} : body.issue().code;
  };
  EXPECT_EQ(soft_code([](auto& d) {
              d.pose.rotation = {0, 0, 0, 0};
            }),
            IssueCode::world_parameter_invalid);
  EXPECT_EQ(soft_code([](auto& d) { d.pose.translation[0] = NAN; }),
            IssueCode::world_parameter_invalid);
  EXPECT_EQ(soft_code([](auto& d) { d.velocity_m_s[2] = INFINITY; }),
            IssueCode::world_parameter_invalid);
  EXPECT_EQ(soft_code([](auto& d) { d.fixed_set = "nowhere"; }), IssueCode::fixed_set_invalid);
  const auto rigid_refused = [&](auto spoil) {
    RigidBodyDescription description;
    description.path = {{0, {}}};
    spoil(description);
    return !world.add_rigid_body(description).ok();
  };
  EXPECT_TRUE(rigid_refused([](auto& d) { d.path.clear(); }));
  EXPECT_TRUE(rigid_refused([](auto& d) { d.path.push_back(d.path[0]); }));
  EXPECT_TRUE(rigid_refused([](auto& d) { d.path[0].time_s = NAN; }));
  EXPECT_TRUE(rigid_refused([](auto& d) { d.shape.kind = RigidShapeKind::sphere; }));
  EXPECT_TRUE(rigid_refused([](auto& d) {
    d.shape.kind = RigidShapeKind::box;
    d.shape.half_extents_m = {1, NAN, 1};
  }));
  EXPECT_EQ(world.body_count(), 0u) << "a refused body is not added";
}

TEST(WorldInput, RefusesATimeStepThatTheAssetHasNoComplianceFor) {
  WorldSettings settings;
  settings.time_step_s = 0.02;
  World world = make_world(settings);
  const auto body = world.add_soft_body(small_body(), {});
  ASSERT_FALSE(body.ok());
  EXPECT_EQ(body.issue().code, IssueCode::scene_no_matching_compliance);
  EXPECT_NE(body.issue().what.find("0.01"), std::string::npos) << "names what the asset holds";
  settings.contact_method = ContactMethod::exact;  // needs no precomputed compliance
  World exact = make_world(settings);
  EXPECT_TRUE(exact.add_soft_body(small_body(), {}).ok());
}

TEST(WorldInput, RefusesAStateThatIsNotFiniteOrNotAsLong) {
  World world = make_world(WorldSettings{});
  const BodyId body = add_soft(world, small_body(), Vec3::Zero());
  std::vector<Point> x(world.positions(body).begin(), world.positions(body).end()), v(x.size());
  v[3][1] = NAN;
  EXPECT_FALSE(world.set_state(body, x, v).ok());
  EXPECT_FALSE(world.set_state(body, x, std::span(v).first(2)).ok());
}

TEST(WorldInput, AStepThatCannotBeComputedKeepsTheState) {
  World world = make_world(WorldSettings{});
  const BodyId body = add_soft(world, small_body(), Vec3::Zero());
  std::vector<Point> x(world.positions(body).begin(), world.positions(body).end());
  const std::vector<Point> v(x.size());
  x[0] = {1e300, -1e300, 1e300};  // finite, but its square is not
  ASSERT_TRUE(world.set_state(body, x, v).ok());
  const auto report = world.step();
  ASSERT_FALSE(report.ok());
  EXPECT_EQ(report.issue().code, IssueCode::step_not_finite);
  EXPECT_EQ(std::vector<Point>(world.positions(body).begin(), world.positions(body).end()), x);
  EXPECT_EQ(world.time_s(), 0);
}

}  // namespace
}  // namespace souple
