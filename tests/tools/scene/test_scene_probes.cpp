// SPDX-License-Identifier: GPL-3.0-or-later
// Tools that a hand holds: recorded paths as files, `[[probe]]` as text, and in the world.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <random>
#include <string>

#include "runtime/haptics_net/udp_device.hpp"
#include "tools/exchange/atomic_file.hpp"
#include "tools/scene/hand_path_file.hpp"
#include "tools/scene/simulation.hpp"

namespace souple {
namespace {
namespace fs = std::filesystem;

IssueCode path_code(const std::string& text) {
  const auto path = parse_hand_path(text, "hand.csv");
  return path ? IssueCode{} : path.issue().code;
}

TEST(HandPathFile, ReadsColumnsInAnyOrderAndUnit) {
  const auto path = parse_hand_path(
      "# of a stylus\r\n"
      "x_mm, y_cm ,z_m,time_ms,opening_deg,qw,qx,qy,qz\r\n"
      "\r\n"
      "100,20,0.3,0,90,2,0,0,0\r\n"
      "200;20;0.3;1000;0;0;0;0;-5\r\n",
      "hand.csv");
  ASSERT_TRUE(path.ok()) << format_issue(path.issue());
  ASSERT_EQ(path->sample_count(), 2u);
  const DeviceSample first = path->at(0), last = path->at(1);
  EXPECT_NEAR(first.pose.translation[0], 0.1, 1e-15);
  EXPECT_NEAR(first.pose.translation[1], 0.2, 1e-15);
  EXPECT_NEAR(first.pose.translation[2], 0.3, 1e-15);
  EXPECT_NEAR(first.opening_rad, M_PI / 2, 1e-15);
  EXPECT_EQ(first.pose.rotation, (std::array<double, 4>{1, 0, 0, 0}));
  EXPECT_NEAR(last.pose.translation[0], 0.2, 1e-15);
  EXPECT_NEAR(std::abs(last.pose.rotation[3]), 1, 1e-15);
  EXPECT_EQ(path->end_s(), 1);
}

TEST(HandPathFile, BlanksAndTabsPartAsCommasDo) {
  const auto path = parse_hand_path("time_s x_m\ty_m  z_m\n0 1 2 3\n 1\t1   2 4 \n", "hand.csv");
  ASSERT_TRUE(path.ok()) << format_issue(path.issue());
  EXPECT_EQ(path->at(1).pose.translation, (Point{1, 2, 4}));
}

TEST(HandPathFile, RefusesEveryKindOfDamageWithItsLine) {
  const std::string header = "time_s,x_m,y_m,z_m\n";
  EXPECT_EQ(path_code(""), IssueCode::hand_path_malformed);
  EXPECT_EQ(path_code(header), IssueCode::hand_path_malformed);
  EXPECT_EQ(path_code("time_s,x_m,y_m\n0,0,0\n"), IssueCode::hand_path_malformed);
  EXPECT_EQ(path_code("time,x_m,y_m,z_m\n0,0,0,0\n"), IssueCode::hand_path_malformed) << "no unit";
  EXPECT_EQ(path_code("time_s,x_m,x_mm,y_m,z_m\n0,0,0,0,0\n"), IssueCode::hand_path_malformed);
  EXPECT_EQ(path_code("time_s,x_m,y_m,z_m,qw\n0,0,0,0,1\n"), IssueCode::hand_path_malformed);
  EXPECT_EQ(path_code(header + "0,0,0\n"), IssueCode::hand_path_malformed);
  EXPECT_EQ(path_code(header + "0,0,0,0,0\n"), IssueCode::hand_path_malformed);
  EXPECT_EQ(path_code(header + "0,,0,0\n"), IssueCode::hand_path_bad_value);
  EXPECT_EQ(path_code(header + "0,nan,0,0\n"), IssueCode::hand_path_bad_value);
  EXPECT_EQ(path_code(header + "0,inf,0,0\n"), IssueCode::hand_path_bad_value);
  EXPECT_EQ(path_code(header + "0,1e300,0,0\n"), IssueCode::hand_path_bad_value);
  EXPECT_EQ(path_code(header + "0,1 m,0,0\n"), IssueCode::hand_path_malformed);
  EXPECT_EQ(path_code(header + "1,0,0,0\n0.5,0,0,0\n"), IssueCode::hand_path_bad_time);
  EXPECT_EQ(path_code(header + "1,0,0,0\n1,0,0,0\n"), IssueCode::hand_path_bad_time);
  EXPECT_EQ(path_code("time_s,x_m,y_m,z_m,qw,qx,qy,qz\n0,0,0,0,0,0,0,0\n"),
            IssueCode::hand_path_bad_value);
  EXPECT_EQ(path_code(header + std::string(5000, '1') + "\n"), IssueCode::hand_path_malformed);
  const auto path = parse_hand_path(header + "0,0,0,0\n\n1,0,x,0\n", "hand.csv");
  ASSERT_FALSE(path.ok());
  EXPECT_EQ(path.issue().where, "hand.csv:4");
}

TEST(HandPathFile, RubbishNeverGetsThrough) {
  const std::string good = "time_s,x_m,y_m,z_m\n0,0.5,0,0\n1,1e-3,-2,3\n";
  std::mt19937 random(11);
  for (int k = 0; k < 3000; ++k) {
    std::string text = good;
    for (int n = 0; n < 3; ++n) text[random() % text.size()] = char(random() & 0xff);
    const auto path = parse_hand_path(text, "hand.csv");
    if (!path) continue;
    const DeviceSample sample = path->at(0.5);
    for (const double x : sample.pose.translation) ASSERT_LE(std::abs(x), 1e3);
  }
}

const std::string two_jaws = R"(
[world]
time_step_s = 0.01
[[body]]
kind = "rigid"
name = "upper"
shape = "box"
size_m = [0.06, 0.03, 0.006]
position = [0.1, 0, 0.02]
[[body]]
kind = "rigid"
name = "lower"
shape = "box"
size_m = [0.06, 0.03, 0.006]
position = [0.1, 0, -0.02]
[[body]]
kind = "rigid"
name = "floor"
shape = "plane"
position = [0, 0, -1]
)";
const std::string held = two_jaws + R"(
[[probe]]
name = "forceps"
jaw_a = "upper"
jaw_b = "lower"
hinge = [0, 0, 0]
axis = [0, -1, 0]
device = "path"
keyframes = [
  { time_s = 0, position = [0, 0, 0], opening_rad = 0.2 },
  { time_s = 0.1, position = [0, 0, 0], opening_rad = 0.4 },
  { time_s = 0.2, position = [0, 0.1, 0], opening_rad = 0.4 },
]
)";

Scene scene_of(const std::string& text) {
  auto scene = parse_scene(text, "s.toml");
  EXPECT_TRUE(scene.ok()) << (scene ? "" : format_issue(scene.issue()));
  return scene ? std::move(*scene) : Scene{};
}

IssueCode code_of(const std::string& text) {
  const auto scene = parse_scene(text, "s.toml");
  return scene ? IssueCode{} : scene.issue().code;
}

SimulationReport run(const Scene& scene, std::int64_t steps, SceneWorld* after = nullptr) {
  auto built = build_world(scene);
  EXPECT_TRUE(built.ok()) << (built ? "" : format_issue(built.issue()));
  if (!built) return {};
  const fs::path folder =
      fs::path(testing::TempDir()) / ("souple_probes_" + std::to_string(::getpid()));
  SimulationReport report = run_simulation(scene, *built, {steps, folder, {}, {}});
  fs::remove_all(folder);
  EXPECT_FALSE(report.failure) << format_issue(*report.failure);
  if (after != nullptr) *after = std::move(*built);
  return report;
}

TEST(SceneProbes, JawsStandWhereTheSceneHasThemAndOpenAboutTheHinge) {
  const Scene scene = scene_of(held);
  auto built = build_world(scene);
  ASSERT_TRUE(built.ok()) << format_issue(built.issue());
  const Pose start = built->world.rigid_pose(built->bodies[0]);
  EXPECT_NEAR(start.translation[0], 0.1, 1e-12);
  EXPECT_NEAR(start.translation[2], 0.02, 1e-12);
  EXPECT_NEAR(built->world.rigid_pose(built->bodies[1]).translation[2], -0.02, 1e-12);
  SceneWorld after = std::move(*built);
  const SimulationReport report = run(scene, 30, &after);
  ASSERT_EQ(report.probes.size(), 1u);
  EXPECT_EQ(report.probes[0].telemetry.ticks, 301u);
  EXPECT_EQ(report.probes[0].telemetry.largest_force_n, 0);
  // Each jaw has turned by 0.1 about the hinge, and the hand went 0.1 along y.
  const double c = std::cos(0.1), s = std::sin(0.1);
  const Point upper = after.world.rigid_pose(after.bodies[0]).translation;
  EXPECT_NEAR(upper[0], 0.1 * c - 0.02 * s, 1e-9);
  EXPECT_NEAR(upper[1], 0.1, 1e-9);
  EXPECT_NEAR(upper[2], 0.02 * c + 0.1 * s, 1e-9);
  EXPECT_NEAR(after.world.rigid_pose(after.bodies[1]).translation[2], -upper[2], 1e-9);
}

TEST(SceneProbes, AHandInFreeMotionFeelsNothingAndReachesItsPath) {
  const std::string text = two_jaws + R"(
[[probe]]
body = "upper"
device = "hand"
grip = 0.7
keyframes = [
  { time_s = 0, position = [0.1, 0, 0.02] },
  { time_s = 0.5, position = [0.1, 0.05, 0.02] },
]
)";
  const SimulationReport report = run(scene_of(text), 100);
  ASSERT_EQ(report.probes.size(), 1u);
  EXPECT_NEAR(report.probes[0].last_sample.pose.translation[1], 0.05, 2e-3);
  ASSERT_TRUE(report.probes[0].hand_received_j.has_value());
  EXPECT_EQ(*report.probes[0].hand_received_j, 0);
}

// A ball on a plane that does not give: the force is the coupling's alone.
TEST(SceneProbes, AHandThatPressesFeelsTheSpringOfItsCoupling) {
  const std::string text = R"(
[world]
time_step_s = 0.01
[[body]]
kind = "rigid"
name = "ball"
shape = "sphere"
radius_m = 0.02
position = [0, 0, 0.03]
[[body]]
kind = "rigid"
name = "floor"
shape = "plane"
[[probe]]
body = "ball"
device = "path"
stiffness_n_m = 1500
keyframes = [
  { time_s = 0, position = [0, 0, 0.03] },
  { time_s = 0.5, position = [0, 0, 0.016] },
]
)";
  const SimulationReport report = run(scene_of(text), 100);
  ASSERT_EQ(report.probes.size(), 1u);
  EXPECT_NEAR(report.probes[0].last_wrench.force_n[2], 1500 * 0.004, 0.01);
  EXPECT_NEAR(report.probes[0].telemetry.largest_force_n, 6, 0.02);
}

TEST(SceneProbes, TheSameSceneEndsInTheSameState) {
  const SimulationReport first = run(scene_of(held), 20), second = run(scene_of(held), 20);
  EXPECT_EQ(first.state_hash, second.state_hash);
  EXPECT_EQ(first.probes[0].last_wrench.force_n, second.probes[0].last_wrench.force_n);
}

TEST(SceneProbes, WrongKeysAndContradictionsAreErrors) {
  const std::string one = two_jaws + "[[probe]]\nbody = \"upper\"\n";
  const std::string path = "device = \"path\"\nkeyframes = [{ time_s = 0, position = [0, 0, 0] }]\n";
  EXPECT_EQ(code_of(one + path), IssueCode{});
  EXPECT_EQ(code_of(one + path + "stifness_n_m = 3\n"), IssueCode::config_unknown_key);
  EXPECT_EQ(code_of(one + path + "grip = 0.3\n"), IssueCode::config_unknown_key) << "of a hand only";
  EXPECT_EQ(code_of(one + path + "port = 5000\n"), IssueCode::config_unknown_key);
  EXPECT_EQ(code_of(one + path + "hinge = [0, 0, 0]\n"), IssueCode::config_unknown_key);
  EXPECT_EQ(code_of(one), IssueCode::config_missing_key);
  EXPECT_EQ(code_of(one + "device = \"path\"\n"), IssueCode::config_missing_key);
  EXPECT_EQ(code_of(one + "device = \"udp\"\n"), IssueCode::config_missing_key);
  EXPECT_EQ(code_of(one + "device = \"udp\"\nport = 80\n"), IssueCode::config_bad_value);
  EXPECT_EQ(code_of(one + path + "stiffness_n_m = 0\n"), IssueCode::config_bad_value);
  EXPECT_EQ(code_of(one + path + "stiffness_n_m = nan\n"), IssueCode::config_bad_value);
  EXPECT_EQ(code_of(one + path + "rate_hz = 1e9\n"), IssueCode::config_bad_value);
  EXPECT_EQ(code_of(one + path + "passivity = \"on\"\n"), IssueCode::config_bad_value);
  EXPECT_EQ(code_of(one + path + "file = \"hand.csv\"\n"), IssueCode::config_missing_key);
  EXPECT_EQ(code_of(two_jaws + "[[probe]]\nbody = \"floor\"\n" + path), IssueCode::config_bad_value);
  EXPECT_EQ(code_of(two_jaws + "[[probe]]\nbody = \"nobody\"\n" + path), IssueCode::config_bad_value);
  EXPECT_EQ(code_of(one + path + "[[probe]]\nbody = \"upper\"\n" + path), IssueCode::usage_conflict);
  EXPECT_EQ(code_of(two_jaws + "[[probe]]\njaw_a = \"upper\"\n" + path), IssueCode::config_missing_key);
}

TEST(SceneProbes, APathFileThatIsMissingOrBrokenStopsTheRunBeforeItBegins) {
  const std::string one = two_jaws + "[[probe]]\nbody = \"upper\"\ndevice = \"path\"\nfile = \"";
  const auto missing = build_world(scene_of(one + "/nowhere/hand.csv\"\n"));
  ASSERT_FALSE(missing.ok());
  EXPECT_EQ(missing.issue().code, IssueCode::io_file_missing);
  const fs::path file =
      fs::path(testing::TempDir()) / ("souple_hand_" + std::to_string(::getpid()) + ".csv");
  ASSERT_TRUE(write_file_atomically(file, "time_s,x_m,y_m,z_m\n0,0,0,0\n0,1,0,0\n"));
  const auto broken = build_world(scene_of(one + file.string() + "\"\n"));
  ASSERT_FALSE(broken.ok());
  EXPECT_EQ(broken.issue().code, IssueCode::hand_path_bad_time);
  fs::remove(file);
}

}  // namespace
}  // namespace souple
