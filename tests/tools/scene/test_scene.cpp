// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/scene/scene.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace souple {
namespace {

const std::string world = "[world]\ntime_step_s = 0.01\n";

IssueCode code_of(const std::string& text) {
  const auto scene = parse_scene(text, "s.toml");
  return scene ? IssueCode{} : scene.issue().code;
}

TEST(Scene, ReadsEveryKey) {
  const auto scene = parse_scene(R"(
[world]
time_step_s = 0.002
gravity = [0, -9.81, 0]
friction = 0.7
contact_method = "exact"
alarm_distance_m = 0.01
contact_tolerance = 1e-7
contact_max_sweeps = 50
contact_penetration_m = 2e-5
contact_passes = 3
solver_tolerance = 1e-6
solver = "warped_pcg"
solver_unconverged = "refuse"
solver_max_iterations = 200
feed_forward_forces = false
[[body]]
kind = "soft"
name = "liver"
asset = "liver.souple"
position = [0, 0, 1]
rotation = { axis = [0, 0, 2], angle_deg = 90 }
velocity = [1, 0, 0]
angular_velocity = [0, 1, 0]
fixed = "foot"
[[body]]
kind = "rigid"
shape = "box"
size_m = [2, 4, 6]
[[body]]
kind = "rigid"
name = "ball"
shape = "sphere"
radius_m = 0.3
keyframes = [
  { time_s = 0, position = [0, 0, 0] },
  { time_s = 2, position = [0, 0, 1], rotation = { quaternion = [0, 0, 0, 2] } },
]
[output]
frames_every = 5
vtu = true
content = "surface"
combined = true
plane_size_m = 2
)",
                                 "s.toml");
  ASSERT_TRUE(scene.ok()) << format_issue(scene.issue());
  EXPECT_EQ(scene->world.contact_method, ContactMethod::exact);
  EXPECT_EQ(scene->world.friction, 0.7);
  EXPECT_EQ(scene->world.contact_solver.max_sweeps, 50);
  EXPECT_EQ(scene->world.contact_solver.penetration_m, 2e-5);
  EXPECT_EQ(scene->world.contact_passes, 3);
  EXPECT_EQ(scene->world.free_motion.tolerance, 1e-6);
  EXPECT_EQ(scene->world.free_motion.solver, SolverKind::warped_pcg);
  EXPECT_EQ(scene->world.free_motion.unconverged, UnconvergedStep::refuse);
  EXPECT_FALSE(scene->world.feed_forward_forces);
  const auto& liver = std::get<SceneSoftBody>(scene->bodies[0]);
  EXPECT_EQ(liver.description.fixed_set, "foot");
  EXPECT_NEAR(liver.description.pose.rotation[0], std::sqrt(0.5), 1e-15);
  EXPECT_NEAR(liver.description.pose.rotation[3], std::sqrt(0.5), 1e-15);
  const auto& box = std::get<SceneRigidBody>(scene->bodies[1]).description;
  EXPECT_EQ(box.name, "body2");
  EXPECT_EQ(box.shape.half_extents_m, (Point{1, 2, 3}));
  ASSERT_EQ(box.path.size(), 1u);
  const auto& ball = std::get<SceneRigidBody>(scene->bodies[2]).description;
  ASSERT_EQ(ball.path.size(), 2u);
  EXPECT_EQ(ball.path[1].pose.rotation, (std::array<double, 4>{0, 0, 0, 1}));
  EXPECT_EQ(scene->output.frames_every, 5);
  EXPECT_EQ(scene->output.content, FrameContent::surface);
}

const std::string soft = world + "[[body]]\nkind = \"soft\"\nasset = \"a.souple\"\n";

TEST(Scene, ReadsIntegratorsDrivenNodesAndLoads) {
  const auto scene = parse_scene(R"(
[world]
time_step_s = 0.01
integrator = "bdf2"
rotation_method = "qr"
[[body]]
kind = "soft"
asset = "bar.souple"
fixed = "ends"
driven = [{ set = "tip", keyframes = [{ time_s = 0 }, { time_s = 1, position = [0, 0, 1] }] }]
[[body.load]]
kind = "force"
set = "tip"
vector = [1, 2, 3]
follows = true
[[body.load]]
name = "poke"
kind = "force"
point = [0, 0, 0.1]
keyframes = [{ time_s = 0.5, vector = [0, 0, 0] }, { time_s = 1, vector = [0, 0, -1] }]
[[body.load]]
kind = "pressure"
pressure_pa = 50
[[body.load]]
kind = "traction"
box = { min = [0, 0, 0], max = [1, 1, 1] }
vector = [0, 0, 9]
)",
                                 "s.toml");
  ASSERT_TRUE(scene.ok()) << format_issue(scene.issue());
  EXPECT_EQ(scene->world.integrator, Integrator::bdf2);
  EXPECT_EQ(scene->world.rotation_method, RotationMethod::qr);
  const auto& bar = std::get<SceneSoftBody>(scene->bodies[0]);
  ASSERT_EQ(bar.description.driven.size(), 1u);
  EXPECT_EQ(bar.description.driven[0].name, "tip");
  EXPECT_EQ(bar.description.driven[0].path[1].pose.translation, (Point{0, 0, 1}));
  ASSERT_EQ(bar.loads.size(), 4u);
  EXPECT_EQ(bar.loads[0].load.kind, LoadKind::node_force);
  EXPECT_TRUE(bar.loads[0].load.follows);
  EXPECT_EQ(bar.loads[1].load.kind, LoadKind::point_force);
  EXPECT_EQ(bar.loads[1].load.name, "poke");
  EXPECT_EQ(bar.loads[1].load.course[1].vector, (Point{0, 0, -1}));
  EXPECT_TRUE(bar.loads[2].load.follows) << "a pressure is normal to what it presses on";
  EXPECT_EQ(bar.loads[2].load.course[0].pressure_pa, 50);
  EXPECT_EQ(bar.loads[3].place.box->max, (Point{1, 1, 1}));
}

TEST(Scene, RefusesLoadsAndDrivenNodesThatContradictThemselves) {
  EXPECT_EQ(code_of(soft), IssueCode{});
  const auto load = [](const std::string& text) { return code_of(soft + "[[body.load]]\n" + text); };
  EXPECT_EQ(load("kind = \"pressure\"\npressure_pa = 1"), IssueCode{});
  EXPECT_EQ(load("kind = \"pressure\""), IssueCode::config_missing_key);
  EXPECT_EQ(load("pressure_pa = 1"), IssueCode::config_missing_key);
  EXPECT_EQ(load("kind = \"pressure\"\npressure_pa = nan"), IssueCode::config_bad_value);
  EXPECT_EQ(load("kind = \"pressure\"\nvector = [0, 0, 1]\npressure_pa = 1"),
            IssueCode::config_unknown_key);
  EXPECT_EQ(load("kind = \"force\"\nvector = [0, 0, 1]"), IssueCode::config_missing_key);
  EXPECT_EQ(load("kind = \"force\"\nvector = [0, 0, 1e300]\nset = \"a\""), IssueCode::config_bad_value);
  EXPECT_EQ(load("kind = \"force\"\nvector = [0, 0, 1]\nset = \"a\"\npoint = [0, 0, 0]"),
            IssueCode::usage_conflict);
  EXPECT_EQ(load("kind = \"traction\"\nvector = [0, 0, 1]\npoint = [0, 0, 0]"),
            IssueCode::usage_conflict);
  EXPECT_EQ(load("kind = \"pressure\"\nkeyframes = [{time_s = 1, pressure_pa = 1}, "
                 "{time_s = 1, pressure_pa = 1}]"),
            IssueCode::config_bad_value);
  EXPECT_EQ(load("kind = \"pressure\"\npressure_pa = 1\nkeyframes = [{time_s = 1, pressure_pa = 1}]"),
            IssueCode::usage_conflict);
  EXPECT_EQ(code_of(soft + "driven = [{ keyframes = [{ time_s = 0 }] }]"),
            IssueCode::config_missing_key);
  EXPECT_EQ(code_of(soft + "driven = [{ set = \"a\", speed = 1 }]"), IssueCode::config_unknown_key);
  const std::string plane = "[[body]]\nkind = \"rigid\"\nshape = \"plane\"\n";
  EXPECT_EQ(code_of(world + "integrator = \"leapfrog\"\n" + plane), IssueCode::config_bad_value);
  EXPECT_EQ(code_of(world + "integrator = \"explicit_euler\"\n" + plane), IssueCode{});
  EXPECT_EQ(code_of(world + "integrator = \"explicit_euler\"\ncontact_method = \"warped\"\n" + plane),
            IssueCode::usage_conflict);
}

TEST(Scene, PairsNameTwoBodiesOfTheScene) {
  const std::string two =
      soft + "name = \"a\"\n[[body]]\nkind = \"rigid\"\nshape = \"plane\"\nname = \"b\"\n";
  const auto scene = parse_scene(two + "[[pair]]\na = \"b\"\nb = \"a\"\nfriction = 0.7\n" +
                                     "[[pair]]\na = \"a\"\nb = \"b\"\ncollides = false\n",
                                 "s.toml");
  ASSERT_TRUE(scene.ok()) << format_issue(scene.issue());
  ASSERT_EQ(scene->pairs.size(), 2u);
  EXPECT_EQ(scene->pairs[0].a, "b");
  EXPECT_EQ(scene->pairs[0].rule.friction, 0.7);
  EXPECT_TRUE(scene->pairs[0].rule.collides);
  EXPECT_FALSE(scene->pairs[1].rule.collides);
  EXPECT_EQ(scene->pairs[1].rule.friction, scene->world.friction);
  const auto code = [&](const std::string& pair) { return code_of(two + "[[pair]]\n" + pair); };
  EXPECT_EQ(code("a = \"a\""), IssueCode::config_missing_key);
  EXPECT_EQ(code("a = \"a\"\nb = \"c\""), IssueCode::config_bad_value);
  EXPECT_EQ(code("a = \"a\"\nb = \"a\""), IssueCode::config_bad_value);
  EXPECT_EQ(code("a = \"a\"\nb = \"b\"\nfriction = -1"), IssueCode::config_bad_value);
  EXPECT_EQ(code("a = \"a\"\nb = \"b\"\ncolides = true"), IssueCode::config_unknown_key);
}

TEST(Scene, RefusesWhatIsMissing) {
  EXPECT_EQ(code_of(""), IssueCode::config_missing_key);
  EXPECT_EQ(code_of(world), IssueCode::config_missing_key);
  EXPECT_EQ(code_of("[world]\n[[body]]\nkind=\"rigid\"\nshape=\"plane\""),
            IssueCode::config_missing_key);
  EXPECT_EQ(code_of(world + "[[body]]\nasset = \"a.souple\""), IssueCode::config_missing_key);
  EXPECT_EQ(code_of(world + "[[body]]\nkind = \"soft\""), IssueCode::config_missing_key);
  EXPECT_EQ(code_of(world + "[[body]]\nkind = \"rigid\""), IssueCode::config_missing_key);
  EXPECT_EQ(code_of(world + "[[body]]\nkind = \"rigid\"\nshape = \"sphere\""),
            IssueCode::config_missing_key);
  EXPECT_EQ(code_of(world + "[[body]]\nkind = \"rigid\"\nshape = \"plane\"\n"
                            "rotation = { axis = [0, 0, 1] }"),
            IssueCode::config_missing_key);
}

TEST(Scene, RefusesUnknownKeysAndKeysOfTheOtherKindOfBody) {
  const std::string plane = "[[body]]\nkind = \"rigid\"\nshape = \"plane\"\n";
  EXPECT_EQ(code_of(world + plane), IssueCode{});
  EXPECT_EQ(code_of(world + "gravty = [0,0,0]\n" + plane), IssueCode::config_unknown_key);
  EXPECT_EQ(code_of(world + plane + "asset = \"a.souple\""), IssueCode::config_unknown_key);
  EXPECT_EQ(code_of(world + plane + "radius_m = 1"), IssueCode::config_unknown_key);
  EXPECT_EQ(code_of(world + "[[body]]\nkind = \"soft\"\nasset = \"a\"\nshape = \"box\""),
            IssueCode::config_unknown_key);
  EXPECT_EQ(code_of(world + plane + "[output]\nformat = \"vtu\""), IssueCode::config_unknown_key);
}

TEST(Scene, RefusesNumbersThatNoWorldCouldUse) {
  const std::string plane = "[[body]]\nkind = \"rigid\"\nshape = \"plane\"\n";
  for (const char* line :
       {"time_step_s = 0", "time_step_s = -0.01", "time_step_s = nan", "time_step_s = 1e9"})
    EXPECT_EQ(code_of("[world]\n" + std::string(line) + "\n" + plane), IssueCode::config_bad_value)
        << line;
  for (const char* line :
       {"friction = -0.1", "friction = inf", "gravity = [0, 0]", "gravity = [0, 0, nan]",
        "contact_max_sweeps = 0", "contact_penetration_m = -1e-5", "contact_passes = 0",
        "contact_passes = 21", "contact_method = \"magic\"", "solver = \"magic\"",
        "solver_unconverged = \"hope\"", "solver_tolerance = 0"})
    EXPECT_EQ(code_of(world + line + "\n" + plane), IssueCode::config_bad_value) << line;
  for (const char* line :
       {"position = [0, 0, 1e300]", "rotation = { axis = [0, 0, 0], angle_deg = 90 }",
        "rotation = { quaternion = [0, 0, 0, 0] }", "name = \"a/b\"", "name = \"scene\""})
    EXPECT_EQ(code_of(world + plane + line), IssueCode::config_bad_value) << line;
}

TEST(Scene, RefusesKeyframesOutOfOrderOrBesideAPose) {
  const std::string ball = world + "[[body]]\nkind = \"rigid\"\nshape = \"sphere\"\nradius_m = 1\n";
  EXPECT_EQ(code_of(ball + "keyframes = [{time_s = 1}, {time_s = 1}]"), IssueCode::config_bad_value);
  EXPECT_EQ(code_of(ball + "keyframes = [{time_s = 1}, {time_s = 0}]"), IssueCode::config_bad_value);
  EXPECT_EQ(code_of(ball + "position = [0,0,0]\nkeyframes = [{time_s = 0}]"),
            IssueCode::usage_conflict);
  EXPECT_EQ(code_of(ball + "keyframes = [{position = [0,0,0]}]"), IssueCode::config_missing_key);
  EXPECT_EQ(code_of(ball + "keyframes = [{time_s = 0, speed = 3}]"), IssueCode::config_unknown_key);
}

TEST(Scene, RefusesTwoBodiesOfOneName) {
  const std::string plane = "[[body]]\nkind = \"rigid\"\nshape = \"plane\"\nname = \"floor\"\n";
  EXPECT_EQ(code_of(world + plane + plane), IssueCode::config_bad_value);
}

TEST(Scene, NamesTheLineOfAnUnknownKey) {
  const auto scene = parse_scene("[world]\ntime_step_s = 0.01\nfriktion = 0.4\n", "s.toml");
  ASSERT_FALSE(scene.ok());
  EXPECT_EQ(scene.issue().where, "s.toml:3: [world] friktion");
  EXPECT_NE(scene.issue().mend.find("\"friction\""), std::string::npos);
}

}  // namespace
}  // namespace souple
