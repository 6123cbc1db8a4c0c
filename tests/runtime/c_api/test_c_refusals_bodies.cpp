// SPDX-License-Identifier: MIT
// What the C interface refuses of settings, bodies, rules and loads.

#include "c_refusals.hpp"

namespace souple {
namespace {

using namespace test;

TEST_F(CRefusals, Settings) {
  const auto with = [&](const char* why, souple_status expected,
                        std::function<void(souple_world_settings&)> spoil) {
    return described<souple_world_settings>("souple_world_create", why, expected,
                                            souple_world_settings_init, spoil,
                                            [this](const souple_world_settings* settings) {
                                              return souple_world_create(settings, &world_out);
                                            });
  };
  check({{"souple_world_create", "no place", missing,
          [] { return souple_world_create(nullptr, nullptr); }},
         with("size", bad_size, [](auto& s) { s.struct_size = 0; }),
         with("reserved", invalid, [](auto& s) { s.reserved = -1; }),
         with("integrator", invalid, [](auto& s) { s.integrator = 4; }),
         with("contact method", invalid, [](auto& s) { s.contact_method = -1; }),
         with("rotation method", invalid, [](auto& s) { s.rotation_method = 3; }),
         with("solver", invalid, [](auto& s) { s.solver = INT32_MAX; }),
         with("unconverged", invalid, [](auto& s) { s.unconverged = 2; }),
         with("time step", out_of_range, [](auto& s) { s.time_step_s = nan; }),
         with("gravity", out_of_range, [](auto& s) { s.gravity_m_s2.y = infinity; }),
         with("friction", out_of_range, [](auto& s) { s.friction = -0.1; }),
         with("alarm", out_of_range, [](auto& s) { s.alarm_distance_m = nan; }),
         with("passes", out_of_range, [](auto& s) { s.contact_passes = 0; }),
         with("stiffness", out_of_range, [](auto& s) { s.penalty_stiffness_n_m = -1; }),
         with("sleep", out_of_range, [](auto& s) { s.sleep_after_s = nan; }),
         with("sleep speed", out_of_range, [](auto& s) { s.sleep_speed_sides_s = -1; }),
         with("contact tolerance", out_of_range, [](auto& s) { s.contact_tolerance = 2; }),
         with("sweeps", out_of_range, [](auto& s) { s.contact_max_sweeps = INT32_MIN; }),
         with("penetration", out_of_range, [](auto& s) { s.contact_penetration_m = -1e-5; }),
         with("tolerance", out_of_range, [](auto& s) { s.free_motion_tolerance = nan; }),
         with("iterations", out_of_range, [](auto& s) { s.free_motion_max_iterations = 0; })});
  EXPECT_EQ(world_out, nullptr);
  souple_world_destroy(nullptr);
}

TEST_F(CRefusals, SoftBodies) {
  const souple_keyframe descending[] = {{1, identity}, {0, identity}};
  const souple_driven_set of_no_path[] = {{"bottom", nullptr, 1}};
  const souple_driven_set unknown[] = {{"top", descending, 1}};
  const souple_driven_set backwards[] = {{"bottom", descending, 2}};
  const auto with = [&](const char* why, souple_status expected,
                        std::function<void(souple_soft_body_description&)> spoil) {
    return described<souple_soft_body_description>(
        "souple_world_add_soft_body", why, expected, souple_soft_body_description_init, spoil,
        [this](const souple_soft_body_description* d) {
          return souple_world_add_soft_body(world, asset, d, &body_out);
        });
  };
  auto good = initialised(souple_soft_body_description_init);
  const char* function = "souple_world_add_soft_body";
  check({{function, "no world", missing,
          [&] { return souple_world_add_soft_body(nullptr, asset, &good, &body_out); }},
         {function, "no asset", missing,
          [&] { return souple_world_add_soft_body(world, nullptr, &good, &body_out); }},
         {function, "no description", missing,
          [&] { return souple_world_add_soft_body(world, asset, nullptr, &body_out); }},
         {function, "no place", missing,
          [&] { return souple_world_add_soft_body(world, asset, &good, nullptr); }},
         with("size", bad_size, [](auto& d) { d.struct_size -= 8; }),
         with("name", invalid, [](auto& d) { d.name = "\xFF"; }),
         with("rotation", out_of_range, [](auto& d) { d.pose = not_a_rotation; }),
         with("translation", out_of_range, [](auto& d) { d.pose = nan_pose; }),
         with("velocity", out_of_range, [](auto& d) { d.velocity_m_s.z = infinity; }),
         with("spin", out_of_range, [](auto& d) { d.angular_velocity_rad_s.x = nan; }),
         with("fixed set", SOUPLE_FIXED_SET_INVALID, [](auto& d) { d.fixed_set = "top"; }),
         with("no compliance for it", SOUPLE_NO_MATCHING_COMPLIANCE,
              [](auto& d) { d.fixed_set = "käntchen"; }),
         with("driven of NULL", missing, [](auto& d) { d.driven_count = 2; }),
         with("path of NULL", missing,
              [&](auto& d) { d.fixed_set = "bottom", d.driven = of_no_path, d.driven_count = 1; }),
         with("driven set", SOUPLE_DRIVEN_NODES_INVALID,
              [&](auto& d) { d.fixed_set = "bottom", d.driven = unknown, d.driven_count = 1; }),
         with("driven path", SOUPLE_DRIVEN_NODES_INVALID,
              [&](auto& d) { d.fixed_set = "bottom", d.driven = backwards, d.driven_count = 1; })});
}

TEST_F(CRefusals, RigidBodies) {
  const souple_keyframe descending[] = {{1, identity}, {0, identity}};
  const auto with = [&](const char* why, souple_status expected,
                        std::function<void(souple_rigid_body_description&)> spoil) {
    return described<souple_rigid_body_description>(
        "souple_world_add_rigid_body", why, expected, souple_rigid_body_description_init, spoil,
        [this](const souple_rigid_body_description* d) {
          return souple_world_add_rigid_body(world, d, &body_out);
        });
  };
  auto good = initialised(souple_rigid_body_description_init);
  const char* function = "souple_world_add_rigid_body";
  check({{function, "no world", missing,
          [&] { return souple_world_add_rigid_body(nullptr, &good, &body_out); }},
         {function, "no description", missing,
          [&] { return souple_world_add_rigid_body(world, nullptr, &body_out); }},
         {function, "no place", missing,
          [&] { return souple_world_add_rigid_body(world, &good, nullptr); }},
         with("size", bad_size, [](auto& d) { d.struct_size = 1; }),
         with("reserved", invalid, [](auto& d) { d.reserved = 5; }),
         with("shape", invalid, [](auto& d) { d.shape = 5; }),
         with("motion", invalid, [](auto& d) { d.motion = -1; }),
         with("name", invalid, [](auto& d) { d.name = "\xE2\x28\xA1"; }),
         with("radius", out_of_range, [](auto& d) { d.shape = SOUPLE_SHAPE_SPHERE; }),
         with("NaN radius", out_of_range,
              [](auto& d) { d.shape = SOUPLE_SHAPE_CAPSULE, d.radius_m = nan; }),
         with("extents", out_of_range,
              [](auto& d) { d.shape = SOUPLE_SHAPE_BOX, d.half_extents_m.x = -1; }),
         with("no mesh", out_of_range, [](auto& d) { d.shape = SOUPLE_SHAPE_MESH; }),
         with("pose", out_of_range, [](auto& d) { d.pose = nan_pose; }),
         with("path of NULL", missing,
              [](auto& d) { d.motion = SOUPLE_MOTION_DRIVEN, d.path_count = 1; }),
         with("no path", out_of_range, [](auto& d) { d.motion = SOUPLE_MOTION_DRIVEN; }),
         with("path", out_of_range,
              [&](auto& d) { d.motion = SOUPLE_MOTION_DRIVEN, d.path = descending, d.path_count = 2; }),
         with("path of a fixed one", invalid, [&](auto& d) { d.path = descending, d.path_count = 2; }),
         with("a free plane", out_of_range, [](auto& d) { d.motion = SOUPLE_MOTION_FREE; }),
         with("mass", out_of_range, [](auto& d) {
           d.motion = SOUPLE_MOTION_FREE, d.shape = SOUPLE_SHAPE_SPHERE, d.radius_m = 1,
           d.mass_kg = nan;
         })});
  for (const souple_world* absent :
       {static_cast<const souple_world*>(nullptr), static_cast<const souple_world*>(world)}) {
    EXPECT_EQ(souple_world_body_name(absent, none), nullptr);
    EXPECT_EQ(souple_world_is_soft(absent, none), 0);
    EXPECT_EQ(souple_world_is_asleep(absent, none), 0);
  }
  EXPECT_EQ(souple_world_body_count(nullptr), 0u);
  EXPECT_EQ(souple_world_time_s(nullptr), 0);
}

TEST_F(CRefusals, RulesAndStates) {
  check({
      {"souple_world_set_pair", "no world", missing,
       [&] { return souple_world_set_pair(nullptr, 0, 1, 1, 0.4, 0); }},
      {"souple_world_set_pair", "body", no_object,
       [&] { return souple_world_set_pair(world, 0, none, 1, 0.4, 0); }},
      {"souple_world_set_pair", "itself", out_of_range,
       [&] { return souple_world_set_pair(world, 1, 1, 1, 0.4, 0); }},
      {"souple_world_set_pair", "friction", out_of_range,
       [&] { return souple_world_set_pair(world, 0, 1, 1, nan, 0); }},
      {"souple_world_set_pair", "restitution", out_of_range,
       [&] { return souple_world_set_pair(world, 0, 1, 1, 0.4, 2); }},
      {"souple_world_solver", "no world", missing,
       [&] { return souple_world_solver(nullptr, soft, &number); }},
      {"souple_world_solver", "no place", missing,
       [&] { return souple_world_solver(world, soft, nullptr); }},
      {"souple_world_solver", "rigid", no_object,
       [&] { return souple_world_solver(world, rigid, &number); }},
      {"souple_world_wake", "no world", missing, [&] { return souple_world_wake(nullptr, soft); }},
      {"souple_world_wake", "body", no_object, [&] { return souple_world_wake(world, none); }},
      {"souple_world_set_soft_state", "no world", missing,
       [&] { return souple_world_set_soft_state(nullptr, soft, vectors.data(), vectors.data(), 64); }},
      {"souple_world_set_soft_state", "NULL", missing,
       [&] { return souple_world_set_soft_state(world, soft, vectors.data(), nullptr, 64); }},
      {"souple_world_set_soft_state", "rigid", no_object,
       [&] { return souple_world_set_soft_state(world, rigid, vectors.data(), vectors.data(), 64); }},
      {"souple_world_set_soft_state", "count", out_of_range,
       [&] { return souple_world_set_soft_state(world, soft, vectors.data(), vectors.data(), 63); }},
      {"souple_world_set_soft_state", "NaN", out_of_range,
       [&] {
         std::vector<souple_vec3> x(64, {0, nan, 0});
         return souple_world_set_soft_state(world, soft, x.data(), x.data(), 64);
       }},
      {"souple_world_set_rigid_state", "no world", missing,
       [&] { return souple_world_set_rigid_state(nullptr, rigid, identity, {}, {}); }},
      {"souple_world_set_rigid_state", "soft", no_object,
       [&] { return souple_world_set_rigid_state(world, soft, identity, {}, {}); }},
      {"souple_world_set_rigid_state", "fixed", out_of_range,
       [&] { return souple_world_set_rigid_state(world, rigid, identity, {}, {}); }},
      {"souple_world_copy_state", "no world", missing,
       [&] { return souple_world_copy_state(nullptr, world); }},
      {"souple_world_copy_state", "no other", missing,
       [&] { return souple_world_copy_state(world, nullptr); }},
      {"souple_world_copy_state", "other bodies", out_of_range,
       [&] { return souple_world_copy_state(world, make_c_world().get()); }},
      {"souple_world_snapshot", "no world", missing,
       [&] { return souple_world_snapshot(nullptr, nullptr, 0, &needed); }},
      {"souple_world_snapshot", "small", too_small,
       [&] { return souple_world_snapshot(world, xyz, 1, &needed); }},
      {"souple_world_restore", "no world", missing,
       [&] { return souple_world_restore(nullptr, snapshot.data(), snapshot.size()); }},
      {"souple_world_restore", "no bytes", missing,
       [&] { return souple_world_restore(world, nullptr, 1); }},
      {"souple_world_restore", "half", SOUPLE_SNAPSHOT_INVALID,
       [&] { return souple_world_restore(world, snapshot.data(), snapshot.size() / 2); }},
      {"souple_world_restore", "none", SOUPLE_SNAPSHOT_INVALID,
       [&] { return souple_world_restore(world, snapshot.data(), 0); }},
  });
}

TEST_F(CRefusals, Loads) {
  const souple_load_keyframe course[] = {{0, {0, 0, 1}, 0}};
  const souple_load_keyframe bad_course[] = {{nan, {0, 0, 1}, 0}};
  const std::int32_t nodes[] = {3}, beyond[] = {64};
  souple_load load = 0;
  auto good = initialised(souple_load_description_init);
  good.nodes = nodes, good.node_count = 1, good.course = course, good.course_count = 1;
  const auto with = [&](const char* why, souple_status expected,
                        std::function<void(souple_load_description&)> spoil) {
    return Refusal{"souple_world_add_load", why, expected, [=, this] {
                     auto d = good;
                     spoil(d);
                     souple_load out = 0;
                     return souple_world_add_load(world, soft, &d, &out);
                   }};
  };
  const char* function = "souple_world_add_load";
  check({{function, "no world", missing,
          [&] { return souple_world_add_load(nullptr, soft, &good, &load); }},
         {function, "no description", missing,
          [&] { return souple_world_add_load(world, soft, nullptr, &load); }},
         {function, "no place", missing,
          [&] { return souple_world_add_load(world, soft, &good, nullptr); }},
         {function, "rigid", no_object,
          [&] { return souple_world_add_load(world, rigid, &good, &load); }},
         with("size", bad_size, [](auto& d) { d.struct_size = 0; }),
         with("kind", invalid, [](auto& d) { d.kind = 4; }),
         with("nodes of NULL", missing, [](auto& d) { d.nodes = nullptr; }),
         with("too many nodes", invalid, [](auto& d) { d.node_count = SIZE_MAX; }),
         with("triangles of NULL", missing, [](auto& d) { d.triangle_count = 1; }),
         with("course of NULL", missing, [](auto& d) { d.course = nullptr; }),
         with("no course", SOUPLE_LOAD_INVALID, [](auto& d) { d.course_count = 0; }),
         with("NaN", SOUPLE_LOAD_INVALID, [&](auto& d) { d.course = bad_course; }),
         with("node", SOUPLE_LOAD_INVALID, [&](auto& d) { d.nodes = beyond; }),
         with("triangle", SOUPLE_LOAD_INVALID,
              [](auto& d) { d.kind = SOUPLE_LOAD_POINT_FORCE, d.node_count = 0, d.triangle = 9999; }),
         {"souple_world_set_load", "no world", missing,
          [] { return souple_world_set_load(nullptr, 0, {}, 0); }},
         {"souple_world_set_load", "no load", SOUPLE_LOAD_INVALID,
          [&] { return souple_world_set_load(world, UINT64_MAX, {}, 0); }},
         {"souple_world_set_load", "of another body", SOUPLE_LOAD_INVALID,
          [&] { return souple_world_set_load(world, std::uint64_t{1} << 32, {}, 0); }}});
}

}  // namespace
}  // namespace souple
