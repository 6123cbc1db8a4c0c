// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/cli/run_souple.hpp"
#include "tests/cli/schema_check.hpp"

namespace souple::test {
namespace {
namespace fs = std::filesystem;

class Bake : public SoupleCommand {
 protected:
  /// A quick bake of the anchor into the test's folder.
  RunResult bake(std::vector<std::string> more, const RunOptions& options = {}) const {
    std::vector<std::string> words{
        "bake", surface("anchor.off").string(), "--tets", "500", "--size-m", "0.2", "--levels", "1"};
    words.insert(words.end(), more.begin(), more.end());
    return run_souple(words, options);
  }
};

TEST_F(Bake, ReportsAsItsSchemaSays) {
  const auto result = bake({"-o", path("a.souple").string(), "--json"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const auto json = result.json();
  EXPECT_EQ(schema_violation(json, load_schema("bake")), "");
  EXPECT_EQ(json["asset_bytes"], fs::file_size(path("a.souple")));
  EXPECT_NEAR(json["longest_side_m"].get<double>(), 0.2, 0.01);
  ASSERT_EQ(json["levels"].size(), 1u);
  const double tets = json["levels"][0]["tet_count"].get<double>();
  EXPECT_GT(tets, 250);
  EXPECT_LT(tets, 1000);
  EXPECT_LT(json["compliances"][0]["error"]["solve_residual"].get<double>(), 1e-6);
  EXPECT_EQ(names(), std::vector<std::string>{"a.souple"});
}

TEST_F(Bake, SameInputGivesTheSameBytesFromAnyFolder) {
  const fs::path copy = path("anchor.off");
  fs::copy_file(surface("anchor.off"), copy);
  fs::create_directory(path("sub"));
  RunOptions here, there;
  here.folder = folder_;
  there.folder = path("sub");
  ASSERT_EQ(run_souple({"bake", "anchor.off", "--tets", "500", "--levels", "1", "-o", "a.souple"}, here)
                .exit_code,
            0);
  ASSERT_EQ(
      run_souple({"bake", copy.string(), "--tets", "500", "--levels", "1", "-q", "-o", "b.souple"},
                 there)
          .exit_code,
      0);
  EXPECT_EQ(read_file(path("a.souple")), read_file(path("sub/b.souple")));
  EXPECT_FALSE(read_file(path("a.souple")).empty());
}

TEST_F(Bake, OptionsWinOverTheRecipeAndBothAreStored) {
  fs::copy_file(surface("anchor.off"), path("anchor.off"));
  const auto recipe =
      write("r.toml",
            "[surface]\nfile = \"anchor.off\"\nsize_m = 0.1\n[mesh]\ntets = 500\nlevels = 1\n"
            "[material]\nyoung_pa = 5e3\ndensity = 900\n[[compliance]]\nname = \"fast\"\n");
  const auto result = run_souple({"bake", "--recipe", recipe.string(), "-o", path("a.souple").string(),
                                  "--young-pa", "2e4", "--time-step-s", "0.002", "-v"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_NE(result.err.find("young_pa = 20000.0"), std::string::npos) << result.err;
  const auto seen = run_souple({"inspect", path("a.souple").string(), "--json"}).json();
  EXPECT_EQ(seen["material"]["regions"][0]["young_pa"], 2e4);
  EXPECT_EQ(seen["material"]["regions"][0]["density_kg_m3"], 900);
  EXPECT_EQ(seen["compliances"][0]["name"], "fast");
  EXPECT_EQ(seen["compliances"][0]["time_step_s"], 0.002);
  EXPECT_NE(seen["provenance"]["recipe"].get<std::string>().find("file = \"anchor.off\""),
            std::string::npos);
  EXPECT_EQ(seen["provenance"]["input_name"], "anchor.off");
}

TEST_F(Bake, ItsStoredRecipeBakesTheSameAsset) {
  fs::copy_file(surface("anchor.off"), path("anchor.off"));
  ASSERT_EQ(bake({"-o", path("a.souple").string()}).exit_code, 0);
  const auto seen = run_souple({"inspect", path("a.souple").string(), "--json"}).json();
  const auto recipe = write("again.toml", seen["provenance"]["recipe"]);
  ASSERT_EQ(
      run_souple({"bake", "--recipe", recipe.string(), "-o", path("b.souple").string()}).exit_code, 0);
  EXPECT_EQ(read_file(path("a.souple")), read_file(path("b.souple")));
}

TEST_F(Bake, SaysThatASurfaceKeepsItsSizeAndThatABodyIsAPuddle) {
  const auto result = run_souple({"bake", surface("anchor.off").string(), "--tets", "500", "--levels",
                                  "1", "--young-pa", "100", "-o", path("a.souple").string()});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_NE(result.err.find("keeps its own size"), std::string::npos) << result.err;
  EXPECT_NE(result.err.find("puddle"), std::string::npos) << result.err;
}

TEST_F(Bake, RefusesNumbersOutsideTheirRange) {
  const std::string out = path("a.souple").string();
  for (const auto& [option, value] :
       std::vector<std::pair<std::string, std::string>>{{"--young-pa", "nan"},
                                                        {"--young-pa", "-1e4"},
                                                        {"--poisson", "0.5"},
                                                        {"--poisson", "inf"},
                                                        {"--density-kg-m3", "0"},
                                                        {"--time-step-s", "0"},
                                                        {"--time-step-s", "nan"},
                                                        {"--unit", "parsec"},
                                                        {"--scalar", "float16"},
                                                        {"--rayleigh-stiffness-s", "-1"},
                                                        {"--young-pa", ""}}) {
    const auto result = bake({"-o", out, option, value, "--json"});
    expect_issue(result, 1, "S1002");
    EXPECT_NE(result.err.find(option), std::string::npos) << result.err;
  }
  expect_issue(bake({"-o", out, "--edge-length-m", "0.1"}), 1, "S1004");
  const std::string anchor = surface("anchor.off").string();
  for (const char* levels : {"0", "2.5", "7"})
    expect_issue(run_souple({"bake", anchor, "-o", out, "--levels", levels}), 1, "S1002");
  expect_issue(run_souple({"bake", anchor, "-o", out, "--edge-length-m", "-1"}), 1, "S1002");
  expect_issue(run_souple({"bake", anchor, "-o", out, "--tets", "500", "--levels", "4"}), 1, "S1020");
  expect_issue(bake({"-o", out, "--hierarchy", "flat"}), 1, "S1002");
  EXPECT_TRUE(names().empty());
}

TEST_F(Bake, RefusesBadRecipesWithTheLine) {
  const auto refuse = [&](const std::string& text, int exit_code, const std::string& code) {
    const auto recipe = write("r.toml", text);
    const auto result = bake({"--recipe", recipe.string(), "-o", path("a.souple").string()});
    expect_issue(result, exit_code, code);
    return result.err;
  };
  EXPECT_NE(refuse("[mesh]\ntets = 100\nlevles = 2\n", 1, "S1011").find("r.toml:3"), std::string::npos);
  EXPECT_NE(refuse("[mesh]\n\ntets = = 2\n", 1, "S1010").find("r.toml:3:"), std::string::npos);
  refuse("[material]\npoisson = nan\n", 1, "S1012");
  refuse(std::string(2 << 20, '#'), 2, "S2020");
  refuse("\xff\xfe", 1, "S1010");
  expect_issue(bake({"--recipe", path("none.toml").string(), "-o", path("a.souple").string()}), 2,
               "S2001");
  expect_issue(bake({"--recipe", folder_.string(), "-o", path("a.souple").string()}), 2, "S2002");
  EXPECT_EQ(names(), std::vector<std::string>{"r.toml"});
}

TEST_F(Bake, AnEmptyRecipeIsTheDefaults) {
  const auto recipe = write("r.toml", "");
  const auto result = bake({"--recipe", recipe.string(), "-o", path("a.souple").string()});
  EXPECT_EQ(result.exit_code, 0) << result.err;
}

TEST_F(Bake, RefusesSurfacesThatAreMissingOrUnreadable) {
  const std::string out = path("a.souple").string();
  expect_issue(run_souple({"bake", path("none.obj").string(), "-o", out}), 2, "S2001");
  const auto folder = run_souple({"bake", folder_.string(), "-o", out});
  EXPECT_EQ(folder.exit_code, 2) << folder.err;
  const auto garbage = write("x.obj", std::string("v 1 2\nf 1 2 9999\n\0\xff", 18));
  const auto result = run_souple({"bake", garbage.string(), "-o", out, "--json"});
  EXPECT_EQ(result.exit_code, 3) << result.err;
  EXPECT_EQ(schema_violation(result.json(), load_schema("issue")), "");
  const auto unknown = write("x.xyz", "hello");
  EXPECT_NE(run_souple({"bake", unknown.string(), "-o", out}).exit_code, 0);
  EXPECT_FALSE(fs::exists(out));
}

TEST_F(Bake, RefusesAFixedSetThatSelectsNothing) {
  const auto recipe =
      write("r.toml", "[[fixed]]\nname = \"far\"\nsphere = {centre = [9, 9, 9], radius_m = 0.1}\n");
  expect_issue(bake({"--recipe", recipe.string(), "-o", path("a.souple").string()}), 3, "S3302");
}

TEST_F(Bake, RefusesOutputsThatCannotBeWritten) {
  fs::create_directory(path("dir"));
  expect_issue(bake({"-o", path("dir").string()}), 2, "S2003");
  expect_issue(bake({"-o", path("no/such/a.souple").string()}), 2, "S2003");
  expect_issue(bake({"-o", "/proc/a.souple"}), 2, "S2003");
  EXPECT_EQ(names(), std::vector<std::string>{"dir"});
  EXPECT_TRUE(fs::is_empty(path("dir")));
}

TEST_F(Bake, AFullDiskLeavesNothingAndKeepsTheOldAsset) {
  const auto old = write("a.souple", "old");
  RunOptions options;
  options.file_size_limit = 20000;
  expect_issue(bake({"-o", old.string()}, options), 2, "S2003");
  EXPECT_EQ(names(), std::vector<std::string>{"a.souple"});
  EXPECT_EQ(read_file(old), "old");
}

TEST_F(Bake, AnInterruptLeavesNothingHalfWrittenAtAnyTime) {
  const std::vector<std::string> whole{"a.souple"}, partial{"a.souple.partial"};
  for (double after_s = 0.01; after_s < 2; after_s += after_s < 0.1 ? 0.03 : 0.015) {
    RunOptions options;
    options.signal_after_s = after_s;
    const auto result = bake({"-o", path("a.souple").string()}, options);
    // Nothing, finished stages, or the whole asset if the interrupt came while it was written; never a
    // temporary file.
    if (names() == partial) {
      ASSERT_EQ(run_souple({"validate", path("a.souple.partial").string()}).exit_code, 0) << after_s;
      fs::remove(path("a.souple.partial"));
    } else if (!names().empty()) {
      ASSERT_EQ(names(), whole) << after_s;
      ASSERT_EQ(run_souple({"validate", path("a.souple").string()}).exit_code, 0) << after_s;
    }
    fs::remove(path("a.souple"));
    if (result.signal == 0) break;  // done before the interrupt came
  }
}

TEST_F(Bake, QuietSaysNothingAndNothingIsColouredOutsideATerminal) {
  const auto quiet = bake({"-o", path("a.souple").string(), "-q"});
  EXPECT_EQ(quiet.exit_code, 0);
  EXPECT_EQ(quiet.out + quiet.err, "");
  const auto loud = bake({"-o", path("a.souple").string(), "-v"});
  EXPECT_EQ((loud.out + loud.err).find('\033'), std::string::npos);
  EXPECT_EQ((loud.out + loud.err).find('\r'), std::string::npos);
}

}  // namespace
}  // namespace souple::test
