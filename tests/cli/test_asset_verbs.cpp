// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>
#include <hdf5.h>

#include "tests/cli/run_souple.hpp"
#include "tests/cli/schema_check.hpp"

namespace souple::test {
namespace {
namespace fs = std::filesystem;

class AssetVerbs : public SoupleCommand {};

TEST_F(AssetVerbs, InspectReportsAsItsSchemaSaysFromTheHeadersAlone) {
  const fs::path asset = baked_liver();
  const auto result = run_souple({"inspect", asset.string(), "--json"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const auto json = result.json();
  EXPECT_EQ(schema_violation(json, load_schema("inspect")), "");
  EXPECT_EQ(json["levels"].size(), 2u);
  EXPECT_EQ(json["fixed_sets"].size(), 2u);
  ASSERT_EQ(json["compliances"].size(), 2u);
  EXPECT_EQ(json["compliances"][1]["fixed_set"], "low");
  EXPECT_EQ(json["provenance"]["input_name"], "liver-smooth.obj");
  EXPECT_LT(json["bytes_read"].get<double>(), 0.1 * static_cast<double>(fs::file_size(asset)));
}

TEST_F(AssetVerbs, InspectTellsPeopleWhatIsInside) {
  const auto result = run_souple({"inspect", baked_liver().string(), "-v"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  for (const char* part : {"level 1: ", "fixed set low: ", "compliance held: dynamic", "E 1e+04 Pa",
                           "compliance/free", "[[compliance]]"})
    EXPECT_NE(result.out.find(part), std::string::npos) << part << "\n" << result.out;
}

TEST_F(AssetVerbs, ValidateAcceptsWhatBakeWrote) {
  const auto result = run_souple({"validate", baked_liver().string(), "--json"});
  EXPECT_EQ(result.exit_code, 0) << result.out;
  EXPECT_EQ(schema_violation(result.json(), load_schema("validate")), "");
  EXPECT_EQ(result.json()["valid"], true);
}

TEST_F(AssetVerbs, ValidateRefusesATruncatedAsset) {
  const std::string bytes = read_file(baked_liver());
  for (const std::size_t length :
       {std::size_t{0}, std::size_t{7}, bytes.size() / 2, bytes.size() - 1}) {
    const auto file = write("cut.souple", bytes.substr(0, length));
    const auto result = run_souple({"validate", file.string(), "--json"});
    EXPECT_EQ(result.exit_code, 3) << length;
    EXPECT_EQ(result.json()["valid"], false);
    EXPECT_EQ(schema_violation(result.json(), load_schema("validate")), "");
  }
}

TEST_F(AssetVerbs, MissingFilesAndFoldersAreInputErrors) {
  for (const char* verb : {"inspect", "validate"}) {
    EXPECT_EQ(run_souple({verb, path("none.souple").string()}).exit_code, 2) << verb;
    EXPECT_EQ(run_souple({verb, folder_.string()}).exit_code, 2) << verb;
  }
  const auto text = write("x.souple", "this is not HDF5");
  expect_issue(run_souple({"inspect", text.string()}), 3, "S3200");
}

/// The file as a newer program might have written it.
void set_major_version(const fs::path& file, std::int64_t version) {
  const hid_t opened = H5Fopen(file.c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
  ASSERT_GE(opened, 0);
  const hid_t attribute = H5Aopen(opened, "version_major", H5P_DEFAULT);
  ASSERT_GE(attribute, 0);
  EXPECT_GE(H5Awrite(attribute, H5T_NATIVE_INT64, &version), 0);
  H5Aclose(attribute);
  H5Fclose(opened);
}

TEST_F(AssetVerbs, ANewerMajorVersionIsUnsupported) {
  fs::copy_file(baked_liver(), path("new.souple"));
  set_major_version(path("new.souple"), 2);
  expect_issue(run_souple({"inspect", path("new.souple").string(), "--json"}), 5, "S5000");
  const auto validated = run_souple({"validate", path("new.souple").string(), "--json"});
  EXPECT_EQ(validated.exit_code, 5);
  EXPECT_EQ(validated.json()["issues"][0]["code"], "S5000");
  const auto scene = write(
      "s.toml", "[world]\ntime_step_s = 0.01\n[[body]]\nkind = \"soft\"\nasset = \"new.souple\"\n");
  expect_issue(run_souple({"simulate", scene.string(), "--steps", "1", "-o", path("out").string()}), 5,
               "S5000");
}

TEST_F(AssetVerbs, ValidateHasACapOnIssues) {
  expect_issue(run_souple({"validate", "a", "--max-issues", "0"}), 1, "S1002");
  expect_issue(run_souple({"validate", "a", "--max-issues", "-3"}), 1, "S1002");
}

}  // namespace
}  // namespace souple::test
