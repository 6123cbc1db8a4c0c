// SPDX-License-Identifier: MIT
// What programs that are already compiled rely on: sizes, numbers, versions.
#include <gtest/gtest.h>

#include <cstring>
#include <map>
#include <string>
#include <thread>

#include "c_program.h"
#include "c_scene.hpp"
#include "formats/core/issue.hpp"

namespace souple {
namespace {

using namespace test;

// As ABI version 1 has them. Structs with a struct_size may grow; their first sizes stay in
// runtime/c_api/internal/buffers.hpp.
const std::map<std::string, std::size_t> recorded_sizes{
    {"souple_vec3", 24},
    {"souple_triangle", 12},
    {"souple_pose", 56},
    {"souple_keyframe", 64},
    {"souple_load_options", 64},
    {"souple_asset_facts", 112},
    {"souple_compliance_facts", 40},
    {"souple_world_settings", 144},
    {"souple_driven_set", 24},
    {"souple_soft_body_description", 152},
    {"souple_rigid_body_description", 216},
    {"souple_load_keyframe", 40},
    {"souple_load_description", 96},
    {"souple_joint_description", 96},
    {"souple_pick_hit", 64},
    {"souple_step_report", 240},
    {"souple_contact", 88},
    {"souple_contact_event", 40},
    {"souple_jaw_description", 264},
    {"souple_tool_description", 104},
    {"souple_haptic_settings", 160},
    {"souple_device_sample", 72},
    {"souple_wrench", 56},
    {"souple_histogram", 400},
    {"souple_haptic_telemetry", 1800},
};

TEST(CVersions, StructsHaveTheRecordedSizesInC) {
  std::map<std::string, std::size_t> sizes;
  for (const c_struct_size* size = c_struct_sizes(); size->name; ++size) sizes[size->name] = size->size;
  EXPECT_EQ(sizes, recorded_sizes);
}

TEST(CVersions, TheLibraryServesItsOwnHeaderAndOlderOnesOnly) {
  EXPECT_EQ(SOUPLE_CHECK_ABI(), SOUPLE_OK);
  EXPECT_EQ(souple_abi_version(), SOUPLE_ABI_VERSION);
  EXPECT_EQ(souple_check_abi(SOUPLE_ABI_VERSION, 0, 0), SOUPLE_OK);
  EXPECT_EQ(souple_check_abi(SOUPLE_ABI_VERSION, SOUPLE_VERSION_MAJOR, SOUPLE_VERSION_MINOR + 1),
            SOUPLE_API_VERSION_MISMATCH);
  EXPECT_EQ(souple_check_abi(SOUPLE_ABI_VERSION + 1, SOUPLE_VERSION_MAJOR, SOUPLE_VERSION_MINOR),
            SOUPLE_API_VERSION_MISMATCH);
  EXPECT_EQ(souple_check_abi(SOUPLE_ABI_VERSION, -1, 0), SOUPLE_API_VERSION_MISMATCH);
  int32_t major = -1, minor = -1, patch = -1;
  souple_version(&major, &minor, &patch);
  souple_version(nullptr, nullptr, nullptr);
  EXPECT_EQ(souple_version_string(),
            std::to_string(major) + "." + std::to_string(minor) + "." + std::to_string(patch));
}

TEST(CVersions, EveryIssueOfTheCatalogueHasItsTexts) {
  ASSERT_EQ(souple_issue_count(), issue_catalogue().size());
  for (std::size_t k = 0; k < souple_issue_count(); ++k) {
    const IssueEntry& entry = issue_catalogue()[k];
    const souple_status code = souple_issue_at(k);
    EXPECT_EQ(code, int(entry.code));
    EXPECT_EQ(souple_issue_text(code), entry.title);
    EXPECT_EQ(souple_issue_name(code), entry.name);
    EXPECT_EQ(souple_issue_explanation(code), entry.explanation);
    EXPECT_EQ(souple_issue_mend(code), entry.mend);
  }
  EXPECT_EQ(souple_issue_at(souple_issue_count()), SOUPLE_OK);
  EXPECT_EQ(souple_issue_text(-1), nullptr);
  EXPECT_EQ(souple_issue_text(1), nullptr);
  EXPECT_STREQ(souple_issue_text(SOUPLE_OK), "ok");
}

TEST(CVersions, TheLastErrorBelongsToItsThread) {
  EXPECT_EQ(souple_world_step(nullptr, nullptr), SOUPLE_API_ARGUMENT_MISSING);
  std::thread([] {
    EXPECT_EQ(souple_last_error_code(), SOUPLE_OK);
    EXPECT_STREQ(souple_last_error_what(), "");
    souple_asset* asset = nullptr;
    EXPECT_EQ(souple_asset_open_file("/no/such/file", nullptr, &asset), SOUPLE_IO_FILE_MISSING);
    EXPECT_EQ(souple_last_error_code(), SOUPLE_IO_FILE_MISSING);
  }).join();
  EXPECT_EQ(souple_last_error_code(), SOUPLE_API_ARGUMENT_MISSING);
  EXPECT_NE(std::strstr(souple_last_error_what(), "world"), nullptr);
  EXPECT_STRNE(souple_last_error_mend(), "");
  EXPECT_EQ(SOUPLE_CHECK_ABI(), SOUPLE_OK);
  EXPECT_EQ(souple_last_error_code(), SOUPLE_API_ARGUMENT_MISSING);  // success leaves it
}

TEST(CVersions, ALongErrorIsCutBetweenCharacters) {
  const AssetHandle asset = open_asset();
  std::string name;
  for (int k = 0; k < 1000; ++k) name += "ä";
  std::size_t count = 0;
  EXPECT_EQ(souple_asset_fixed_set_nodes(asset.get(), name.c_str(), nullptr, 0, &count),
            SOUPLE_FIXED_SET_INVALID);
  const std::string what = souple_last_error_what();
  EXPECT_GT(what.size(), 900u);
  EXPECT_EQ(what.substr(what.size() - 2), "ä");
}

// A struct of a program that is newer than the library: twice as long.
struct Longer {
  souple_world_settings known;
  unsigned char rest[sizeof(souple_world_settings)];
};

TEST(CVersions, ALongerStructIsTakenIfItsRestSaysNothing) {
  Longer longer;
  std::memset(&longer, 0xFF, sizeof longer);
  ASSERT_EQ(souple_world_settings_init(&longer.known, sizeof longer), SOUPLE_OK);
  EXPECT_EQ(longer.known.struct_size, sizeof longer);
  souple_world* world = nullptr;
  ASSERT_EQ(souple_world_create(&longer.known, &world), SOUPLE_OK);
  souple_world_destroy(world);
  longer.rest[sizeof longer.rest - 1] = 1;
  world = nullptr;
  EXPECT_EQ(souple_world_create(&longer.known, &world), SOUPLE_API_STRUCT_SIZE_INVALID);
  EXPECT_EQ(world, nullptr);
}

TEST(CVersions, AStructWithoutItsSizeIsRefused) {
  souple_world_settings settings;
  std::memset(&settings, 0, sizeof settings);
  souple_world* world = nullptr;
  for (const std::uint32_t size : {0u, 8u, 135u, 65537u, UINT32_MAX}) {
    settings.struct_size = size;
    EXPECT_EQ(souple_world_create(&settings, &world), SOUPLE_API_STRUCT_SIZE_INVALID) << size;
    EXPECT_EQ(souple_world_settings_init(&settings, size), SOUPLE_API_STRUCT_SIZE_INVALID) << size;
  }
  const WorldHandle stepped = make_c_world();
  souple_step_report report{};
  EXPECT_EQ(souple_world_step(stepped.get(), &report), SOUPLE_API_STRUCT_SIZE_INVALID);
  EXPECT_EQ(souple_world_time_s(stepped.get()), 0);  // and no step was made
}

}  // namespace
}  // namespace souple
