// SPDX-License-Identifier: GPL-3.0-or-later
// `[[pair]]`, `[[joint]]` and `[[grab]]` of a scene: what holds between its bodies.
#include <algorithm>
#include <array>

#include "tools/scene/scene_parts.hpp"

namespace souple {
namespace {

constexpr std::size_t entry_limit = 100000;
constexpr NumberRange coordinate_range{-1e6, 1e6};
constexpr NumberRange length_range{0, 1e6, true};

const std::array<std::string, 3> joint_kinds{"ball", "hinge", "weld"};

std::string parse_body_name(TomlTable& entry, std::string_view key, const Scene& scene) {
  const std::string name = entry.plain_name(key).value_or("");
  const auto is_it = [&](const SceneBody& body) { return scene_body_name(body) == name; };
  if (!name.empty() && std::ranges::none_of(scene.bodies, is_it))
    entry.refuse(IssueCode::config_bad_value, "no body is called \"" + name + "\"", key);
  return name;
}

void check_two_bodies(TomlTable& entry, const std::string& a, const std::string& b) {
  if (!a.empty() && a == b)
    entry.refuse(IssueCode::config_bad_value, "both are the body \"" + a + "\"", "b");
}

ScenePair parse_pair(TomlTable& entry, const Scene& scene) {
  ScenePair pair;
  entry.require("a", "the name of a body");
  entry.require("b", "the name of a body");
  pair.a = parse_body_name(entry, "a", scene);
  pair.b = parse_body_name(entry, "b", scene);
  check_two_bodies(entry, pair.a, pair.b);
  pair.rule.friction = entry.number("friction", {0, 10}).value_or(scene.world.friction);
  pair.rule.collides = entry.flag("collides").value_or(true);
  pair.rule.restitution = entry.number("restitution", {0, 1}).value_or(0);
  return pair;
}

SceneJoint parse_joint(TomlTable& entry, const Scene& scene) {
  SceneJoint joint;
  JointDescription& d = joint.description;
  d.name = entry.plain_name("name").value_or("joint" + std::to_string(scene.joints.size() + 1));
  entry.require("a", "the name of a body");
  joint.a = parse_body_name(entry, "a", scene);
  joint.b = parse_body_name(entry, "b", scene);
  check_two_bodies(entry, joint.a, joint.b);
  entry.require("kind", "ball, hinge or weld");
  if (const auto kind = entry.choice("kind", joint_kinds))
    d.kind = static_cast<JointKind>(std::ranges::find(joint_kinds, *kind) - joint_kinds.begin());
  entry.require("point", "where the bodies are held together, in the world");
  d.point_m = entry.point("point", coordinate_range).value_or(d.point_m);
  if (d.kind == JointKind::hinge) {
    entry.require("axis", "of the hinge");
    d.axis = entry.point("axis", coordinate_range).value_or(d.axis);
  }
  if (d.kind != JointKind::ball) d.arm_m = entry.number("arm_m", length_range).value_or(d.arm_m);
  d.reach_m = entry.number("reach_m", length_range).value_or(d.reach_m);
  d.collide = entry.flag("collide").value_or(d.collide);
  return joint;
}

std::vector<Keyframe> parse_grab_path(TomlTable& entry) {
  std::vector<TomlTable> frames = entry.tables("keyframes");
  check_keyframe_count(entry, frames.size());
  std::vector<Keyframe> path;
  for (TomlTable& frame : frames) {
    const double time_s = parse_time(frame, path.empty() ? -1 : path.back().time_s);
    frame.require("position", "where the point that was grabbed is to be");
    path.push_back({time_s, parse_pose(frame)});
  }
  return path;
}

SceneGrab parse_grab(TomlTable& entry, const Scene& scene) {
  SceneGrab grab;
  GrabDescription& d = grab.description;
  entry.require("body", "the name of a body");
  grab.body = parse_body_name(entry, "body", scene);
  entry.require("point", "where the body is grabbed, in the world");
  d.point_m = entry.point("point", coordinate_range).value_or(d.point_m);
  d.radius_m = entry.number("radius_m", {0, 1e5}).value_or(d.radius_m);
  d.most_nodes = static_cast<int>(entry.integer("most_nodes", 1, 10000).value_or(d.most_nodes));
  grab.path = parse_grab_path(entry);
  grab.release_s = entry.number("release_s", {0, 1e6}).value_or(grab.release_s);
  return grab;
}

std::vector<TomlTable> limited_tables(TomlTable& root, std::string_view key) {
  std::vector<TomlTable> entries = root.tables(key);
  if (entries.size() <= entry_limit) return entries;
  root.refuse(IssueCode::config_bad_value, "more than " + std::to_string(entry_limit) + " entries",
              key);
  return {};
}

}  // namespace

void parse_constraints(TomlTable& root, Scene& scene) {
  for (TomlTable& entry : limited_tables(root, "pair")) scene.pairs.push_back(parse_pair(entry, scene));
  for (TomlTable& entry : limited_tables(root, "joint"))
    scene.joints.push_back(parse_joint(entry, scene));
  for (TomlTable& entry : limited_tables(root, "grab")) scene.grabs.push_back(parse_grab(entry, scene));
}

}  // namespace souple
