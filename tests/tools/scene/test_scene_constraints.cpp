// SPDX-License-Identifier: GPL-3.0-or-later
// Free bodies, meshes, pairs, joints and grabs of a scene: as text, and in the world.
#include <gtest/gtest.h>

#include <cmath>

#include "tools/exchange/shape_mesh.hpp"
#include "tools/scene/frame_writer.hpp"
#include "tools/scene/scene.hpp"
#include "tools/scene/scene_world.hpp"

namespace souple {
namespace {

const std::string world = "[world]\ntime_step_s = 0.01\n";
const std::string two = world + R"(
[[body]]
kind = "rigid"
name = "a"
shape = "box"
size_m = [0.2, 0.2, 0.2]
free = true
mass_kg = 2
[[body]]
kind = "rigid"
name = "b"
shape = "plane"
position = [0, 0, -5]
)";

IssueCode code_of(const std::string& text) {
  const auto scene = parse_scene(text, "s.toml");
  return scene ? IssueCode{} : scene.issue().code;
}

Scene scene_of(const std::string& text) {
  auto scene = parse_scene(text, "s.toml");
  EXPECT_TRUE(scene.ok()) << (scene ? "" : format_issue(scene.issue()));
  return scene ? std::move(*scene) : Scene{};
}

TEST(SceneConstraints, ReadsContactMethodsByTheirNames) {
  const std::string plane = "[[body]]\nkind = \"rigid\"\nshape = \"plane\"\n";
  for (const auto method : {ContactMethod::warped, ContactMethod::exact, ContactMethod::penalty}) {
    const std::string line = "contact_method = \"" + std::string(contact_method_name(method)) + "\"\n";
    EXPECT_EQ(scene_of(world + line + plane).world.contact_method, method) << line;
  }
  EXPECT_EQ(scene_of(world + "contact_method = \"penalty\"\npenalty_stiffness_n_m = 50\n" + plane)
                .world.penalty_stiffness_n_m,
            50);
  EXPECT_EQ(code_of(world + "penalty_stiffness_n_m = 50\n" + plane), IssueCode::config_unknown_key)
      << "it would mean nothing";
  const WorldSettings sleepy =
      scene_of(world + "sleep_after_s = 0.5\nsleep_speed = 0.01\n" + plane).world;
  EXPECT_EQ(sleepy.sleep_after_s, 0.5);
  EXPECT_EQ(sleepy.sleep_speed, 0.01);
}

TEST(SceneConstraints, ReadsFreeBodiesTheirShapesAndFilters) {
  const Scene scene = scene_of(world + R"(
[[body]]
kind = "rigid"
shape = "capsule"
radius_m = 0.1
half_length_m = 0.3
free = true
density = 500
velocity = [1, 2, 3]
angular_velocity = [4, 5, 6]
groups = 0x6
mask = 1
[[body]]
kind = "rigid"
shape = "mesh"
file = "stone.off"
scale = 0.01
[[body]]
kind = "soft"
asset = "a.souple"
self_contact = true
)");
  const auto& capsule = std::get<SceneRigidBody>(scene.bodies.at(0)).description;
  EXPECT_EQ(capsule.shape.kind, RigidShapeKind::capsule);
  EXPECT_EQ(capsule.shape.half_length_m, 0.3);
  ASSERT_TRUE(capsule.free.has_value());
  EXPECT_EQ(capsule.free->density_kg_m3, 500);
  EXPECT_EQ(capsule.free->velocity_m_s, (Point{1, 2, 3}));
  EXPECT_EQ(capsule.free->angular_velocity_rad_s, (Point{4, 5, 6}));
  EXPECT_EQ(capsule.filter.groups, 6u);
  EXPECT_EQ(capsule.filter.mask, 1u);
  const auto& stone = std::get<SceneRigidBody>(scene.bodies.at(1));
  EXPECT_EQ(stone.description.shape.kind, RigidShapeKind::mesh);
  EXPECT_EQ(stone.mesh->file, "stone.off");
  EXPECT_EQ(stone.mesh->scale, 0.01);
  EXPECT_FALSE(stone.description.free.has_value());
  EXPECT_TRUE(std::get<SceneSoftBody>(scene.bodies.at(2)).description.self_contact);
}

TEST(SceneConstraints, RefusesFreeBodiesThatContradictThemselves) {
  const auto sphere = [](const std::string& more) {
    return code_of(world + "[[body]]\nkind = \"rigid\"\nshape = \"sphere\"\nradius_m = 1\n" + more);
  };
  EXPECT_EQ(sphere("free = true\n"), IssueCode{});
  EXPECT_EQ(sphere("free = true\nmass_kg = 1\ndensity = 1\n"), IssueCode::usage_conflict);
  EXPECT_EQ(sphere("free = true\nmass_kg = 0\n"), IssueCode::config_bad_value);
  EXPECT_EQ(sphere("free = true\nkeyframes = [{ time_s = 0 }]\n"), IssueCode::usage_conflict);
  EXPECT_EQ(sphere("mass_kg = 1\n"), IssueCode::config_unknown_key) << "nothing moves by it";
  EXPECT_EQ(sphere("velocity = [1, 0, 0]\n"), IssueCode::config_unknown_key);
  EXPECT_EQ(sphere("groups = -1\n"), IssueCode::config_bad_value);
  EXPECT_EQ(sphere("mask = 4294967296\n"), IssueCode::config_bad_value);
  EXPECT_EQ(sphere("self_contact = true\n"), IssueCode::config_unknown_key);
  EXPECT_EQ(code_of(world + "[[body]]\nkind = \"rigid\"\nshape = \"plane\"\nfree = true\n"),
            IssueCode::usage_conflict);
  const auto mesh = [](const std::string& more) {
    return code_of(world + "[[body]]\nkind = \"rigid\"\nshape = \"mesh\"\n" + more);
  };
  EXPECT_EQ(mesh(""), IssueCode::config_missing_key);
  EXPECT_EQ(mesh("file = \"a.off\"\nscale = 1\nsize_m = 1\n"), IssueCode::usage_conflict);
  EXPECT_EQ(mesh("file = \"a.off\"\nscale = 0\n"), IssueCode::config_bad_value);
}

TEST(SceneConstraints, ReadsJointsGrabsAndRestitution) {
  const Scene scene = scene_of(two + R"(
[[pair]]
a = "a"
b = "b"
restitution = 0.5
[[joint]]
a = "a"
b = "b"
kind = "hinge"
point = [1, 2, 3]
axis = [0, 1, 0]
arm_m = 0.05
reach_m = 0.01
collide = true
[[joint]]
name = "hook"
a = "a"
kind = "ball"
point = [0, 0, 0]
[[grab]]
body = "a"
point = [0, 0, 0.1]
radius_m = 0.02
most_nodes = 5
keyframes = [{ time_s = 0, position = [0, 0, 0.1] }, { time_s = 1, position = [0, 0, 1] }]
release_s = 2
)");
  EXPECT_EQ(scene.pairs.at(0).rule.restitution, 0.5);
  const SceneJoint& hinge = scene.joints.at(0);
  EXPECT_EQ(hinge.b, "b");
  EXPECT_EQ(hinge.description.kind, JointKind::hinge);
  EXPECT_EQ(hinge.description.axis, (Point{0, 1, 0}));
  EXPECT_EQ(hinge.description.arm_m, 0.05);
  EXPECT_EQ(hinge.description.reach_m, 0.01);
  EXPECT_TRUE(hinge.description.collide);
  EXPECT_EQ(scene.joints.at(1).description.name, "hook");
  EXPECT_TRUE(scene.joints.at(1).b.empty()) << "the world";
  const SceneGrab& grab = scene.grabs.at(0);
  EXPECT_EQ(grab.description.most_nodes, 5);
  EXPECT_EQ(grab.path.at(1).pose.translation, (Point{0, 0, 1}));
  EXPECT_EQ(grab.release_s, 2);
}

TEST(SceneConstraints, RefusesJointsAndGrabsThatCannotBe) {
  const auto joint = [](const std::string& text) { return code_of(two + "[[joint]]\n" + text); };
  const std::string ball = "kind = \"ball\"\npoint = [0, 0, 0]\n";
  EXPECT_EQ(joint("a = \"a\"\n" + ball), IssueCode{});
  EXPECT_EQ(joint(ball), IssueCode::config_missing_key);
  EXPECT_EQ(joint("a = \"c\"\n" + ball), IssueCode::config_bad_value);
  EXPECT_EQ(joint("a = \"a\"\nb = \"a\"\n" + ball), IssueCode::config_bad_value);
  EXPECT_EQ(joint("a = \"a\"\npoint = [0, 0, 0]\n"), IssueCode::config_missing_key);
  EXPECT_EQ(joint("a = \"a\"\nkind = \"ball\"\n"), IssueCode::config_missing_key);
  EXPECT_EQ(joint("a = \"a\"\n" + ball + "axis = [0, 0, 1]\n"), IssueCode::config_unknown_key);
  EXPECT_EQ(joint("a = \"a\"\nkind = \"hinge\"\npoint = [0, 0, 0]\n"), IssueCode::config_missing_key);
  const auto grab = [](const std::string& text) { return code_of(two + "[[grab]]\n" + text); };
  EXPECT_EQ(grab("body = \"a\"\npoint = [0, 0, 0]\n"), IssueCode{});
  EXPECT_EQ(grab("point = [0, 0, 0]\n"), IssueCode::config_missing_key);
  EXPECT_EQ(grab("body = \"a\"\npoint = [0, 0, 0]\nmost_nodes = 0\n"), IssueCode::config_bad_value);
  EXPECT_EQ(grab("body = \"a\"\npoint = [0, 0, 0]\nrelease_s = -1\n"), IssueCode::config_bad_value);
  EXPECT_EQ(grab("body = \"a\"\npoint = [0, 0, 0]\nkeyframes = [{ time_s = 0 }]\n"),
            IssueCode::config_missing_key);
}

TEST(SceneConstraints, AGrabCarriesABodyAlongItsPathAndLetsItGo) {
  const Scene scene = scene_of(two + R"(
[[grab]]
body = "a"
point = [0, 0, 0]
radius_m = 0.05
keyframes = [
  { time_s = 0, position = [0, 0, 0] },
  { time_s = 0.5, position = [0, 0, 0.3], rotation = { axis = [0, 0, 1], angle_deg = 90 } },
]
release_s = 1
)");
  auto built = build_world(scene);
  ASSERT_TRUE(built.ok()) << format_issue(built.issue());
  const auto run = [&](int steps) {
    for (int k = 0; k < steps; ++k) {
      ASSERT_TRUE(drive_grabs(scene, *built).ok());
      ASSERT_TRUE(built->world.step().ok());
    }
  };
  run(100);
  const Pose held = built->world.rigid_pose(built->bodies[0]);
  EXPECT_NEAR(held.translation[2], 0.3, 1e-3);
  EXPECT_NEAR(std::abs(held.rotation[3]), std::sqrt(0.5), 0.01) << "turned by a quarter";
  run(50);
  EXPECT_LT(built->world.rigid_pose(built->bodies[0]).translation[2], 0) << "it falls";
}

TEST(SceneConstraints, AJointToTheWorldHoldsWhatGravityPulls) {
  const Scene scene = scene_of(two + "[[joint]]\na = \"a\"\nkind = \"ball\"\npoint = [0, 0, 0.5]\n");
  auto built = build_world(scene);
  ASSERT_TRUE(built.ok()) << format_issue(built.issue());
  for (int k = 0; k < 100; ++k) ASSERT_TRUE(built->world.step().ok());
  EXPECT_NEAR(built->world.rigid_pose(built->bodies[0]).translation[2], 0, 1e-6);
}

TriangleMesh cube() {
  RigidShape box;
  box.kind = RigidShapeKind::box;
  box.half_extents_m = {0.1, 0.1, 0.1};
  return triangulate_shape(box, {}, 1);
}

TEST(SceneConstraints, MeshesAreLoadedOnceForAllBodiesThatHaveThem) {
  const std::string stone =
      "[[body]]\nkind = \"rigid\"\nshape = \"mesh\"\nfile = \"c.off\"\nfree = true\n";
  const Scene scene = scene_of(world + stone + stone + "position = [0, 0, 1]\n");
  EXPECT_EQ(build_world(scene).issue().code, IssueCode::unsupported_feature) << "no loader";
  int loads = 0;
  auto built = build_world(scene, [&](const RigidMeshFile& mesh) -> Result<TriangleMesh> {
    ++loads;
    EXPECT_EQ(mesh.file, "c.off");
    return cube();
  });
  ASSERT_TRUE(built.ok()) << format_issue(built.issue());
  EXPECT_EQ(loads, 1);
  const TriangleMesh shown = placed_surface(built->shapes.at(1), {{1, 0, 0, 0}, {0, 0, 1}}, 1);
  ASSERT_EQ(shown.vertices.size(), 8u) << "frames show it";
  EXPECT_NEAR(shown.vertices[0][2], 0.9, 1e-15);
  const auto open = build_world(scene, [](const RigidMeshFile&) -> Result<TriangleMesh> {
    TriangleMesh mesh = cube();
    mesh.triangles.pop_back();
    return mesh;
  });
  EXPECT_EQ(open.issue().code, IssueCode::rigid_mesh_invalid);
  EXPECT_EQ(open.issue().where, "c.off");
}

}  // namespace
}  // namespace souple
