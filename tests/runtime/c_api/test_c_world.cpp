// SPDX-License-Identifier: MIT
// The C interface does what the C++ runtime does, to the bit.
#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <cmath>
#include <cstring>
#include <thread>

#include "c_program.h"
#include "c_scene.hpp"
#include "runtime/load/load_soft_body.hpp"
#include "runtime/world/soft_body_asset.hpp"
#include "runtime/world/world.hpp"
#include "tests/support/allocation_count.hpp"

namespace souple {
namespace {

using namespace test;

bool same_bits(const std::vector<souple_vec3>& a, std::span<const Point> b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(souple_vec3)) == 0;
}

bool same_bits(const std::vector<souple_vec3>& a, const std::vector<souple_vec3>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(souple_vec3)) == 0;
}

// The drop of c_program.c, with the runtime itself.
std::vector<Point> drop_in_cpp(int steps) {
  auto asset = load_soft_body(asset_file());
  EXPECT_TRUE(asset);
  auto world = World::create({});
  EXPECT_TRUE(world);
  SoftBodyDescription soft;
  soft.pose = {{0.8, 0.6, 0, 0}, {0, 0, 0.1}};
  soft.velocity_m_s = {0.3, 0, 0};
  const auto body = world->add_soft_body(*asset, soft);
  EXPECT_TRUE(body);
  RigidBodyDescription plane;
  plane.path = {{}};
  EXPECT_TRUE(world->add_rigid_body(plane));
  for (int k = 0; k < steps; ++k) EXPECT_TRUE(world->step());
  const auto positions = world->positions(*body);
  return {positions.begin(), positions.end()};
}

TEST(CWorld, AProgramInCGetsTheBitsOfTheCppWorld) {
  constexpr int steps = 60;
  std::vector<souple_vec3> positions(1000);
  std::size_t count = positions.size();
  ASSERT_EQ(c_drop(asset_file().c_str(), steps, positions.data(), &count), SOUPLE_OK)
      << souple_last_error_what();
  positions.resize(count);
  const auto expected = drop_in_cpp(steps);
  EXPECT_TRUE(same_bits(positions, expected));
  double lowest = 1;
  for (const souple_vec3& p : positions) lowest = std::min(lowest, p.z);
  EXPECT_NEAR(lowest, 0, 2e-3);  // it has fallen and lies on the plane
}

TEST(CWorld, AnAssetFromMemoryIsThatFromTheFile) {
  souple_asset* opened = nullptr;
  {
    const std::vector<std::byte> bytes = asset_bytes();  // not needed after the call
    ASSERT_EQ(souple_asset_open_memory(bytes.data(), bytes.size(), nullptr, &opened), SOUPLE_OK)
        << souple_last_error_what();
  }
  const AssetHandle from_memory(opened);
  const AssetHandle from_file = open_asset();
  EXPECT_STREQ(souple_asset_content_hash(from_memory.get()),
               souple_asset_content_hash(from_file.get()));
  std::array<std::vector<souple_vec3>, 2> results;
  for (int k = 0; k < 2; ++k) {
    const WorldHandle world = make_c_world();
    const auto body = add_c_soft(world.get(), (k ? from_memory : from_file).get(), 0.02);
    add_c_rigid(world.get(), SOUPLE_SHAPE_PLANE, 0);
    step_c(world.get(), 30);
    results[std::size_t(k)] = positions_of(world.get(), body);
  }
  EXPECT_TRUE(same_bits(results[0], results[1]));
}

TEST(CWorld, TheFactsOfAnAssetAreThoseOfItsParts) {
  const AssetHandle asset = open_asset();
  auto facts = initialised(souple_asset_facts_init);
  ASSERT_EQ(souple_asset_get_facts(asset.get(), &facts), SOUPLE_OK);
  EXPECT_EQ(facts.node_count, 64u);
  EXPECT_EQ(facts.tet_count, 162u);
  EXPECT_EQ(facts.surface_node_count, 56u);
  EXPECT_EQ(facts.surface_triangle_count, 108u);
  EXPECT_EQ(facts.visual_vertex_count, 56u);
  EXPECT_EQ(facts.visual_triangle_count, 108u);
  EXPECT_EQ(facts.fixed_set_count, 2u);
  EXPECT_EQ(facts.compliance_count, 2u);
  EXPECT_NEAR(facts.mass_kg, 1.0, 1e-9);
  EXPECT_NEAR(facts.longest_side_m, 0.1, 1e-9);
  EXPECT_STREQ(souple_asset_fixed_set_name(asset.get(), 1), "käntchen");
  EXPECT_EQ(souple_asset_fixed_set_name(asset.get(), 2), nullptr);
  std::array<std::int32_t, 2> nodes{};
  std::size_t count = 0;
  ASSERT_EQ(souple_asset_fixed_set_nodes(asset.get(), "käntchen", nodes.data(), 2, &count), SOUPLE_OK);
  EXPECT_EQ(nodes, (std::array<std::int32_t, 2>{0, 1}));
  auto held = initialised(souple_compliance_facts_init);
  ASSERT_EQ(souple_asset_get_compliance(asset.get(), 1, &held), SOUPLE_OK);
  EXPECT_STREQ(held.name, "held");
  EXPECT_STREQ(held.fixed_set, "bottom");
  EXPECT_EQ(held.time_step_s, 0.01);
  EXPECT_EQ(held.node_count, 40u);
}

// Six times the volume that a closed surface encloses: wrong corners or order would show.
double volume6(const std::vector<souple_vec3>& x, const std::vector<souple_triangle>& triangles) {
  double sum = 0;
  for (const souple_triangle& t : triangles) {
    const souple_vec3 &a = x[std::size_t(t.corner[0])], &b = x[std::size_t(t.corner[1])],
                      &c = x[std::size_t(t.corner[2])];
    sum +=
        a.x * (b.y * c.z - b.z * c.y) + a.y * (b.z * c.x - b.x * c.z) + a.z * (b.x * c.y - b.y * c.x);
  }
  return sum;
}

TEST(CWorld, SurfaceAndShownPositionsEncloseTheBody) {
  const AssetHandle asset = open_asset();
  const WorldHandle world = make_c_world();
  const auto body = add_c_soft(world.get(), asset.get(), 0.3);
  std::vector<souple_triangle> triangles(108);
  std::vector<souple_vec3> vertices(56);
  std::vector<float> xyz(3 * 56);
  const auto check = [&](auto positions, auto positions_f32) {
    ASSERT_EQ(positions(world.get(), body, vertices.data(), vertices.size(), nullptr), SOUPLE_OK);
    EXPECT_NEAR(volume6(vertices, triangles), 6e-3, 1e-12);
    ASSERT_EQ(positions_f32(world.get(), body, xyz.data(), vertices.size(), nullptr), SOUPLE_OK);
    for (std::size_t k = 0; k < vertices.size(); ++k) {
      EXPECT_EQ(xyz[3 * k], float(vertices[k].x));
      EXPECT_EQ(xyz[3 * k + 1], float(vertices[k].y));
      EXPECT_EQ(xyz[3 * k + 2], float(vertices[k].z));
    }
  };
  ASSERT_EQ(souple_asset_surface_triangles(asset.get(), triangles.data(), 108, nullptr), SOUPLE_OK);
  check(souple_world_surface_positions, souple_world_surface_positions_f32);
  ASSERT_EQ(souple_asset_visual_triangles(asset.get(), triangles.data(), 108, nullptr), SOUPLE_OK);
  check(souple_world_visual_positions, souple_world_visual_positions_f32);

  std::vector<std::int32_t> nodes(56);
  ASSERT_EQ(souple_asset_surface_nodes(asset.get(), nodes.data(), 56, nullptr), SOUPLE_OK);
  ASSERT_EQ(souple_world_surface_positions(world.get(), body, vertices.data(), 56, nullptr), SOUPLE_OK);
  const auto all = positions_of(world.get(), body);
  for (std::size_t k = 0; k < nodes.size(); ++k) EXPECT_EQ(vertices[k].z, all[std::size_t(nodes[k])].z);
}

TEST(CWorld, ASnapshotGivesTheSameBitsAgain) {
  const AssetHandle asset = open_asset();
  const WorldHandle world = make_c_world();
  const auto body = add_c_soft(world.get(), asset.get(), 0.01);
  add_c_rigid(world.get(), SOUPLE_SHAPE_PLANE, 0);
  add_c_rigid(world.get(), SOUPLE_SHAPE_BOX, 0.2, SOUPLE_MOTION_FREE);
  step_c(world.get(), 20);
  const auto snapshot = snapshot_of(world.get());
  step_c(world.get(), 20);
  const auto first = positions_of(world.get(), body);
  ASSERT_EQ(souple_world_restore(world.get(), snapshot.data(), snapshot.size()), SOUPLE_OK);
  EXPECT_NEAR(souple_world_time_s(world.get()), 0.2, 1e-12);
  step_c(world.get(), 20);
  EXPECT_TRUE(same_bits(first, positions_of(world.get(), body)));
}

TEST(CWorld, ABufferThatIsTooSmallIsLeftAloneAndTheCountIsTold) {
  const AssetHandle asset = open_asset();
  const WorldHandle world = make_c_world();
  const auto body = add_c_soft(world.get(), asset.get(), 0.0);
  std::vector<souple_vec3> positions(64, {7, 7, 7});
  std::size_t needed = 0;
  EXPECT_EQ(souple_world_positions(world.get(), body, positions.data(), 63, &needed),
            SOUPLE_API_BUFFER_TOO_SMALL);
  EXPECT_EQ(needed, 64u);
  for (const souple_vec3& p : positions) EXPECT_EQ(p.x, 7);
  std::byte one{};
  EXPECT_EQ(souple_world_snapshot(world.get(), &one, 1, &needed), SOUPLE_API_BUFFER_TOO_SMALL);
  EXPECT_EQ(needed, snapshot_of(world.get()).size());
}

void run_on_threads(void* user, std::size_t count, souple_job job, void* context) {
  static_cast<std::atomic<int>*>(user)->fetch_add(1);
  std::vector<std::thread> threads;
  for (std::size_t k = 0; k < count; ++k) threads.emplace_back(job, context, k);
  for (auto& thread : threads) thread.join();
}

TEST(CWorld, StepsAsJobsHaveTheSameBits) {
  const AssetHandle asset = open_asset();
  std::array<std::vector<souple_vec3>, 2> results;
  std::atomic<int> calls = 0;
  for (int k = 0; k < 2; ++k) {
    const WorldHandle world = make_c_world();
    add_c_rigid(world.get(), SOUPLE_SHAPE_PLANE, 0);
    add_c_soft(world.get(), asset.get(), 0.005);
    const auto top = add_c_soft(world.get(), asset.get(), 0.12);
    if (k == 1) {
      ASSERT_EQ(souple_world_run_jobs_with(world.get(), run_on_threads, &calls), SOUPLE_OK);
    }
    step_c(world.get(), 15);
    results[std::size_t(k)] = positions_of(world.get(), top);
  }
  EXPECT_GT(calls, 0);
  EXPECT_TRUE(same_bits(results[0], results[1]));
}

TEST(CWorld, ContactsAndEventsCarryTheWeight) {
  const AssetHandle asset = open_asset();
  auto settings = initialised(souple_world_settings_init);
  settings.sleep_after_s = 0.3;
  const WorldHandle world = make_c_world(&settings);
  const auto body = add_c_soft(world.get(), asset.get(), 0.0);
  const auto floor = add_c_rigid(world.get(), SOUPLE_SHAPE_PLANE, 0);
  souple_contact_event event{};
  std::size_t count = 0;
  auto report = initialised(souple_step_report_init);
  ASSERT_EQ(souple_world_step(world.get(), &report), SOUPLE_OK);
  ASSERT_EQ(souple_world_contact_events(world.get(), &event, 1, &count), SOUPLE_OK);
  ASSERT_EQ(count, 1u);
  EXPECT_EQ(event.kind, SOUPLE_EVENT_BEGIN);
  for (int k = 0; k < 1000 && report.sleeping_count == 0; ++k)
    ASSERT_EQ(souple_world_step(world.get(), &report), SOUPLE_OK);
  EXPECT_EQ(souple_world_is_asleep(world.get(), body), 1);
  ASSERT_EQ(souple_world_wake(world.get(), body), SOUPLE_OK);
  EXPECT_EQ(souple_world_is_asleep(world.get(), body), 0);
  ASSERT_EQ(souple_world_step(world.get(), &report), SOUPLE_OK);
  std::vector<souple_contact> contacts(report.contact_count);
  ASSERT_EQ(souple_world_contacts(world.get(), contacts.data(), contacts.size(), &count), SOUPLE_OK);
  double weight = 0;
  for (std::size_t k = 0; k < count; ++k) {
    EXPECT_EQ(contacts[k].body_a + contacts[k].body_b, body + floor);
    weight += contacts[k].force_n.z * (contacts[k].body_a == body ? 1 : -1);
  }
  EXPECT_NEAR(weight, 9.81, 0.02);
  ASSERT_EQ(souple_world_contact_events(world.get(), &event, 1, &count), SOUPLE_OK);
  EXPECT_EQ(event.kind, SOUPLE_EVENT_PERSIST);
  EXPECT_NEAR(event.force_n.z * (event.body_a == body ? 1 : -1), weight, 1e-9);
}

TEST(CWorld, AGrabbedBodyFollowsTheHandleAndFallsWhenReleased) {
  const AssetHandle asset = open_asset();
  const WorldHandle world = make_c_world();
  const auto body = add_c_soft(world.get(), asset.get(), 0.5);
  souple_pick_hit hit{};
  ASSERT_EQ(souple_world_pick(world.get(), {0.01, 0.012, 2}, {0, 0, -3}, 5, &hit), SOUPLE_OK);
  ASSERT_EQ(hit.body, body);
  EXPECT_NEAR(hit.point_m.z, 0.6, 1e-9);
  EXPECT_NEAR(hit.normal.z, 1, 1e-9);
  souple_grab grab = 0;
  ASSERT_EQ(souple_world_grab(world.get(), body, hit.point_m, 0.03, 16, &grab), SOUPLE_OK);
  souple_pose pose{{1, 0, 0, 0}, {0, 0, 0}};
  for (int k = 1; k <= 100; ++k) {
    pose.translation_m.x = 0.001 * k;
    ASSERT_EQ(souple_world_move_grab(world.get(), grab, pose), SOUPLE_OK);
    step_c(world.get(), 1);
  }
  const souple_vec3 held = positions_of(world.get(), body)[std::size_t(hit.node)];
  EXPECT_NEAR(held.x - hit.point_m.x, 0.1, 0.03);  // the node is a corner of what was hit
  EXPECT_NEAR(held.z, 0.6, 1e-6);
  ASSERT_EQ(souple_world_release(world.get(), grab), SOUPLE_OK);
  step_c(world.get(), 20);
  EXPECT_LT(positions_of(world.get(), body)[std::size_t(hit.node)].z, 0.5);
  ASSERT_EQ(souple_world_pick(world.get(), {1, 1, 2}, {0, 0, -3}, 5, &hit), SOUPLE_OK);
  EXPECT_EQ(hit.body, SOUPLE_NO_BODY);
}

TEST(CWorld, RigidBodiesFallDriveAndHangOnJoints) {
  const WorldHandle world = make_c_world();
  auto path = initialised(souple_rigid_body_description_init);
  const souple_keyframe keyframes[] = {{0, {{1, 0, 0, 0}, {0, 0, 0}}}, {1, {{1, 0, 0, 0}, {1, 0, 0}}}};
  path.shape = SOUPLE_SHAPE_SPHERE;
  path.radius_m = 0.01;
  path.motion = SOUPLE_MOTION_DRIVEN;
  path.path = keyframes;
  path.path_count = 2;
  souple_body driven = 0;
  ASSERT_EQ(souple_world_add_rigid_body(world.get(), &path, &driven), SOUPLE_OK);
  const auto free = add_c_rigid(world.get(), SOUPLE_SHAPE_CAPSULE, 10, SOUPLE_MOTION_FREE);
  const auto hung = add_c_rigid(world.get(), SOUPLE_SHAPE_BOX, 20, SOUPLE_MOTION_FREE);
  auto joint = initialised(souple_joint_description_init);
  joint.body_a = hung;
  joint.point_m = {0, 0, 20};
  souple_joint made = 0;
  ASSERT_EQ(souple_world_add_joint(world.get(), &joint, &made), SOUPLE_OK) << souple_last_error_what();
  step_c(world.get(), 50);
  souple_pose pose{};
  ASSERT_EQ(souple_world_rigid_pose(world.get(), driven, &pose), SOUPLE_OK);
  EXPECT_NEAR(pose.translation_m.x, 0.5, 1e-9);
  ASSERT_EQ(souple_world_rigid_pose(world.get(), hung, &pose), SOUPLE_OK);
  EXPECT_NEAR(pose.translation_m.z, 20, 1e-6);
  souple_vec3 velocity{};
  ASSERT_EQ(souple_world_rigid_velocity(world.get(), free, &velocity, nullptr), SOUPLE_OK);
  EXPECT_NEAR(velocity.z, -9.81 * 0.5, 1e-9);
  ASSERT_EQ(souple_world_set_rigid_state(world.get(), free, pose, {1, 2, 3}, {0, 0, 0}), SOUPLE_OK);
  ASSERT_EQ(souple_world_rigid_velocity(world.get(), free, &velocity, nullptr), SOUPLE_OK);
  EXPECT_EQ(velocity.y, 2);
}

TEST(CWorld, AClosedMeshFromArraysHoldsWhatFallsOnIt) {
  // A tetrahedron whose top face is level at z = 0.
  const souple_vec3 corners[] = {{-1, -1, 0}, {1, -1, 0}, {0, 1, 0}, {0, 0, -1}};
  const souple_triangle faces[] = {{{0, 1, 2}}, {{0, 3, 1}}, {{1, 3, 2}}, {{2, 3, 0}}};
  souple_rigid_mesh* made = nullptr;
  ASSERT_EQ(souple_rigid_mesh_create(corners, 4, faces, 4, &made), SOUPLE_OK)
      << souple_last_error_what();
  MeshHandle mesh(made);
  const WorldHandle world = make_c_world();
  auto description = initialised(souple_rigid_body_description_init);
  description.shape = SOUPLE_SHAPE_MESH;
  description.mesh = mesh.get();
  souple_body ground = 0;
  ASSERT_EQ(souple_world_add_rigid_body(world.get(), &description, &ground), SOUPLE_OK);
  mesh.reset();
  AssetHandle asset = open_asset();
  const auto body = add_c_soft(world.get(), asset.get(), 0.01);
  asset.reset();  // the world keeps what it uses
  step_c(world.get(), 100);
  double lowest = 1;
  for (const souple_vec3& p : positions_of(world.get(), body)) lowest = std::min(lowest, p.z);
  EXPECT_NEAR(lowest, 0, 1e-3);
}

TEST(CWorld, ALoadOnAHeldBodyIsFeltAndSet) {
  const AssetHandle asset = open_asset();
  const WorldHandle world = make_c_world();
  const auto body = add_c_soft(world.get(), asset.get(), 0, "bottom");
  auto description = initialised(souple_load_description_init);
  const souple_load_keyframe course[] = {{0, {0, 0, 0}, 0}};
  std::vector<std::int32_t> nodes{63};
  description.nodes = nodes.data();
  description.node_count = 1;
  description.course = course;
  description.course_count = 1;
  souple_load load = 0;
  ASSERT_EQ(souple_world_add_load(world.get(), body, &description, &load), SOUPLE_OK)
      << souple_last_error_what();
  step_c(world.get(), 50);
  const double before = positions_of(world.get(), body)[63].x;
  EXPECT_EQ(souple_world_set_load(world.get(), load, {std::nan(""), 0, 0}, 0), SOUPLE_LOAD_INVALID);
  ASSERT_EQ(souple_world_set_load(world.get(), load, {1, 0, 0}, 0), SOUPLE_OK);
  step_c(world.get(), 50);
  EXPECT_GT(positions_of(world.get(), body)[63].x, before + 1e-3);
}

TEST(CWorld, PairsMayPassThroughEachOther) {
  const AssetHandle asset = open_asset();
  const WorldHandle world = make_c_world();
  const auto body = add_c_soft(world.get(), asset.get(), 0);
  const auto floor = add_c_rigid(world.get(), SOUPLE_SHAPE_PLANE, 0);
  ASSERT_EQ(souple_world_set_pair(world.get(), body, floor, 0, 0.4, 0), SOUPLE_OK);
  step_c(world.get(), 20);
  EXPECT_LT(positions_of(world.get(), body)[0].z, -0.1);
}

TEST(CWorld, AnotherWorldTakesOverTheState) {
  const AssetHandle asset = open_asset();
  const WorldHandle a = make_c_world(), b = make_c_world();
  const auto body = add_c_soft(a.get(), asset.get(), 1);
  add_c_soft(b.get(), asset.get(), 2);
  step_c(a.get(), 7);
  ASSERT_EQ(souple_world_copy_state(b.get(), a.get()), SOUPLE_OK);
  EXPECT_TRUE(same_bits(positions_of(a.get(), body), positions_of(b.get(), body)));
  const auto x = positions_of(a.get(), body);
  const std::vector<souple_vec3> still(x.size(), {0, 0, 0});
  ASSERT_EQ(souple_world_set_soft_state(a.get(), body, x.data(), still.data(), x.size()), SOUPLE_OK);
  std::vector<souple_vec3> velocities(x.size());
  ASSERT_EQ(souple_world_velocities(a.get(), body, velocities.data(), x.size(), nullptr), SOUPLE_OK);
  EXPECT_TRUE(same_bits(velocities, still));
}

TEST(CWorld, AStepThatIsNotFiniteIsRefusedAndChangesNothing) {
  const AssetHandle asset = open_asset();
  const WorldHandle world = make_c_world();
  const auto body = add_c_soft(world.get(), asset.get(), 0);
  add_c_rigid(world.get(), SOUPLE_SHAPE_PLANE, 0);
  auto huge = positions_of(world.get(), body);
  const std::vector<souple_vec3> still(huge.size(), {0, 0, 0});
  for (souple_vec3& p : huge) p = {1e300 * p.x, 1e300 * p.y, 1e300 * p.z};
  ASSERT_EQ(souple_world_set_soft_state(world.get(), body, huge.data(), still.data(), huge.size()),
            SOUPLE_OK);
  EXPECT_EQ(souple_world_step(world.get(), nullptr), SOUPLE_STEP_NOT_FINITE);
  EXPECT_TRUE(same_bits(positions_of(world.get(), body), huge));
  EXPECT_EQ(souple_world_time_s(world.get()), 0);
}

TEST(CWorld, StepsAndReadingAllocateNothing) {
  const AssetHandle asset = open_asset();
  const WorldHandle world = make_c_world();
  const auto body = add_c_soft(world.get(), asset.get(), 0);
  add_c_rigid(world.get(), SOUPLE_SHAPE_PLANE, 0);
  auto report = initialised(souple_step_report_init);
  std::vector<souple_vec3> x(64);
  std::vector<float> xyz(3 * 56);
  std::array<souple_contact_event, 8> events;
  const auto frame = [&] {
    souple_world_step(world.get(), &report);
    souple_world_positions(world.get(), body, x.data(), 64, nullptr);
    souple_world_velocities(world.get(), body, x.data(), 64, nullptr);
    souple_world_surface_positions(world.get(), body, x.data(), 56, nullptr);
    souple_world_surface_positions_f32(world.get(), body, xyz.data(), 56, nullptr);
    souple_world_visual_positions(world.get(), body, x.data(), 56, nullptr);
    souple_world_visual_positions_f32(world.get(), body, xyz.data(), 56, nullptr);
    souple_world_contact_events(world.get(), events.data(), events.size(), nullptr);
  };
  for (int k = 0; k < 100; ++k) frame();
  const std::size_t before = allocation_count();
  for (int k = 0; k < 100; ++k) frame();
  EXPECT_EQ(allocation_count(), before);
  EXPECT_GT(report.active_count, 0u);
}

}  // namespace
}  // namespace souple
