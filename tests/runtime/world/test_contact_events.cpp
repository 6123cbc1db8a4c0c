// SPDX-License-Identifier: MIT
// What an application hears and asks of contact: events, picks, filters, and refusals of hostile input.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/box_mesh.hpp"
#include "tests/support/dense_compliance.hpp"
#include "tests/support/rigid_scenes.hpp"

namespace souple {
namespace {

using namespace test;

std::shared_ptr<const SoftBodyAsset> soft_cube() {
  return make_body(box_mesh({2, 2, 2}, {-0.05, -0.05, -0.05}, {0.1, 0.1, 0.1}),
                   material_of(1e5, 0.3, 1000, 0.1, 0.01), 0.01);
}

TEST(ContactEvents, BeginOncePersistAndEndOnceWithTheSumOfForces) {
  WorldSettings settings;
  World world = make_world(settings);
  const BodyId plane = add_plane(world);
  const BodyId soft = add_soft(world, soft_cube(), {0, 0, 0.1});
  const BodyId ball = add_free(world, sphere_shape(0.05), {1, 0, 0.2});
  int begun = 0, ended = 0;
  bool touching = false;
  const auto follow = [&](int steps) {
    for (int k = 0; k < steps; ++k) {
      step(world);
      Vec3 sum = Vec3::Zero();
      for (const ContactEvent& event : world.contact_events()) {
        EXPECT_LE(event.body_a.index, event.body_b.index);
        if (event.body_b != soft) continue;
        EXPECT_EQ(event.body_a, plane);
        EXPECT_EQ(event.kind == ContactEventKind::begin, !touching && event.contact_count > 0);
        EXPECT_EQ(event.kind == ContactEventKind::end, event.contact_count == 0);
        begun += event.kind == ContactEventKind::begin;
        ended += event.kind == ContactEventKind::end;
        touching = event.kind != ContactEventKind::end;
        sum -= as_vec3(event.force_n);
      }
      EXPECT_LT((sum - contact_force(world, soft)).norm(), 1e-9 * (1 + sum.norm()));
      EXPECT_EQ(touching, sum.norm() > 0);
    }
  };
  follow(300);
  EXPECT_GE(begun, 1);
  EXPECT_EQ(begun, ended + 1);
  EXPECT_NEAR(event_force(world, plane, soft).z(), 9.81, 1e-3);
  EXPECT_NEAR(event_force(world, plane, ball).z(), 9.81 * 1000 * 4.0 / 3 * M_PI * std::pow(0.05, 3),
              1e-6);
  const int before = begun;
  set_velocity(world, soft, {0, 0, 1});
  follow(10);
  EXPECT_EQ(begun, before);
  EXPECT_EQ(ended, begun);
  EXPECT_FALSE(touching);
}

TEST(Picks, HitTheNearestBodyWhereGeometryHasIt) {
  WorldSettings settings;
  settings.gravity_m_s2 = {0, 0, 0};
  World world = make_world(settings);
  const BodyId ball = add_free(world, sphere_shape(0.1), {0, 0, 1});
  const BodyId box = add_box(world, {0.1, 0.2, 0.3}, {1, 0, 1}, turned(90, {0, 0, 1}));
  const BodyId soft = add_soft(world, soft_cube(), {2, 0, 1}, turned(45, {0, 0, 1}));
  const BodyId plane = add_plane(world);
  const auto hit = [&](const Point& from, const Point& along, double reach = 100) {
    return world.pick(from, along, reach);
  };
  const auto on_ball = hit({-1, 0.06, 1}, {3, 0, 0});
  ASSERT_TRUE(on_ball);
  EXPECT_EQ(on_ball->body, ball);
  EXPECT_NEAR(on_ball->distance_m, 1 - 0.08, 1e-12);
  EXPECT_LT((as_vec3(on_ball->normal) - Vec3(-0.8, 0.6, 0)).norm(), 1e-12);
  const auto on_box = hit({1, -5, 1.1}, {0, 1, 0});
  ASSERT_TRUE(on_box);
  EXPECT_EQ(on_box->body, box);
  EXPECT_NEAR(on_box->point_m[1], -0.1, 1e-12);
  const auto on_soft = hit({2, -1, 1}, {0, 2, 0});
  ASSERT_TRUE(on_soft);
  EXPECT_EQ(on_soft->body, soft);
  EXPECT_NEAR(on_soft->point_m[1], -0.05 * std::sqrt(2.0), 1e-9);
  ASSERT_GE(on_soft->node, 0);
  const Vec3 node = as_vec3(world.positions(soft)[std::size_t(on_soft->node)]);
  EXPECT_LT((node - as_vec3(on_soft->point_m)).norm(), 0.05) << "a corner of the triangle";
  const auto on_plane = hit({5, 5, 2}, {0, 0, -0.1});
  ASSERT_TRUE(on_plane);
  EXPECT_EQ(on_plane->body, plane);
  EXPECT_NEAR(on_plane->distance_m, 2, 1e-12);
  EXPECT_FALSE(hit({5, 5, 2}, {0, 0, -1}, 1.9)) << "out of reach";
  EXPECT_FALSE(hit({5, 5, 2}, {0, 0, 1}));
  const double nan = std::nan("");
  for (const Point& spoilt : {Point{0, 0, 0}, Point{nan, 0, 1}, Point{INFINITY, 0, 0}})
    EXPECT_FALSE(hit({5, 5, 2}, spoilt));
  EXPECT_FALSE(hit({nan, 0, 0}, {0, 0, 1}));
  EXPECT_FALSE(hit({5, 5, 2}, {0, 0, -1}, nan));
  EXPECT_FALSE(hit({5, 5, 2}, {0, 0, -1}, -1));
}

TEST(Filters, LetOnlyThoseTouchWhoseGroupsMeetTheOthersMask) {
  for (const bool soft : {false, true})
    for (const auto& [filter, touches] : {std::pair(CollisionFilter{1, ~0u}, true),
                                          {CollisionFilter{2, ~0u}, false},
                                          {CollisionFilter{3, ~0u}, true},
                                          {CollisionFilter{1, 4}, false},
                                          {CollisionFilter{1, 2}, true},
                                          {CollisionFilter{0, ~0u}, false}}) {
      World world = make_world(WorldSettings{});
      RigidBodyDescription floor;
      floor.name = "floor";
      floor.path = {{0, {}}};
      floor.filter = {2, 1};
      ASSERT_TRUE(world.add_rigid_body(floor).ok());
      Result<BodyId> body = BodyId{};
      if (soft) {
        SoftBodyDescription d;
        d.name = "soft";
        d.pose.translation = {0, 0, 0.06};
        d.filter = filter;
        body = world.add_soft_body(soft_cube(), d);
      } else {
        RigidBodyDescription d;
        d.name = "ball";
        d.shape = sphere_shape(0.05);
        d.path = {{0, {{1, 0, 0, 0}, {0, 0, 0.06}}}};
        d.free = FreeRigidMotion{};
        d.filter = filter;
        body = world.add_rigid_body(d);
      }
      ASSERT_TRUE(body.ok());
      for (int k = 0; k < 60; ++k) step(world);
      const double z = soft ? centre_of_mass(world, *body).z() : place_of(world, *body).z();
      EXPECT_EQ(z > 0, touches) << filter.groups << ' ' << filter.mask << (soft ? " soft" : " rigid");
    }
}

TEST(HostileBodies, AreRefusedByCodeAndLeaveTheWorldAsItWas) {
  World world = make_world(WorldSettings{});
  const double nan = std::nan("");
  RigidBodyDescription good;
  good.name = "body";
  good.shape = sphere_shape(0.1);
  good.path = {{0, {{1, 0, 0, 0}, {0, 0, 1}}}};
  good.free = FreeRigidMotion{};
  const auto refuses = [&](auto&& spoil) {
    RigidBodyDescription d = good;
    spoil(d);
    const auto result = world.add_rigid_body(d);
    return !result.ok() && result.issue().code == IssueCode::world_parameter_invalid;
  };
  EXPECT_TRUE(refuses([&](auto& d) { d.path[0].pose.translation[0] = nan; }));
  EXPECT_TRUE(refuses([&](auto& d) { d.path[0].pose.rotation = {nan, 0, 0, 0}; }));
  EXPECT_TRUE(refuses([&](auto& d) { d.path[0].pose.rotation = {0, 0, 0, 0}; }));
  EXPECT_TRUE(refuses([&](auto& d) { d.path.clear(); }));
  EXPECT_TRUE(refuses([&](auto& d) { d.path.push_back({1, d.path[0].pose}); })) << "free and driven";
  EXPECT_TRUE(refuses([&](auto& d) { d.shape = {}; })) << "a plane has no mass";
  EXPECT_TRUE(refuses([&](auto& d) { d.shape.kind = RigidShapeKind::mesh; })) << "without a mesh";
  EXPECT_TRUE(refuses([&](auto& d) { d.shape.radius_m = nan; }));
  EXPECT_TRUE(refuses([&](auto& d) { d.shape.radius_m = 0; }));
  EXPECT_TRUE(refuses([&](auto& d) { d.free->mass_kg = -1; }));
  EXPECT_TRUE(refuses([&](auto& d) { d.free->mass_kg = nan; }));
  EXPECT_TRUE(refuses([&](auto& d) { d.free->density_kg_m3 = 0; }));
  EXPECT_TRUE(refuses([&](auto& d) { d.free->velocity_m_s[0] = INFINITY; }));
  EXPECT_TRUE(refuses([&](auto& d) { d.free->angular_velocity_rad_s[2] = nan; }));
  EXPECT_EQ(world.body_count(), 0u);

  const BodyId body = add_free(world, sphere_shape(0.1), {0, 0, 1});
  const BodyId plane = add_plane(world);
  const auto is_refused = [](const Status& status) {
    return !status.ok() && status.issue().code == IssueCode::world_parameter_invalid;
  };
  EXPECT_TRUE(is_refused(world.set_rigid_state(plane, {}, {}, {})));
  EXPECT_TRUE(is_refused(world.set_rigid_state({9}, {}, {}, {})));
  EXPECT_TRUE(is_refused(world.set_rigid_state(body, {{0, 0, 0, 0}, {}}, {}, {})));
  EXPECT_TRUE(is_refused(world.set_rigid_state(body, {}, {nan, 0, 0}, {})));
  EXPECT_TRUE(is_refused(world.set_rigid_state(body, {}, {}, {0, INFINITY, 0})));
  EXPECT_TRUE(is_refused(world.set_pair(body, plane, {0.3, true, 1.1})));
  EXPECT_TRUE(is_refused(world.set_pair(body, plane, {0.3, true, nan})));
  EXPECT_TRUE(is_refused(world.set_pair(body, plane, {nan, true, 0})));
  EXPECT_TRUE(is_refused(world.set_pair(body, body, {})));
  world.wake({1000});
  EXPECT_EQ(place_of(world, body), Vec3(0, 0, 1));
  EXPECT_TRUE(world.step().ok());
}

// A U of thickness 0.02 m with legs of 0.1 m, 0.02 m apart, open towards +z; held at its bend.
TetMesh make_u() {
  TetMesh mesh = box_mesh({16, 2, 1}, {-0.131, -0.02, 0}, {0.262, 0.04, 0.02});
  constexpr double inner = 0.01, leg = 0.131 - M_PI / 2 * 0.02;
  for (Point& p : mesh.nodes) {
    const double along = p[0], radius = inner + 0.02 - p[2], bend = M_PI / 2 * 0.02;
    const double angle = std::clamp(along / bend, -1.0, 1.0) * M_PI / 2;
    const double straight = std::max(0.0, std::abs(along) - bend) / (0.131 - bend) * leg;
    p = {radius * std::sin(angle), p[1], straight - radius * std::cos(angle)};
  }
  return mesh;
}

TEST(SelfContact, LegsOfAUDoNotPassThroughEachOther) {
  TetMesh mesh = make_u();
  FixedSet bend{"bend", {}};
  for (std::size_t k = 0; k < mesh.nodes.size(); ++k)
    if (mesh.nodes[k][2] < -0.008) bend.nodes.push_back(Index(k));
  const auto asset =
      make_body(std::move(mesh), material_of(2e4, 0.3, 1000, 1, 0.01), 0.01, {bend}, "bend");
  ASSERT_TRUE(asset);
  double gap[2];
  for (const bool self : {false, true}) {
    WorldSettings settings;
    settings.gravity_m_s2 = {0, 0, 0};
    World world = make_world(settings);
    SoftBodyDescription d;
    d.name = "u";
    d.fixed_set = "bend";
    d.self_contact = self;
    const auto body = world.add_soft_body(asset, d);
    ASSERT_TRUE(body.ok());
    const auto rest = asset->model().rest_positions();
    LoadDescription left, right;
    for (std::size_t k = 0; k < rest.size(); ++k)
      if (rest[k][2] > 0.08) (rest[k][0] > 0 ? right : left).nodes.push_back(Index(k));
    ASSERT_FALSE(left.nodes.empty());
    right.course = {{0, {0, 0, 0}}, {1, {-0.2, 0, 0}}};
    left.course = {{0, {0, 0, 0}}, {1, {0.2, 0, 0}}};
    ASSERT_TRUE(world.add_load(*body, left).ok());
    ASSERT_TRUE(world.add_load(*body, right).ok());
    gap[self] = INFINITY;
    for (int k = 0; k < 300; ++k) {
      step(world);
      double least_right = INFINITY, most_left = -INFINITY;
      for (const Index n : right.nodes)
        least_right = std::min(least_right, world.positions(*body)[std::size_t(n)][0]);
      for (const Index n : left.nodes)
        most_left = std::max(most_left, world.positions(*body)[std::size_t(n)][0]);
      gap[self] = std::min(gap[self], least_right - most_left);
    }
  }
  EXPECT_LT(gap[false], -0.01) << "the load is strong enough";
  EXPECT_GT(gap[true], -1e-3);
}

}  // namespace
}  // namespace souple
