// SPDX-License-Identifier: MIT
// What the C interface refuses of descriptions, assets and meshes.

#include "c_refusals.hpp"

namespace souple {
namespace {

using namespace test;

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

}  // namespace
}  // namespace souple
