// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <cmath>
#include <csignal>

#include "formats/fclib/read_fclib.hpp"
#include "tests/cli/run_souple.hpp"
#include "tests/cli/schema_check.hpp"

namespace souple::test {
namespace {
namespace fs = std::filesystem;

class Simulate : public SoupleCommand {
 protected:
  /// A liver just above a ball on a plane.
  std::string drop_scene(const std::string& world = "time_step_s = 0.01\n",
                         const std::string& soft = "",
                         const std::string& output = "frames_every = 10\n") const {
    return "[world]\n" + world + "[[body]]\nkind = \"soft\"\nname = \"liver\"\nasset = \"" +
           baked_liver().string() + "\"\nposition = [0, 0, 0.16]\n" + soft +
           "[[body]]\nkind = \"rigid\"\nname = \"floor\"\nshape = \"plane\"\n"
           "[[body]]\nkind = \"rigid\"\nname = \"ball\"\nshape = \"sphere\"\nradius_m = 0.05\n"
           "position = [-0.03, 0.08, 0.05]\n[output]\n" +
           output;
  }
  RunResult simulate(const std::string& scene, std::vector<std::string> more = {},
                     const RunOptions& options = {}) const {
    std::vector<std::string> words{"simulate", write("s.toml", scene).string(), "-o",
                                   path("out").string()};
    words.insert(words.end(), more.begin(), more.end());
    return run_souple(words, options);
  }
};

TEST_F(Simulate, WritesFramesAndAReportAsItsSchemaSays) {
  const auto result = simulate(drop_scene(), {"--steps", "40", "--json"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const auto json = result.json();
  EXPECT_EQ(schema_violation(json, load_schema("simulate")), "");
  EXPECT_EQ(nlohmann::json::parse(read_file(path("out/report.json"))), json);
  EXPECT_EQ(json["steps_done"], 40);
  EXPECT_EQ(json["frame_count"], 5);
  EXPECT_GT(json["contacts"]["largest_count"].get<int>(), 0);
  EXPECT_LT(json["laws"]["cone_violation"]["value"].get<double>(), 1e-6);
  for (const char* body : {"liver", "floor", "ball"})
    EXPECT_TRUE(fs::exists(path(std::string("out/frames/") + body + "_000004.vtu"))) << body;
  const std::string collection = read_file(path("out/scene.pvd"));
  EXPECT_NE(collection.find("frames/liver_000004.vtu"), std::string::npos);
  EXPECT_EQ(collection.find("000005"), std::string::npos);
}

TEST_F(Simulate, AProbeThatAHandHoldsIsInTheReport) {
  const std::string probe =
      "[[probe]]\nname = \"stylus\"\nbody = \"ball\"\ndevice = \"hand\"\ngrip = 0.8\n"
      "passivity = \"each_freedom\"\nkeyframes = [{ time_s = 0, position = [-0.03, 0.08, 0.05] }]\n";
  const std::string scene = drop_scene() + probe;
  const auto result = simulate(scene, {"--steps", "30", "--json"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const auto json = result.json();
  EXPECT_EQ(schema_violation(json, load_schema("simulate")), "");
  ASSERT_EQ(json["probes"].size(), 1u);
  EXPECT_EQ(json["probes"][0]["telemetry"]["ticks"], 301);
  EXPECT_EQ(json["probes"][0]["telemetry"]["publications"], 30);
  EXPECT_EQ(json["state_hash"], simulate(scene, {"--steps", "30", "--json"}).json()["state_hash"]);
  EXPECT_NE(simulate(scene, {"--steps", "2"}).out.find("probe stylus: 21 ticks"), std::string::npos);
  expect_issue(simulate(scene + "grib = 1\n", {"--steps", "1"}), 1, "S1011");
}

TEST_F(Simulate, LoadsOnlyTheComplianceTheSceneNeeds) {
  const auto json = simulate(drop_scene(), {"--steps", "1", "--json"}).json();
  ASSERT_TRUE(json.is_object());
  EXPECT_EQ(json["assets"][0]["compliances"], nlohmann::json({"free"}));
  EXPECT_LT(json["assets"][0]["bytes_read"].get<double>(),
            0.8 * json["assets"][0]["file_bytes"].get<double>());
  const auto held =
      simulate(drop_scene("time_step_s = 0.01\n", "fixed = \"low\"\n"), {"--steps", "1", "--json"});
  EXPECT_EQ(held.json()["assets"][0]["compliances"], nlohmann::json({"held"})) << held.err;
  const auto exact = simulate(drop_scene("time_step_s = 0.004\ncontact_method = \"exact\"\n"),
                              {"--steps", "1", "--json"});
  EXPECT_EQ(exact.json()["assets"][0]["compliances"], nlohmann::json::array()) << exact.err;
}

TEST_F(Simulate, SameSceneEndsInTheSameState) {
  const auto first = simulate(drop_scene(), {"--steps", "30", "--json"}).json();
  const auto second = simulate(drop_scene("time_step_s = 0.01\n", "", "frames_every = 1\n"),
                               {"--steps", "30", "--json"})
                          .json();
  ASSERT_TRUE(first.is_object() && second.is_object());
  EXPECT_EQ(first["state_hash"], second["state_hash"]);
}

TEST_F(Simulate, SameSceneEndsInTheSameStateOnAnyNumberOfThreads) {
  const std::string second_liver = "[[body]]\nkind = \"soft\"\nname = \"other\"\nasset = \"" +
                                   baked_liver().string() + "\"\nposition = [0, 0.3, 0.16]\n";
  const std::string scene = drop_scene("time_step_s = 0.01\n", second_liver);
  const auto one = simulate(scene, {"--steps", "20", "--json"}).json();
  const auto three = simulate(scene, {"--steps", "20", "--json", "--threads", "3"}).json();
  ASSERT_TRUE(one.is_object() && three.is_object());
  EXPECT_EQ(one["state_hash"], three["state_hash"]);
  for (const char* threads : {"0", "-1", "1e9", "x"})
    expect_issue(simulate(scene, {"--steps", "1", "--threads", threads}), 1, "S1002");
}

TEST_F(Simulate, Bdf2UsesTheComplianceOfItsOwnStepAndNoOther) {
  const auto fits =
      simulate(drop_scene("time_step_s = 0.015\nintegrator = \"bdf2\"\n"), {"--steps", "30", "--json"});
  ASSERT_EQ(fits.exit_code, 0) << fits.err;
  EXPECT_EQ(fits.json()["settings"]["integrator"], "bdf2");
  EXPECT_EQ(fits.json()["assets"][0]["compliances"], nlohmann::json({"free"}));
  const auto other =
      simulate(drop_scene("time_step_s = 0.01\nintegrator = \"bdf2\"\n"), {"--steps", "5"});
  expect_issue(other, 3, "S3400");
  EXPECT_NE(other.err.find("BDF2"), std::string::npos) << other.err;
}

TEST_F(Simulate, LoadsAndDrivenNodesOfASceneActOnTheBody) {
  const std::string exact = "time_step_s = 0.01\ngravity = [0, 0, 0]\ncontact_method = \"exact\"\n";
  const auto pushed = simulate(
      drop_scene(exact, "[[body.load]]\nkind = \"force\"\npoint = [0, 0, 1]\nvector = [2, 0, 0]\n"),
      {"--steps", "10", "--json"});
  ASSERT_EQ(pushed.exit_code, 0) << pushed.err;
  // The mass of Rayleigh damping takes a share of 0.1 per second.
  EXPECT_NEAR(pushed.json()["last_step"]["linear_momentum_kg_m_s"][0].get<double>(), 0.2, 0.002);
  const auto driven =
      simulate(drop_scene(exact,
                          "fixed = \"low\"\ndriven = [{ set = \"low\", keyframes = [{ time_s = 0, "
                          "position = [0, 0, 0.16] }, { time_s = 1, position = [0, 0, 1.16] }] }]\n"),
               {"--steps", "100", "--json"});
  ASSERT_EQ(driven.exit_code, 0) << driven.err;
  EXPECT_GT(driven.json()["last_step"]["linear_momentum_kg_m_s"][2].get<double>(),
            0.5 * driven.json()["contacts"]["soft_mass_kg"].get<double>());
  expect_issue(simulate(drop_scene(exact, "driven = [{ set = \"low\", position = [0, 0, 1] }]\n"),
                        {"--steps", "1"}),
               3, "S3407");
  expect_issue(simulate(drop_scene(exact,
                                   "[[body.load]]\nkind = \"force\"\nset = \"nowhere\"\n"
                                   "vector = [0, 0, 1]\n"),
                        {"--steps", "1"}),
               3, "S3406");
  expect_issue(simulate(drop_scene("time_step_s = 0.01\nintegrator = \"quasi_static\"\n"
                                   "contact_method = \"exact\"\n"),
                        {"--steps", "1"}),
               3, "S3408");
  expect_issue(
      simulate(drop_scene("time_step_s = 0.01\nintegrator = \"explicit_euler\"\n"), {"--steps", "1"}),
      3, "S3409");
}

TEST_F(Simulate, ASecondRunLeavesNoFramesOfTheFirst) {
  ASSERT_EQ(simulate(drop_scene(), {"--steps", "30"}).exit_code, 0);
  std::error_code error;
  fs::create_directories(path("out/frames"), error);
  write("out/frames/notes.txt", "mine");
  ASSERT_EQ(simulate(drop_scene(), {"--steps", "10"}).exit_code, 0);
  EXPECT_TRUE(fs::exists(path("out/frames/liver_000001.vtu")));
  EXPECT_FALSE(fs::exists(path("out/frames/liver_000002.vtu")));
  EXPECT_TRUE(fs::exists(path("out/frames/notes.txt")));
}

TEST_F(Simulate, CombinedFramesHoldAllBodies) {
  ASSERT_EQ(simulate(drop_scene("time_step_s = 0.01\n", "", "combined = true\ncontent = \"surface\"\n"),
                     {"--steps", "2"})
                .exit_code,
            0);
  EXPECT_GT(fs::file_size(path("out/frames/scene_000002.vtu")),
            fs::file_size(path("out/frames/liver_000002.vtu")));
}

TEST_F(Simulate, ShowsAndReportsFreeRigidBodiesWhereTheyAre) {
  write("c.off", "OFF\n4 4 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n");
  const std::string stone =
      "[[body]]\nkind = \"rigid\"\nname = \"stone\"\nshape = \"mesh\"\nfile = \"c.off\"\n"
      "size_m = 0.05\nfree = true\nposition = [1, 0, 1]\n";
  const auto json =
      simulate(stone + "[world]\ntime_step_s = 0.01\n", {"--steps", "10", "--json"}).json();
  ASSERT_TRUE(json.is_object());
  EXPECT_EQ(schema_violation(json, load_schema("simulate")), "");
  const auto& body = json["bodies"][0];
  EXPECT_EQ(body["free"], true);
  // Implicit Euler falls by g h^2 n (n + 1) / 2.
  EXPECT_NEAR(body["position_m"][2].get<double>(), 1 - 9.81 * 1e-4 * 55, 1e-9);
  EXPECT_NEAR(body["velocity_m_s"][2].get<double>(), -0.981, 1e-9);
  EXPECT_TRUE(fs::exists(path("out/frames/stone_000010.vtu")));
  expect_issue(simulate("[world]\ntime_step_s = 0.01\n[[body]]\nkind = \"rigid\"\nshape = \"mesh\"\n"
                        "file = \"none.off\"\n",
                        {"--steps", "1"}),
               2, "S2001");
}

TEST_F(Simulate, DumpsAContactProblemThatSolveContactSolvesToTheSameMotion) {
  const std::string file = path("contacts.hdf5").string();
  const auto run = simulate(drop_scene(), {"--steps", "40", "--json", "--dump-contact", "40=" + file});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const auto solved = run_souple({"solve-contact", file, "--json", "-o", path("solved.hdf5").string()});
  ASSERT_EQ(solved.exit_code, 0) << solved.err;
  EXPECT_EQ(solved.json()["contacts"], run.json()["last_step"]["contact_count"]);
  const auto ours = read_fclib(file);
  const auto theirs = read_fclib(path("solved.hdf5"));
  ASSERT_TRUE(ours.ok() && theirs.ok());
  double difference = 0, size = 0;
  for (std::size_t k = 0; k < ours->problem.q.size(); ++k) {
    difference = std::max(difference, std::abs(ours->solution->u[k] - theirs->solution->u[k]));
    size = std::max(size, std::abs(ours->problem.q[k]));
  }
  EXPECT_LT(difference, 1e-6 * size);
}

TEST_F(Simulate, RefusesDumpsOfStepsWithoutAContactProblem) {
  const std::string file = path("c.hdf5").string();
  expect_issue(simulate(drop_scene(), {"--steps", "2", "--dump-contact", file}), 1, "S1002");
  expect_issue(simulate(drop_scene(), {"--steps", "2", "--dump-contact", "3=" + file}), 1, "S1002");
  expect_issue(simulate(drop_scene(), {"--steps", "2", "--dump-contact", "1=" + file}), 3, "S3307");
  EXPECT_FALSE(fs::exists(file));
}

TEST_F(Simulate, ADumpThatCannotBeWrittenIsAnErrorOfTheFile) {
  const std::string file = path("no_such_folder/c.hdf5").string();
  expect_issue(simulate(drop_scene(), {"--steps", "40", "--dump-contact", "40=" + file}), 2, "S2003");
  EXPECT_FALSE(fs::exists(path("no_such_folder")));
}

TEST_F(Simulate, RefusesATimeStepOrFixedSetWithoutACompliance) {
  const auto step = simulate(drop_scene("time_step_s = 0.02\n"), {"--steps", "5", "--json"});
  expect_issue(step, 3, "S3400");
  EXPECT_NE(step.err.find("\"free\" (time step 0.01 s"), std::string::npos) << step.err;
  const auto set =
      simulate(drop_scene("time_step_s = 0.01\n", "fixed = \"unused\"\n"), {"--steps", "5"});
  expect_issue(set, 3, "S3400");
  const auto none = simulate(drop_scene("time_step_s = 0.01\n", "fixed = \"lwo\"\n"), {"--steps", "5"});
  expect_issue(none, 3, "S3302");
  EXPECT_NE(none.err.find("low"), std::string::npos) << none.err;
  EXPECT_FALSE(fs::exists(path("out")));
}

TEST_F(Simulate, RefusesScenesItCannotUnderstand) {
  expect_issue(simulate("", {"--steps", "5"}), 1, "S1013");
  expect_issue(simulate("[world]\ntime_step_s = nan\n", {"--steps", "5"}), 1, "S1012");
  const auto syntax = simulate("[world]\ntime_step_s = 0.01\n[[body\n", {"--steps", "5"});
  expect_issue(syntax, 1, "S1010");
  EXPECT_NE(syntax.err.find("s.toml:3:"), std::string::npos) << syntax.err;
  expect_issue(simulate(drop_scene("time_step_s = 0.01\nfrction = 1\n"), {"--steps", "5"}), 1, "S1011");
  expect_issue(
      simulate("[world]\ntime_step_s = 0.01\n[[body]]\nkind = \"soft\"\nasset = \"none.souple\"\n",
               {"--steps", "5"}),
      2, "S2001");
  EXPECT_FALSE(fs::exists(path("out")));
}

TEST_F(Simulate, RefusesStepCountsOutsideTheirRange) {
  for (const char* steps : {"0", "-1", "1000001", "99999999999999999999", "nan", "1e3", ""})
    expect_issue(simulate(drop_scene(), {"--steps", steps}), 1, "S1002");
}

TEST_F(Simulate, RefusesAnOutputFolderThatIsAFileOrCannotBeMade) {
  write("out", "a file");
  expect_issue(simulate(drop_scene(), {"--steps", "5"}), 2, "S2003");
  EXPECT_EQ(read_file(path("out")), "a file");
  const auto scene = write("s.toml", drop_scene());
  expect_issue(run_souple({"simulate", scene.string(), "--steps", "5", "-o", "/proc/out"}), 2, "S2003");
}

TEST_F(Simulate, AFullDiskKeepsWholeFramesOnly) {
  RunOptions options;
  options.file_size_limit = 20000;
  const auto result = simulate(drop_scene(), {"--steps", "20"}, options);
  expect_issue(result, 2, "S2003");
  for (const auto& entry : fs::recursive_directory_iterator(path("out"))) {
    const std::string name = entry.path().filename().string();
    EXPECT_FALSE(name.starts_with(".")) << name;
    if (name.ends_with(".vtu")) {
      EXPECT_TRUE(read_file(entry.path()).ends_with("</VTKFile>\n")) << name;
    }
  }
}

TEST_F(Simulate, AnInterruptEndsWithAWholeReport) {
  RunOptions options;
  options.signal_after_s = 2;
  const auto result = simulate(drop_scene("time_step_s = 0.01\n", "", "frames_every = 100\n"),
                               {"--steps", "1000000"}, options);
  EXPECT_EQ(result.signal, SIGINT);
  const auto report = nlohmann::json::parse(read_file(path("out/report.json")), nullptr, false);
  EXPECT_EQ(schema_violation(report, load_schema("simulate")), "");
  EXPECT_EQ(report["outcome"], "interrupted");
}

}  // namespace
}  // namespace souple::test
