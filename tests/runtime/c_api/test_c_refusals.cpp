// SPDX-License-Identifier: MIT
// Whatever a function of the C interface is given, it answers with a code and leaves the world as it
// was.
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <fstream>
#include <functional>
#include <limits>
#include <random>
#include <regex>
#include <set>

#include "c_scene.hpp"

namespace souple {
namespace {

using namespace test;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr souple_body none = 77;
constexpr souple_pose identity{{1, 0, 0, 0}, {0, 0, 0}};
constexpr souple_pose not_a_rotation{{0, 0, 0, 0}, {0, 0, 0}};
constexpr souple_pose nan_pose{{1, 0, 0, 0}, {nan, 0, 0}};

struct Refusal {
  std::string function;
  std::string why;
  souple_status expected;
  std::function<souple_status()> call;
};

class CRefusals : public testing::Test {
 protected:
  CRefusals() {
    soft = add_c_soft(world, asset, 0);
    rigid = add_c_rigid(world, SOUPLE_SHAPE_PLANE, 0);
    step_c(world, 3);
    snapshot = snapshot_of(world);
    vectors.resize(64);
  }

  /// Every call is refused with its code and a text, and the world is the same.
  void check(const std::vector<Refusal>& refusals) {
    const auto state = snapshot_of(world);
    const std::size_t body_count = souple_world_body_count(world);
    for (const Refusal& refusal : refusals) {
      SCOPED_TRACE(refusal.function + ": " + refusal.why);
      EXPECT_EQ(refusal.call(), refusal.expected) << souple_last_error_what();
      EXPECT_EQ(souple_last_error_code(), refusal.expected);
      EXPECT_STRNE(souple_last_error_what(), "");
      EXPECT_STRNE(souple_last_error_mend(), "");
    }
    EXPECT_TRUE(snapshot_of(world) == state);
    EXPECT_EQ(souple_world_body_count(world), body_count);
    step_c(world, 1);
  }

  template <class T>
  Refusal described(const char* function, const char* why, souple_status expected,
                    souple_status (*init)(T*, std::size_t), std::function<void(T&)> spoil,
                    std::function<souple_status(const T*)> call) {
    return {function, why, expected, [=] {
              T description = initialised(init);
              spoil(description);
              return call(&description);
            }};
  }

  AssetHandle asset_handle = open_asset();
  WorldHandle world_handle = make_c_world();
  souple_asset* asset = asset_handle.get();
  souple_world* world = world_handle.get();
  souple_body soft = 0, rigid = 0;
  std::vector<std::byte> snapshot;
  std::vector<souple_vec3> vectors;
  // Where results would go.
  souple_asset* asset_out = nullptr;
  souple_world* world_out = nullptr;
  souple_rigid_mesh* mesh_out = nullptr;
  souple_body body_out = 0;
  std::size_t needed = 0;
  float xyz[3] = {};
  std::int32_t number = 0;
};

constexpr souple_status missing = SOUPLE_API_ARGUMENT_MISSING, invalid = SOUPLE_API_ARGUMENT_INVALID,
                        too_small = SOUPLE_API_BUFFER_TOO_SMALL, no_object = SOUPLE_API_NO_SUCH_OBJECT,
                        bad_size = SOUPLE_API_STRUCT_SIZE_INVALID,
                        out_of_range = SOUPLE_WORLD_PARAMETER_INVALID;

TEST_F(CRefusals, InitFunctionsWantAStructAndItsSize) {
  const auto refuses = [&](const char* name, auto init) {
    check({{name, "no struct", missing, [=] { return init(nullptr, 1000); }}});
  };
  refuses("souple_load_options_init", souple_load_options_init);
  refuses("souple_asset_facts_init", souple_asset_facts_init);
  refuses("souple_compliance_facts_init", souple_compliance_facts_init);
  refuses("souple_world_settings_init", souple_world_settings_init);
  refuses("souple_soft_body_description_init", souple_soft_body_description_init);
  refuses("souple_rigid_body_description_init", souple_rigid_body_description_init);
  refuses("souple_load_description_init", souple_load_description_init);
  refuses("souple_joint_description_init", souple_joint_description_init);
  refuses("souple_step_report_init", souple_step_report_init);
  refuses("souple_jaw_description_init", souple_jaw_description_init);
  refuses("souple_tool_description_init", souple_tool_description_init);
  refuses("souple_haptic_settings_init", souple_haptic_settings_init);
  refuses("souple_haptic_telemetry_init", souple_haptic_telemetry_init);
}

TEST_F(CRefusals, Assets) {
  const char text[] = "this is not an asset at all, however long it may be made";
  const std::string long_path(5000, 'x');
  const char* const unknown[] = {"no such compliance"};
  const char* const absent[] = {nullptr};
  const auto with_options = [&](const char* why, souple_status expected,
                                std::function<void(souple_load_options&)> spoil) {
    return described<souple_load_options>(
        "souple_asset_open_file", why, expected, souple_load_options_init, spoil,
        [this](const souple_load_options* options) {
          return souple_asset_open_file(asset_file().c_str(), options, &asset_out);
        });
  };
  const char* function = "souple_asset_open_file";
  check({{function, "no path", missing,
          [&] { return souple_asset_open_file(nullptr, nullptr, &asset_out); }},
         {function, "no place", missing, [&] { return souple_asset_open_file("a", nullptr, nullptr); }},
         {function, "no file", SOUPLE_IO_FILE_MISSING,
          [&] { return souple_asset_open_file("/no/such/file", nullptr, &asset_out); }},
         {function, "a folder", SOUPLE_IO_CANNOT_READ,
          [&] { return souple_asset_open_file("/", nullptr, &asset_out); }},
         {function, "empty path", SOUPLE_IO_FILE_MISSING,
          [&] { return souple_asset_open_file("", nullptr, &asset_out); }},
         {function, "long path", invalid,
          [&] { return souple_asset_open_file(long_path.c_str(), nullptr, &asset_out); }},
         with_options("size", bad_size, [](auto& o) { o.struct_size = 3; }),
         with_options("reserved", invalid, [](auto& o) { o.reserved = 1; }),
         with_options("unknown compliance", SOUPLE_ASSET_MISSING_PART,
                      [&](auto& o) { o.compliances = unknown, o.compliance_count = 1; }),
         with_options("null compliance", SOUPLE_ASSET_MISSING_PART,
                      [&](auto& o) { o.compliances = absent, o.compliance_count = 1; }),
         with_options("no names", missing, [](auto& o) { o.compliance_count = 1; }),
         with_options("tables", invalid, [](auto& o) { o.table_bytes = UINT64_MAX; })});
  function = "souple_asset_open_memory";
  check({{function, "no bytes", missing,
          [&] { return souple_asset_open_memory(nullptr, 9, nullptr, &asset_out); }},
         {function, "no place", missing,
          [&] { return souple_asset_open_memory(text, 9, nullptr, nullptr); }},
         {function, "none of them", SOUPLE_ASSET_NOT_AN_ASSET,
          [&] { return souple_asset_open_memory(text, 0, nullptr, &asset_out); }},
         {function, "a text", SOUPLE_ASSET_NOT_AN_ASSET,
          [&] { return souple_asset_open_memory(text, sizeof text, nullptr, &asset_out); }},
         {function, "half of it", SOUPLE_ASSET_CORRUPT, [&] {
            return souple_asset_open_memory(asset_bytes().data(), asset_bytes().size() / 2, nullptr,
                                            &asset_out);
          }}});
  EXPECT_EQ(asset_out, nullptr);
}

TEST_F(CRefusals, PartsOfAssets) {
  auto facts = initialised(souple_asset_facts_init);
  souple_asset_facts unsized{};
  auto held = initialised(souple_compliance_facts_init);
  souple_triangle triangle{};
  auto options = initialised(souple_load_options_init);
  options.visual = 0;
  souple_asset* opened = nullptr;
  ASSERT_EQ(souple_asset_open_file(asset_file().c_str(), &options, &opened), SOUPLE_OK);
  const AssetHandle plain(opened);
  check({
      {"souple_asset_get_facts", "no asset", missing,
       [&] { return souple_asset_get_facts(nullptr, &facts); }},
      {"souple_asset_get_facts", "no facts", missing,
       [&] { return souple_asset_get_facts(asset, nullptr); }},
      {"souple_asset_get_facts", "size", bad_size,
       [&] { return souple_asset_get_facts(asset, &unsized); }},
      {"souple_asset_get_compliance", "no asset", missing,
       [&] { return souple_asset_get_compliance(nullptr, 0, &held); }},
      {"souple_asset_get_compliance", "no facts", missing,
       [&] { return souple_asset_get_compliance(asset, 0, nullptr); }},
      {"souple_asset_get_compliance", "beyond", invalid,
       [&] { return souple_asset_get_compliance(asset, SIZE_MAX, &held); }},
      {"souple_asset_fixed_set_nodes", "no name", missing,
       [&] { return souple_asset_fixed_set_nodes(asset, nullptr, nullptr, 0, &needed); }},
      {"souple_asset_fixed_set_nodes", "no asset", missing,
       [&] { return souple_asset_fixed_set_nodes(nullptr, "bottom", nullptr, 0, &needed); }},
      {"souple_asset_fixed_set_nodes", "unknown", SOUPLE_FIXED_SET_INVALID,
       [&] { return souple_asset_fixed_set_nodes(asset, "top", nullptr, 0, &needed); }},
      {"souple_asset_fixed_set_nodes", "not UTF-8", invalid,
       [&] { return souple_asset_fixed_set_nodes(asset, "\xC0\x80", nullptr, 0, &needed); }},
      {"souple_asset_fixed_set_nodes", "small", too_small,
       [&] { return souple_asset_fixed_set_nodes(asset, "bottom", &number, 1, &needed); }},
      {"souple_asset_rest_positions", "no asset", missing,
       [&] { return souple_asset_rest_positions(nullptr, nullptr, 0, &needed); }},
      {"souple_asset_rest_positions", "nothing to write to", missing,
       [&] { return souple_asset_rest_positions(asset, nullptr, 0, nullptr); }},
      {"souple_asset_rest_positions", "small", too_small,
       [&] { return souple_asset_rest_positions(asset, vectors.data(), 63, &needed); }},
      {"souple_asset_surface_nodes", "no asset", missing,
       [&] { return souple_asset_surface_nodes(nullptr, nullptr, 0, &needed); }},
      {"souple_asset_surface_nodes", "null of some size", missing,
       [&] { return souple_asset_surface_nodes(asset, nullptr, 1000, &needed); }},
      {"souple_asset_surface_nodes", "small", too_small,
       [&] { return souple_asset_surface_nodes(asset, &number, 1, nullptr); }},
      {"souple_asset_surface_triangles", "no asset", missing,
       [&] { return souple_asset_surface_triangles(nullptr, nullptr, 0, &needed); }},
      {"souple_asset_surface_triangles", "small", too_small,
       [&] { return souple_asset_surface_triangles(asset, &triangle, 1, &needed); }},
      {"souple_asset_visual_triangles", "no asset", missing,
       [&] { return souple_asset_visual_triangles(nullptr, nullptr, 0, &needed); }},
      {"souple_asset_visual_triangles", "not loaded", SOUPLE_ASSET_MISSING_PART,
       [&] { return souple_asset_visual_triangles(plain.get(), nullptr, 0, &needed); }},
      {"souple_asset_visual_triangles", "small", too_small,
       [&] { return souple_asset_visual_triangles(asset, &triangle, 1, &needed); }},
  });
  EXPECT_EQ(souple_asset_content_hash(nullptr), nullptr);
  EXPECT_EQ(souple_asset_fixed_set_name(nullptr, 0), nullptr);
  EXPECT_EQ(souple_asset_fixed_set_name(asset, SIZE_MAX), nullptr);
  souple_asset_release(nullptr);
}

TEST_F(CRefusals, RigidMeshes) {
  const souple_vec3 corners[] = {{-1, -1, 0}, {1, -1, 0}, {0, 1, 0}, {0, 0, -1}};
  const souple_vec3 not_finite[] = {{-1, -1, 0}, {1, nan, 0}, {0, 1, 0}, {0, 0, -1}};
  const souple_triangle faces[] = {{{0, 1, 2}}, {{0, 3, 1}}, {{1, 3, 2}}, {{2, 3, 0}}};
  const souple_triangle inward[] = {{{0, 2, 1}}, {{0, 1, 3}}, {{1, 2, 3}}, {{2, 0, 3}}};
  const souple_triangle beyond[] = {{{0, 1, 2}}, {{0, 4, 1}}, {{1, 3, 2}}, {{2, 3, -1}}};
  const char* function = "souple_rigid_mesh_create";
  const auto with = [&](const char* why, souple_status expected, const souple_vec3* x, std::size_t n,
                        const souple_triangle* t, std::size_t m) {
    return Refusal{function, why, expected,
                   [=, this] { return souple_rigid_mesh_create(x, n, t, m, &mesh_out); }};
  };
  check({with("no vertices", missing, nullptr, 4, faces, 4),
         with("no triangles", missing, corners, 4, nullptr, 4),
         with("empty", SOUPLE_RIGID_MESH_INVALID, corners, 0, faces, 0),
         with("too many vertices", invalid, corners, SIZE_MAX, faces, 4),
         with("too many triangles", invalid, corners, 4, faces, SIZE_MAX / 2),
         with("open", SOUPLE_RIGID_MESH_INVALID, corners, 4, faces, 3),
         with("inward", SOUPLE_RIGID_MESH_INVALID, corners, 4, inward, 4),
         with("indices", SOUPLE_RIGID_MESH_INVALID, corners, 4, beyond, 4),
         with("NaN", SOUPLE_RIGID_MESH_INVALID, not_finite, 4, faces, 4),
         {function, "no place", missing,
          [&] { return souple_rigid_mesh_create(corners, 4, faces, 4, nullptr); }}});
  EXPECT_EQ(mesh_out, nullptr);
  souple_rigid_mesh_release(nullptr);
}

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

TEST_F(CRefusals, JointsGrabsAndPicks) {
  souple_joint joint = 0;
  souple_grab grab = 0;
  souple_pick_hit hit{};
  auto good = initialised(souple_joint_description_init);
  good.body_a = soft;
  const auto with = [&](const char* why, souple_status expected,
                        std::function<void(souple_joint_description&)> spoil) {
    return Refusal{"souple_world_add_joint", why, expected, [=, this] {
                     auto d = good;
                     spoil(d);
                     souple_joint out = 0;
                     return souple_world_add_joint(world, &d, &out);
                   }};
  };
  check({{"souple_world_add_joint", "no world", missing,
          [&] { return souple_world_add_joint(nullptr, &good, &joint); }},
         {"souple_world_add_joint", "no description", missing,
          [&] { return souple_world_add_joint(world, nullptr, &joint); }},
         {"souple_world_add_joint", "no place", missing,
          [&] { return souple_world_add_joint(world, &good, nullptr); }},
         with("size", bad_size, [](auto& d) { d.struct_size = 0; }),
         with("kind", invalid, [](auto& d) { d.kind = 3; }),
         with("reserved", invalid, [](auto& d) { d.reserved = 1; }),
         with("body", SOUPLE_JOINT_INVALID, [](auto& d) { d.body_a = none; }),
         with("other body", SOUPLE_JOINT_INVALID, [](auto& d) { d.body_b = none; }),
         with("itself", SOUPLE_JOINT_INVALID, [](auto& d) { d.body_b = d.body_a; }),
         with("far away", SOUPLE_JOINT_INVALID, [](auto& d) { d.point_m.x = 3; }),
         with("NaN", SOUPLE_JOINT_INVALID, [](auto& d) { d.point_m.x = nan; }),
         with("axis", SOUPLE_JOINT_INVALID,
              [](auto& d) {
                d.axis = {0, 0, 0};
              }),
         with("arm", SOUPLE_JOINT_INVALID, [](auto& d) { d.arm_m = -1; })});
  check({
      {"souple_world_grab", "no world", missing,
       [&] { return souple_world_grab(nullptr, soft, {}, 0, 1, &grab); }},
      {"souple_world_grab", "no place", missing,
       [&] { return souple_world_grab(world, soft, {}, 0, 1, nullptr); }},
      {"souple_world_grab", "body", no_object,
       [&] { return souple_world_grab(world, none, {}, 0, 1, &grab); }},
      {"souple_world_grab", "fixed body", SOUPLE_JOINT_INVALID,
       [&] { return souple_world_grab(world, rigid, {}, 0, 1, &grab); }},
      {"souple_world_grab", "NaN", SOUPLE_JOINT_INVALID,
       [&] {
         return souple_world_grab(world, soft, {nan, 0, 0}, 0, 1, &grab);
       }},
      {"souple_world_grab", "radius", SOUPLE_JOINT_INVALID,
       [&] { return souple_world_grab(world, soft, {}, nan, 1, &grab); }},
      {"souple_world_grab", "nodes", invalid,
       [&] { return souple_world_grab(world, soft, {}, 0, INT32_MAX, &grab); }},
      {"souple_world_move_grab", "no world", missing,
       [&] { return souple_world_move_grab(nullptr, 0, identity); }},
      {"souple_world_move_grab", "no grab", out_of_range,
       [&] { return souple_world_move_grab(world, 3, identity); }},
      {"souple_world_release", "no world", missing, [&] { return souple_world_release(nullptr, 0); }},
      {"souple_world_release", "no grab", out_of_range, [&] { return souple_world_release(world, 0); }},
      {"souple_world_pick", "no world", missing,
       [&] {
         return souple_world_pick(nullptr, {}, {1, 0, 0}, 1, &hit);
       }},
      {"souple_world_pick", "no place", missing,
       [&] {
         return souple_world_pick(world, {}, {1, 0, 0}, 1, nullptr);
       }},
      {"souple_world_pick", "origin", invalid,
       [&] {
         return souple_world_pick(world, {nan, 0, 0}, {1, 0, 0}, 1, &hit);
       }},
      {"souple_world_pick", "direction", invalid,
       [&] {
         return souple_world_pick(world, {}, {0, 0, 0}, 1, &hit);
       }},
      {"souple_world_pick", "NaN direction", invalid,
       [&] {
         return souple_world_pick(world, {}, {0, infinity, 0}, 1, &hit);
       }},
      {"souple_world_pick", "reach", invalid,
       [&] {
         return souple_world_pick(world, {}, {1, 0, 0}, nan, &hit);
       }},
  });
  ASSERT_EQ(souple_world_grab(world, soft, {0, 0, 0.1}, 0, 1, &grab), SOUPLE_OK);
  EXPECT_EQ(souple_world_move_grab(world, grab, nan_pose), out_of_range);
  EXPECT_EQ(souple_world_move_grab(world, grab, not_a_rotation), out_of_range);
  EXPECT_EQ(souple_world_release(world, grab), SOUPLE_OK);
  EXPECT_EQ(souple_world_release(world, grab), out_of_range);
}

TEST_F(CRefusals, StepsAndWhatTheyMade) {
  souple_step_report unsized{};
  souple_pose pose{};
  souple_contact contact{};
  souple_contact_event event{};
  std::vector<Refusal> refusals{
      {"souple_world_step", "no world", missing, [] { return souple_world_step(nullptr, nullptr); }},
      {"souple_world_step", "size", bad_size, [&] { return souple_world_step(world, &unsized); }},
      {"souple_world_run_jobs_with", "no world", missing,
       [] { return souple_world_run_jobs_with(nullptr, nullptr, nullptr); }},
      {"souple_world_rigid_pose", "no world", missing,
       [&] { return souple_world_rigid_pose(nullptr, rigid, &pose); }},
      {"souple_world_rigid_pose", "no place", missing,
       [&] { return souple_world_rigid_pose(world, rigid, nullptr); }},
      {"souple_world_rigid_pose", "soft", no_object,
       [&] { return souple_world_rigid_pose(world, soft, &pose); }},
      {"souple_world_rigid_velocity", "no world", missing,
       [&] { return souple_world_rigid_velocity(nullptr, rigid, nullptr, nullptr); }},
      {"souple_world_rigid_velocity", "body", no_object,
       [&] { return souple_world_rigid_velocity(world, none, nullptr, nullptr); }},
      {"souple_world_contacts", "no world", missing,
       [&] { return souple_world_contacts(nullptr, nullptr, 0, &needed); }},
      {"souple_world_contacts", "small", too_small,
       [&] { return souple_world_contacts(world, &contact, 1, &needed); }},
      {"souple_world_contact_events", "no world", missing,
       [&] { return souple_world_contact_events(nullptr, nullptr, 0, &needed); }},
      {"souple_world_contact_events", "small", too_small,
       [&] { return souple_world_contact_events(world, &event, 0, &needed); }},
  };
  // Functions that read vectors of a soft body.
  const auto reads = [&](const char* function, auto read, auto* buffer) {
    refusals.push_back({function, "no world", missing,
                        [=, this] { return read(nullptr, soft, nullptr, 0, &needed); }});
    refusals.push_back(
        {function, "no body", no_object, [=, this] { return read(world, none, nullptr, 0, &needed); }});
    refusals.push_back(
        {function, "rigid", no_object, [=, this] { return read(world, rigid, nullptr, 0, &needed); }});
    refusals.push_back(
        {function, "nowhere", missing, [=, this] { return read(world, soft, nullptr, 0, nullptr); }});
    refusals.push_back(
        {function, "NULL", missing, [=, this] { return read(world, soft, nullptr, 99, &needed); }});
    refusals.push_back(
        {function, "small", too_small, [=, this] { return read(world, soft, buffer, 1, &needed); }});
  };
  reads("souple_world_positions", souple_world_positions, vectors.data());
  reads("souple_world_velocities", souple_world_velocities, vectors.data());
  reads("souple_world_surface_positions", souple_world_surface_positions, vectors.data());
  reads("souple_world_surface_positions_f32", souple_world_surface_positions_f32, xyz);
  reads("souple_world_visual_positions", souple_world_visual_positions, vectors.data());
  reads("souple_world_visual_positions_f32", souple_world_visual_positions_f32, xyz);
  check(refusals);
}

TEST_F(CRefusals, ToolsAndHapticSettings) {
  const char* function = "souple_haptic_channel_create";
  auto good = initialised(souple_jaw_description_init);
  good.radius_m = 0.01;
  auto unsized = good;
  unsized.struct_size = 16;
  souple_haptic_channel* channel = nullptr;
  const auto with_jaw = [&](const char* why, souple_status expected,
                            std::function<void(souple_jaw_description&)> spoil) {
    return Refusal{function, why, expected, [=, this] {
                     souple_jaw_description jaws[] = {good, good};
                     spoil(jaws[1]);
                     auto tool = initialised(souple_tool_description_init);
                     tool.jaws = jaws, tool.jaw_count = 2;
                     souple_haptic_channel* made = nullptr;
                     return souple_haptic_channel_create(world, &tool, nullptr, &made);
                   }};
  };
  const auto with_tool = [&](const char* why, souple_status expected,
                             std::function<void(souple_tool_description&)> spoil) {
    return Refusal{function, why, expected, [=, this] {
                     auto tool = initialised(souple_tool_description_init);
                     tool.jaws = &good, tool.jaw_count = 1;
                     spoil(tool);
                     souple_haptic_channel* made = nullptr;
                     return souple_haptic_channel_create(world, &tool, nullptr, &made);
                   }};
  };
  const auto with = [&](const char* why, souple_status expected,
                        std::function<void(souple_haptic_settings&)> spoil) {
    return Refusal{function, why, expected, [=, this] {
                     auto tool = initialised(souple_tool_description_init);
                     tool.jaws = &good, tool.jaw_count = 1;
                     auto settings = initialised(souple_haptic_settings_init);
                     spoil(settings);
                     souple_haptic_channel* made = nullptr;
                     return souple_haptic_channel_create(world, &tool, &settings, &made);
                   }};
  };
  auto tool = initialised(souple_tool_description_init);
  tool.jaws = &good, tool.jaw_count = 1;
  check({
      {function, "no world", missing,
       [&] { return souple_haptic_channel_create(nullptr, &tool, nullptr, &channel); }},
      {function, "no tool", missing,
       [&] { return souple_haptic_channel_create(world, nullptr, nullptr, &channel); }},
      {function, "no place", missing,
       [&] { return souple_haptic_channel_create(world, &tool, nullptr, nullptr); }},
      with_tool("size", bad_size, [](auto& t) { t.struct_size = 2; }),
      with_tool("reserved", invalid, [](auto& t) { t.reserved = 2; }),
      with_tool("name", invalid, [](auto& t) { t.name = "\xFE"; }),
      with_tool("no jaws", invalid, [](auto& t) { t.jaw_count = 0; }),
      with_tool("many jaws", invalid, [](auto& t) { t.jaw_count = SIZE_MAX; }),
      with_tool("jaws of NULL", missing, [](auto& t) { t.jaws = nullptr; }),
      with_tool("unsized jaw", bad_size, [&](auto& t) { t.jaws = &unsized; }),
      with_tool("pose", out_of_range, [](auto& t) { t.pose = nan_pose; }),
      with_tool("opening", out_of_range, [](auto& t) { t.opening_rad = nan; }),
      with_jaw("sizes", bad_size, [](auto& j) { j.struct_size += 8; }),
      with_jaw("shape", invalid, [](auto& j) { j.shape = 9; }),
      with_jaw("plane", invalid, [](auto& j) { j.shape = SOUPLE_SHAPE_PLANE; }),
      with_jaw("radius", out_of_range, [](auto& j) { j.radius_m = nan; }),
      with_jaw("no mesh", out_of_range, [](auto& j) { j.shape = SOUPLE_SHAPE_MESH; }),
      with_jaw("hinge", out_of_range, [](auto& j) { j.hinge = nan_pose; }),
      with_jaw("mount", out_of_range, [](auto& j) { j.mount = nan_pose; }),
      with_jaw("axis", out_of_range,
               [](auto& j) {
                 j.axis = {0, 0, 0};
               }),
      with_jaw("turn", out_of_range, [](auto& j) { j.turn_per_opening = nan; }),
      with_jaw("stiffness", out_of_range, [](auto& j) { j.stiffness_n_m = -1; }),
      with_jaw("turn stiffness", out_of_range, [](auto& j) { j.turn_stiffness_nm_rad = nan; }),
      with_jaw("damping", out_of_range, [](auto& j) { j.damping_n_s_m = -1; }),
      with_jaw("turn damping", out_of_range, [](auto& j) { j.turn_damping_nm_s_rad = infinity; }),
      with_jaw("centre", out_of_range, [](auto& j) { j.centre_m.x = nan; }),
      with_jaw("look ahead", out_of_range, [](auto& j) { j.look_ahead_m = nan; }),
      with("size", bad_size, [](auto& s) { s.struct_size = 8; }),
      with("reserved", invalid, [](auto& s) { s.reserved = 8; }),
      with("capacity", out_of_range, [](auto& s) { s.contact_capacity = 0; }),
      with("large capacity", out_of_range, [](auto& s) { s.contact_capacity = SIZE_MAX; }),
      with("budget", out_of_range, [](auto& s) { s.tick_budget_s = nan; }),
      with("residual", out_of_range, [](auto& s) { s.residual_goal = -1; }),
      with("sweeps", out_of_range, [](auto& s) { s.max_sweeps = 0; }),
      with("hand-over", out_of_range, [](auto& s) { s.hand_over_s = nan; }),
      with("hand-over share", out_of_range, [](auto& s) { s.hand_over_share = nan; }),
      with("death", out_of_range, [](auto& s) { s.dead_after_s = 0; }),
      with("fade", out_of_range, [](auto& s) { s.fade_s = nan; }),
      with("speed", out_of_range, [](auto& s) { s.credible_speed_m_s = nan; }),
      with("turn speed", out_of_range, [](auto& s) { s.credible_turn_rad_s = -1; }),
      with("recovery", out_of_range, [](auto& s) { s.recover_after_s = infinity; }),
      with("reach", out_of_range, [](auto& s) { s.reach_m = 0; }),
      with("lead", out_of_range, [](auto& s) { s.lead_s = -0.001; }),
      with("rate", out_of_range, [](auto& s) { s.device_rate_hz = nan; }),
      with("force", out_of_range, [](auto& s) { s.device_force_n = nan; }),
      with("slew", out_of_range, [](auto& s) { s.device_torque_slew_nm_s = -1; }),
  });
  EXPECT_EQ(channel, nullptr);
  souple_haptic_channel_destroy(nullptr);
}

TEST_F(CRefusals, HapticChannels) {
  auto jaw = initialised(souple_jaw_description_init);
  jaw.radius_m = 0.01;
  auto tool = initialised(souple_tool_description_init);
  tool.jaws = &jaw, tool.jaw_count = 1, tool.pose.translation_m = {0, 0, 1};
  souple_haptic_channel* made = nullptr;
  ASSERT_EQ(souple_haptic_channel_create(world, &tool, nullptr, &made), SOUPLE_OK)
      << souple_last_error_what();
  const ChannelHandle handle(made);
  souple_haptic_channel* channel = made;
  const WorldHandle other = make_c_world();
  souple_device_sample sample{0, identity, 0};
  souple_wrench wrench{};
  souple_haptic_telemetry unsized{};
  auto telemetry = initialised(souple_haptic_telemetry_init);
  check({
      {"souple_haptic_tool_bodies", "no channel", missing,
       [&] { return souple_haptic_tool_bodies(nullptr, &body_out, 1, &needed); }},
      {"souple_haptic_tool_bodies", "small", too_small,
       [&] { return souple_haptic_tool_bodies(channel, &body_out, 0, &needed); }},
      {"souple_haptic_begin_step", "no channel", missing,
       [&] { return souple_haptic_begin_step(nullptr, world); }},
      {"souple_haptic_begin_step", "no world", missing,
       [&] { return souple_haptic_begin_step(channel, nullptr); }},
      {"souple_haptic_begin_step", "another world", no_object,
       [&] { return souple_haptic_begin_step(channel, other.get()); }},
      {"souple_haptic_publish", "no channel", missing,
       [&] { return souple_haptic_publish(nullptr, world); }},
      {"souple_haptic_publish", "no world", missing,
       [&] { return souple_haptic_publish(channel, nullptr); }},
      {"souple_haptic_publish", "another world", no_object,
       [&] { return souple_haptic_publish(channel, other.get()); }},
      {"souple_haptic_newest_sample", "no channel", missing,
       [&] { return souple_haptic_newest_sample(nullptr, &sample, &number); }},
      {"souple_haptic_newest_sample", "no sample", missing,
       [&] { return souple_haptic_newest_sample(channel, nullptr, &number); }},
      {"souple_haptic_newest_sample", "no place", missing,
       [&] { return souple_haptic_newest_sample(channel, &sample, nullptr); }},
      {"souple_haptic_tick", "no channel", missing,
       [&] { return souple_haptic_tick(nullptr, &sample, &wrench); }},
      {"souple_haptic_tick", "no place", missing,
       [&] { return souple_haptic_tick(channel, &sample, nullptr); }},
      {"souple_haptic_last_tick", "no channel", missing,
       [&] { return souple_haptic_last_tick(nullptr, &wrench, nullptr); }},
      {"souple_haptic_get_telemetry", "no channel", missing,
       [&] { return souple_haptic_get_telemetry(nullptr, &telemetry); }},
      {"souple_haptic_get_telemetry", "no telemetry", missing,
       [&] { return souple_haptic_get_telemetry(channel, nullptr); }},
      {"souple_haptic_get_telemetry", "size", bad_size,
       [&] { return souple_haptic_get_telemetry(channel, &unsized); }},
  });
  EXPECT_EQ(souple_histogram_quantile(nullptr, 0.5), 0);
  EXPECT_EQ(souple_histogram_quantile(&telemetry.tick_time_s, nan), 0);
}

TEST_F(CRefusals, ABodyThatIsNotShownSaysSo) {
  auto options = initialised(souple_load_options_init);
  options.visual = 0;
  souple_asset* opened = nullptr;
  ASSERT_EQ(souple_asset_open_file(asset_file().c_str(), &options, &opened), SOUPLE_OK);
  const AssetHandle plain(opened);
  const auto body = add_c_soft(world, plain.get(), 1);
  EXPECT_EQ(souple_world_visual_positions(world, body, nullptr, 0, &needed), SOUPLE_ASSET_MISSING_PART);
  EXPECT_EQ(souple_world_visual_positions_f32(world, body, nullptr, 0, &needed),
            SOUPLE_ASSET_MISSING_PART);
}

// Numbers of any bits: often a NaN, an infinity, a huge or a tiny one, sometimes one that is fine.
class RandomNumbers {
 public:
  void fill(std::int32_t& value) {
    value = pick(3) ? std::int32_t(pick(8)) - 2 : std::int32_t(random_());
  }
  void fill(std::uint32_t& value) { value = pick(2) ? ~0u : std::uint32_t(random_()); }
  void fill(double& value) {
    constexpr double some[] = {0, 1, -1, 0.01, 1e-300, 1e300, nan, infinity, -infinity, 0.4};
    value = pick(4) ? some[pick(10)] : std::bit_cast<double>(random_());
  }
  void fill(souple_vec3& v) { fill(v.x), fill(v.y), fill(v.z); }
  void fill(souple_pose& pose) {
    if (pick(2)) return;
    for (double& q : pose.rotation_wxyz) fill(q);
    fill(pose.translation_m);
  }
  /// Spoils about one field in twelve.
  template <class... Fields>
  void spoil(Fields&... fields) {
    ((pick(12) == 0 ? fill(fields) : void()), ...);
  }

 private:
  std::uint64_t pick(std::uint64_t count) { return random_() % count; }
  std::mt19937_64 random_{7};
};

TEST_F(CRefusals, NumbersOfAnyBitsAreRefusedOrSimulated) {
  RandomNumbers random;
  int refused = 0, made = 0;
  for (int k = 0; k < 2000; ++k) {
    auto s = initialised(souple_world_settings_init);
    random.spoil(s.integrator, s.time_step_s, s.gravity_m_s2, s.friction, s.alarm_distance_m,
                 s.contact_method, s.rotation_method, s.feed_forward_forces, s.contact_passes,
                 s.penalty_stiffness_n_m, s.sleep_after_s, s.sleep_speed_sides_s, s.contact_tolerance,
                 s.contact_max_sweeps, s.solver, s.free_motion_tolerance, s.free_motion_max_iterations,
                 s.unconverged, s.measure_laws, s.contact_penetration_m);
    souple_world* tried = nullptr;
    souple_world_create(&s, &tried);
    const WorldHandle own(tried ? WorldHandle(tried) : make_c_world());
    auto d = initialised(souple_rigid_body_description_init);
    d.radius_m = 0.1, d.half_length_m = 0.1, d.half_extents_m = {0.1, 0.1, 0.1};
    d.shape = k % 4, d.motion = k % 3;
    random.spoil(d.shape, d.motion);
    random.spoil(d.radius_m, d.half_extents_m, d.half_length_m, d.pose, d.mass_kg, d.density_kg_m3,
                 d.velocity_m_s, d.angular_velocity_rad_s, d.collision_groups, d.collision_mask);
    souple_body body = SOUPLE_NO_BODY;
    if (souple_world_add_rigid_body(own.get(), &d, &body) != SOUPLE_OK) {
      EXPECT_EQ(body, SOUPLE_NO_BODY);
      ++refused;
      continue;
    }
    ++made;
    auto j = initialised(souple_joint_description_init);
    random.spoil(j.kind, j.body_a, j.body_b, j.point_m, j.axis, j.arm_m, j.reach_m, j.collide);
    souple_joint joint = 0;
    souple_world_add_joint(own.get(), &j, &joint);
    souple_world_step(own.get(), nullptr);
    souple_pose pose{};
    ASSERT_EQ(souple_world_rigid_pose(own.get(), body, &pose), SOUPLE_OK);
    EXPECT_TRUE(std::isfinite(pose.translation_m.x + pose.rotation_wxyz[0]));
  }
  EXPECT_GT(refused, 100);
  EXPECT_GT(made, 100);
}

// The functions of souple.h that give a status, all of which this file or test_c_versions.cpp refuses.
TEST(CRefusalTable, EveryFunctionThatCanRefuseIsRefusedHere) {
  const auto text_of = [](const char* file) {
    std::ifstream stream(file);
    return std::string(std::istreambuf_iterator<char>(stream), {});
  };
  const std::string header = text_of(SOUPLE_C_HEADER), here = text_of(__FILE__);
  ASSERT_FALSE(header.empty() || here.empty());
  const std::regex declaration("SOUPLE_API souple_status\\s+(souple_\\w+)\\((?!void|size_t)");
  std::size_t count = 0;
  for (std::sregex_iterator at(header.begin(), header.end(), declaration), end; at != end; ++at) {
    const std::string name = (*at)[1];
    ++count;
    EXPECT_TRUE(name == "souple_check_abi" || here.find('"' + name + '"') != std::string::npos) << name;
  }
  EXPECT_GE(count, 50u);
}

}  // namespace
}  // namespace souple
