// SPDX-License-Identifier: GPL-3.0-or-later
// A bake that is stopped by a signal while it computes compliances, and the next one.
#include <gtest/gtest.h>

#include <csignal>
#include <fstream>

#include "tests/cli/run_souple.hpp"
#include "tests/cli/schema_check.hpp"

namespace souple::test {
namespace {
namespace fs = std::filesystem;

class Resume : public SoupleCommand {
 protected:
  void SetUp() override {
    fs::copy_file(surface("anchor.off"), path("anchor.off"));
    recipe_ = write("r.toml", recipe_text("0.01"));
  }
  static constexpr const char* meshed =
      "[surface]\nfile = \"anchor.off\"\nsize_m = 0.2\n[mesh]\ntets = 8000\nlevels = 1\n";
  static constexpr const char* slow = "[[compliance]]\nname = \"slow\"\ntolerance = 0\n";
  /// A small compliance, then a slow one.
  static std::string recipe_text(const std::string& time_step) {
    return std::string(meshed) +
           "[[compliance]]\nname = \"quick\"\ntolerance = 0\ntime_step_s = " + time_step +
           "\nnodes = { nearest = { point = [0, 9, 0], count = 40 } }\n" + slow;
  }
  RunResult bake(const std::string& output, std::vector<std::string> more = {},
                 const RunOptions& options = {}) const {
    std::vector<std::string> words{"bake", "--recipe", recipe_.string(),
                                   "-v",   "-o",       path(output).string()};
    words.insert(words.end(), more.begin(), more.end());
    return run_souple(words, options);
  }
  RunResult interrupted(const std::string& output, const std::string& stage, int signal = SIGINT,
                        std::vector<std::string> more = {}) const {
    RunOptions options;
    options.signal_when = "stage compliance " + stage;
    options.signal = signal;
    return bake(output, std::move(more), options);
  }
  static bool resumed(const RunResult& result) {
    return result.err.find("were taken from") != std::string::npos;
  }
  fs::path recipe_;
};

TEST_F(Resume, GoesOnFromTheFinishedStagesToTheSameBytes) {
  ASSERT_EQ(bake("whole.souple").exit_code, 0);
  const auto stopped = interrupted("a.souple", "slow", SIGINT, {"--json"});
  EXPECT_EQ(stopped.signal, SIGINT) << stopped.err;
  EXPECT_NE(stopped.err.find("error S4104"), std::string::npos) << stopped.err;
  EXPECT_NE(stopped.err.find("a.souple.partial"), std::string::npos) << stopped.err;
  EXPECT_EQ(schema_violation(stopped.json(), load_schema("issue")), "") << stopped.out;
  ASSERT_TRUE(fs::exists(path("a.souple.partial")));
  EXPECT_FALSE(fs::exists(path("a.souple")));
  EXPECT_EQ(run_souple({"validate", path("a.souple.partial").string()}).exit_code, 0);
  const auto seen = run_souple({"inspect", path("a.souple.partial").string(), "--json"}).json();
  ASSERT_EQ(seen["compliances"].size(), 1u);
  EXPECT_EQ(seen["compliances"][0]["name"], "quick");

  const auto again = bake("a.souple", {"--json"});
  ASSERT_EQ(again.exit_code, 0) << again.err;
  EXPECT_TRUE(resumed(again)) << again.err;
  EXPECT_EQ(again.err.find("stage tetrahedralize"), std::string::npos) << again.err;
  EXPECT_EQ(again.err.find("stage compliance quick"), std::string::npos) << again.err;
  EXPECT_EQ(schema_violation(again.json(), load_schema("bake")), "");
  EXPECT_EQ(read_file(path("a.souple")), read_file(path("whole.souple")));
  EXPECT_FALSE(fs::exists(path("a.souple.partial")));
}

TEST_F(Resume, ATerminationKeepsTheMeshAsWell) {
  recipe_ = write("r.toml", std::string(meshed) + slow);
  const auto stopped = interrupted("a.souple", "slow", SIGTERM);
  ASSERT_EQ(stopped.signal, SIGTERM) << stopped.err;
  ASSERT_TRUE(fs::exists(path("a.souple.partial"))) << stopped.err;
  EXPECT_TRUE(resumed(bake("a.souple")));
}

TEST_F(Resume, NeverMixesARecipeWithTheStagesOfAnother) {
  ASSERT_EQ(interrupted("a.souple", "slow").signal, SIGINT);
  recipe_ = write("r.toml", recipe_text("0.02"));
  ASSERT_EQ(bake("whole.souple").exit_code, 0);
  const auto other = bake("a.souple");
  ASSERT_EQ(other.exit_code, 0) << other.err;
  EXPECT_FALSE(resumed(other)) << other.err;
  EXPECT_EQ(read_file(path("a.souple")), read_file(path("whole.souple")));
}

TEST_F(Resume, NeverMixesASurfaceWithTheStagesOfAnother) {
  ASSERT_EQ(interrupted("a.souple", "slow").signal, SIGINT);
  std::ofstream(path("anchor.off"), std::ios::app) << "# another byte\n";
  const auto other = bake("a.souple");
  ASSERT_EQ(other.exit_code, 0) << other.err;
  EXPECT_FALSE(resumed(other)) << other.err;
}

TEST_F(Resume, NoResumeStartsAnew) {
  ASSERT_EQ(interrupted("a.souple", "slow").signal, SIGINT);
  const auto anew = bake("a.souple", {"--no-resume"});
  ASSERT_EQ(anew.exit_code, 0) << anew.err;
  EXPECT_FALSE(resumed(anew)) << anew.err;
  EXPECT_FALSE(fs::exists(path("a.souple.partial")));
}

TEST_F(Resume, DamagedStagesAreMadeAgain) {
  ASSERT_EQ(interrupted("a.souple", "slow").signal, SIGINT);
  const std::string bytes = read_file(path("a.souple.partial"));
  for (const std::size_t length : {std::size_t{0}, bytes.size() / 2}) {
    write("a.souple.partial", bytes.substr(0, length));
    const auto again = bake("a.souple");
    ASSERT_EQ(again.exit_code, 0) << again.err;
    EXPECT_FALSE(resumed(again)) << length;
    EXPECT_FALSE(fs::exists(path("a.souple.partial")));
  }
  std::string damaged = bytes;
  damaged[damaged.size() / 2] ^= 1;
  write("a.souple.partial", damaged);
  ASSERT_EQ(bake("a.souple").exit_code, 0);
  EXPECT_EQ(run_souple({"validate", "--deep", path("a.souple").string()}).exit_code, 0);
}

TEST_F(Resume, AnInterruptedPrecomputeLeavesNothing) {
  ASSERT_EQ(bake("a.souple").exit_code, 0);
  const auto before = names();
  RunOptions options;
  options.signal_when = "stage compliance slow";
  const auto stopped = run_souple({"precompute", path("a.souple").string(), "--recipe",
                                   recipe_.string(), "-v", "-o", path("b.souple").string()},
                                  options);
  EXPECT_EQ(stopped.signal, SIGINT) << stopped.err;
  EXPECT_NE(stopped.err.find("error S4104"), std::string::npos) << stopped.err;
  EXPECT_EQ(names(), before);
}

}  // namespace
}  // namespace souple::test
