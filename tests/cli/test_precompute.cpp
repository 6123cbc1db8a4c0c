// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include "tests/cli/run_souple.hpp"
#include "tests/cli/schema_check.hpp"

namespace souple::test {
namespace {
namespace fs = std::filesystem;

/// Two levels of the anchor, 0.2 m, without compliances.
class Precompute : public SoupleCommand {
 protected:
  void SetUp() override {
    ASSERT_EQ(run_souple({"tetrahedralize", surface("anchor.off").string(), "--tets", "100", "--size-m",
                          "0.2", "-o", path("anchor.msh").string()})
                  .exit_code,
              0);
    ASSERT_EQ(run_souple({"hierarchy", path("anchor.msh").string(), "--levels", "2", "-o",
                          path("h.souple").string()})
                  .exit_code,
              0);
    names_before_ = names();
  }
  RunResult precompute(const std::string& recipe, std::vector<std::string> more = {}) const {
    std::vector<std::string> words{"precompute", path("h.souple").string(), "-o",
                                   path("a.souple").string()};
    if (!recipe.empty()) {
      words.push_back("--recipe");
      words.push_back(write("r.toml", recipe).string());
    }
    words.insert(words.end(), more.begin(), more.end());
    return run_souple(words);
  }
  static nlohmann::json inspect(const fs::path& asset) {
    return run_souple({"inspect", asset.string(), "--json"}).json();
  }
  static std::string entry(const std::string& keys) { return "[[compliance]]\ntolerance = 0\n" + keys; }

  std::vector<std::string> names_before_;
};

const std::string foot =
    "[[fixed]]\nname = \"foot\"\nbox = { min = [-9, -9, -9], max = [9, -0.05, 9] }\n";

TEST_F(Precompute, ReportsAsItsSchemaSaysAndTheAssetIsValid) {
  const auto result = precompute("", {"--tolerance", "0", "--json"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const auto json = result.json();
  EXPECT_EQ(schema_violation(json, load_schema("precompute")), "");
  EXPECT_EQ(json["input"], path("h.souple").string());
  EXPECT_EQ(json["compliances"].size(), 1u);
  EXPECT_EQ(run_souple({"validate", path("a.souple").string()}).exit_code, 0);
}

TEST_F(Precompute, KeepsTheMeshAndWhereItCameFrom) {
  ASSERT_EQ(precompute("[surface]\nfile = \"other.obj\"\n[mesh]\ntets = 99999\n" + entry("")).exit_code,
            0);
  const auto before = inspect(path("h.souple")), after = inspect(path("a.souple"));
  EXPECT_EQ(before["levels"], after["levels"]);
  EXPECT_EQ(before["provenance"]["input_hash"], after["provenance"]["input_hash"]);
  EXPECT_EQ(before["provenance"]["input_name"], after["provenance"]["input_name"]);
  const std::string recipe = after["provenance"]["recipe"];
  EXPECT_EQ(recipe.find("99999"), std::string::npos) << recipe;
  EXPECT_EQ(recipe.find("other.obj"), std::string::npos) << recipe;
}

TEST_F(Precompute, TheMaterialOfTheRecipeReplacesKeyByKey) {
  ASSERT_EQ(precompute("[material]\nyoung_pa = 5e3\n" + entry(""), {"--poisson", "0.3"}).exit_code, 0);
  const auto region = inspect(path("a.souple"))["material"]["regions"][0];
  EXPECT_EQ(region["young_pa"], 5e3);
  EXPECT_EQ(region["poisson"], 0.3);
  EXPECT_EQ(region["density_kg_m3"], 1000);
}

TEST_F(Precompute, FixedSetsJoinThoseOfTheAssetAndOldCompliancesGo) {
  ASSERT_EQ(precompute(foot + entry("fixed = \"foot\"\n")).exit_code, 0);
  fs::rename(path("a.souple"), path("h.souple"));
  const std::string more =
      "[[fixed]]\nname = \"tip\"\nnearest = { point = [0, 9, 0], count = 5 }\n[[compliance]]\nname = "
      "\"both\"\nkind = \"static\"\nfixed = \"foot\"\ntolerance = 0\n";
  const auto result = precompute(more);
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const auto seen = inspect(path("a.souple"));
  EXPECT_EQ(seen["fixed_sets"].size(), 2u);
  ASSERT_EQ(seen["compliances"].size(), 1u);
  EXPECT_EQ(seen["compliances"][0]["name"], "both");
  const std::string recipe = seen["provenance"]["recipe"];
  for (const char* part : {"\"foot\"", "\"tip\"", "\"both\""})
    EXPECT_NE(recipe.find(part), std::string::npos) << recipe;
}

TEST_F(Precompute, ARegionHoldsFewerNodesThanTheSurface) {
  ASSERT_EQ(
      precompute(entry("name = \"all\"\n") +
                 entry("name = \"some\"\nnodes = { nearest = { point = [0, 9, 0], count = 20 } }\n"))
          .exit_code,
      0);
  const auto seen = inspect(path("a.souple"))["compliances"];
  ASSERT_EQ(seen.size(), 2u);
  EXPECT_LE(seen[1]["node_count"], 20);
  EXPECT_GT(seen[0]["node_count"], 60);
}

TEST_F(Precompute, TheCoarseComplianceIsSmallerAndSaysHowFarOffItIs) {
  ASSERT_EQ(
      precompute(entry("name = \"coarse\"\ncoarsening = 1\n") + entry("name = \"fine\"\n")).exit_code,
      0);
  const auto seen = inspect(path("a.souple"))["compliances"];
  EXPECT_LT(seen[0]["node_count"], seen[1]["node_count"]);
  EXPECT_GT(seen[0]["error"]["frobenius"], 1e-3);
}

TEST_F(Precompute, TheBytesDoNotDependOnTheThreads) {
  ASSERT_EQ(precompute(entry(""), {"--threads", "1"}).exit_code, 0);
  const std::string one = read_file(path("a.souple"));
  ASSERT_EQ(precompute(entry(""), {"--threads", "3"}).exit_code, 0);
  EXPECT_EQ(one, read_file(path("a.souple")));
}

TEST_F(Precompute, RefusesWhatCannotBeComputed) {
  const auto refuse = [&](const std::string& recipe, int exit_code, const std::string& code,
                          std::vector<std::string> more = {}) {
    const auto result = precompute(recipe, std::move(more));
    expect_issue(result, exit_code, code);
    return result.err;
  };
  refuse(entry("kind = \"static\"\n"), 3, "S3301");
  refuse(entry("fixed = \"nobody\"\n"), 1, "S1012");
  refuse("[[fixed]]\nname = \"none\"\nsphere = { centre = [9, 9, 9], radius_m = 1 }\n" + entry(""), 3,
         "S3302");
  refuse("[[fixed]]\nname = \"all\"\nsphere = { centre = [0, 0, 0], radius_m = 99 }\n" + entry(""), 3,
         "S3302");
  refuse("[[fixed]]\nname = \"line\"\nnearest = { point = [0, 9, 0], count = 2 }\n" +
             entry("kind = \"static\"\nfixed = \"line\"\n"),
         3, "S3301");
  EXPECT_NE(refuse(entry("nodes = { sphere = { centre = [9, 9, 9], radius_m = 1 } }\n"), 3, "S3304")
                .find("spans"),
            std::string::npos);
  refuse(entry("time_step_s = 0\n"), 1, "S1012");
  refuse(entry("time_step_s = -0.01\n"), 1, "S1012");
  refuse("[[compliance]]\ntolerance = 0.6\n", 1, "S1012");
  refuse("", 1, "S1002", {"--tolerance", "0.6"});
  refuse("", 1, "S1002", {"--tolerance", "-1"});
  refuse("", 1, "S1002", {"--time-step-s", "0"});
  refuse("", 1, "S1002", {"--memory-mb", "0"});
  refuse("", 1, "S1002", {"--threads", "0"});
  refuse(entry("name = \"a\"\n") + entry("name = \"b\"\n"), 1, "S1022");
  refuse("[[material.region]]\nname = \"r\"\nsurface = \"x.off\"\n" + entry(""), 1, "S1023");
  std::vector<std::string> expected = names_before_;
  expected.emplace_back("r.toml");
  EXPECT_EQ(names(), expected) << "no output of a refused run";
}

TEST_F(Precompute, RefusesCoarseningOfOneLevelAndFilesThatAreNoAsset) {
  ASSERT_EQ(run_souple({"hierarchy", path("anchor.msh").string(), "--levels", "1", "-o",
                        path("h.souple").string()})
                .exit_code,
            0);
  expect_issue(precompute(entry("coarsening = 1\n")), 1, "S1021");
  write("h.souple", "not an asset");
  expect_issue(precompute(""), 3, "S3200");
  fs::remove(path("h.souple"));
  expect_issue(precompute(""), 2, "S2001");
}

TEST_F(Precompute, TooLittleMemoryForTheDenseWayOffersAnother) {
  const auto result = run_souple({"bake", surface("anchor.off").string(), "--size-m", "0.2", "--tets",
                                  "6000", "--levels", "1", "--tolerance", "0", "--memory-mb", "16",
                                  "-o", path("a.souple").string()});
  expect_issue(result, 4, "S4102");
  EXPECT_NE(result.err.find("by-solves"), std::string::npos) << result.err;
  EXPECT_FALSE(fs::exists(path("a.souple")));
}

}  // namespace
}  // namespace souple::test
