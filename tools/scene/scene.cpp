// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/scene/scene.hpp"

#include <array>
#include <cmath>
#include <numbers>
#include <set>

#include "tools/exchange/strict_toml.hpp"

namespace souple {
namespace {

constexpr std::size_t body_limit = 10000;
constexpr std::size_t keyframe_limit = 100000;

// Wide enough for any scene, narrow enough that no product of two of them overflows.
constexpr NumberRange coordinate_range{-1e6, 1e6};
constexpr NumberRange speed_range{-1e6, 1e6};
constexpr NumberRange length_range{0, 1e6, true};
constexpr NumberRange tolerance_range{1e-15, 0.5};
constexpr std::int64_t iteration_limit = 1'000'000;

const std::array<std::string, 2> contact_methods{"warped", "exact"};
const std::array<std::string, 2> body_kinds{"soft", "rigid"};
constexpr std::array<std::string_view, 12> body_keys{
    "kind",  "name",  "asset",    "position", "rotation", "velocity", "angular_velocity",
    "fixed", "shape", "radius_m", "size_m",   "keyframes"};
const std::array<std::string, 3> shape_kinds{"plane", "sphere", "box"};
const std::array<std::string, 2> frame_contents{"tets", "surface"};

WorldSettings parse_world(TomlTable world) {
  WorldSettings s;
  world.require("time_step_s", "the length of a step; an asset holds compliances for some steps only");
  s.time_step_s = world.number("time_step_s", {1e-7, 10}).value_or(s.time_step_s);
  s.gravity_m_s2 = world.point("gravity", {-1e4, 1e4}).value_or(s.gravity_m_s2);
  s.friction = world.number("friction", {0, 10}).value_or(s.friction);
  s.alarm_distance_m = world.number("alarm_distance_m", {0, 1e6}).value_or(s.alarm_distance_m);
  if (world.choice("contact_method", contact_methods).value_or("warped") == "exact")
    s.contact_method = ContactMethod::exact;
  s.feed_forward_forces = world.flag("feed_forward_forces").value_or(s.feed_forward_forces);
  auto& contact = s.contact_solver;
  contact.tolerance = world.number("contact_tolerance", tolerance_range).value_or(contact.tolerance);
  contact.max_sweeps = static_cast<int>(
      world.integer("contact_max_sweeps", 1, iteration_limit).value_or(contact.max_sweeps));
  s.contact_passes =
      static_cast<int>(world.integer("contact_passes", 1, 20).value_or(s.contact_passes));
  auto& free = s.free_motion;
  free.tolerance = world.number("solver_tolerance", tolerance_range).value_or(free.tolerance);
  free.max_iterations = static_cast<int>(
      world.integer("solver_max_iterations", 1, iteration_limit).value_or(free.max_iterations));
  return s;
}

/// {axis, angle_deg} or {quaternion = [w, x, y, z]}; normalised.
std::array<double, 4> parse_rotation(TomlTable rotation) {
  const auto given = rotation.numbers("quaternion", 4, {-1e6, 1e6});
  const auto axis = rotation.point("axis", {-1e6, 1e6});
  const auto angle_deg = rotation.number("angle_deg", {-1e6, 1e6});
  if (given && (axis || angle_deg))
    rotation.refuse(IssueCode::usage_conflict, "a quaternion and an axis were given", "quaternion");
  if (axis.has_value() != angle_deg.has_value())
    rotation.refuse(IssueCode::config_missing_key, "axis and angle_deg belong together",
                    axis ? "angle_deg" : "axis");
  std::array<double, 4> q{1, 0, 0, 0};
  if (given) q = {(*given)[0], (*given)[1], (*given)[2], (*given)[3]};
  if (axis && angle_deg) {
    const double half = *angle_deg * std::numbers::pi / 360;
    const double length = std::hypot((*axis)[0], (*axis)[1], (*axis)[2]);
    // A zero axis gives NaN and is refused below with the quaternions of no length.
    const double s = std::sin(half) / length;
    q = {std::cos(half), s * (*axis)[0], s * (*axis)[1], s * (*axis)[2]};
  }
  const double norm = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
  if (!(norm > 1e-9)) {
    rotation.refuse(IssueCode::config_bad_value, "the rotation has no direction",
                    given ? "quaternion" : "axis");
    return {1, 0, 0, 0};
  }
  for (double& component : q) component /= norm;
  return q;
}

Pose parse_pose(TomlTable& table) {
  Pose pose;
  pose.translation = table.point("position", coordinate_range).value_or(Point{});
  pose.rotation = parse_rotation(table.table("rotation"));
  return pose;
}

SceneSoftBody parse_soft_body(TomlTable& entry) {
  SceneSoftBody body;
  entry.require("asset", "the .souple file, relative to the scene");
  body.asset = entry.text("asset").value_or("");
  body.description.pose = parse_pose(entry);
  body.description.velocity_m_s = entry.point("velocity", speed_range).value_or(Point{});
  body.description.angular_velocity_rad_s =
      entry.point("angular_velocity", speed_range).value_or(Point{});
  body.description.fixed_set = entry.plain_name("fixed").value_or("");
  return body;
}

RigidShape parse_shape(TomlTable& entry) {
  RigidShape shape;
  entry.require("shape", "plane, sphere or box");
  const std::string kind = entry.choice("shape", shape_kinds).value_or("plane");
  if (kind == "sphere") {
    shape.kind = RigidShapeKind::sphere;
    entry.require("radius_m", "of the sphere");
    shape.radius_m = entry.number("radius_m", length_range).value_or(1);
  } else if (kind == "box") {
    shape.kind = RigidShapeKind::box;
    entry.require("size_m", "the sides [x, y, z] of the box");
    shape.half_extents_m = entry.point("size_m", length_range).value_or(Point{1, 1, 1});
    for (double& side : shape.half_extents_m) side /= 2;
  }
  return shape;
}

std::vector<Keyframe> parse_path(TomlTable& entry) {
  std::vector<TomlTable> frames = entry.tables("keyframes");
  if (frames.empty()) return {Keyframe{0, parse_pose(entry)}};
  if (frames.size() > keyframe_limit)
    entry.refuse(IssueCode::config_bad_value,
                 "more than " + std::to_string(keyframe_limit) + " keyframes", "keyframes");
  if (entry.has("position") || entry.has("rotation"))
    entry.refuse(IssueCode::usage_conflict, "a pose and keyframes were given", "keyframes");
  std::vector<Keyframe> path;
  for (TomlTable& frame : frames) {
    frame.require("time_s", "when the body is at this pose");
    const double time_s = frame.number("time_s", {0, 1e6}).value_or(0);
    if (!path.empty() && time_s <= path.back().time_s)
      frame.refuse(IssueCode::config_bad_value, "the times of keyframes have to ascend", "time_s");
    path.push_back({time_s, parse_pose(frame)});
  }
  return path;
}

SceneBody parse_body(TomlTable& entry, std::size_t number) {
  entry.require("kind", "soft or rigid");
  const std::string name = entry.plain_name("name").value_or("body" + std::to_string(number));
  if (entry.choice("kind", body_kinds).value_or("rigid") == "soft") {
    SceneSoftBody body = parse_soft_body(entry);
    body.description.name = name;
    return body;
  }
  RigidBodyDescription body;
  body.name = name;
  if (!entry.has("kind")) {
    // Without a kind no other key can be judged: let them all pass, the missing kind is reported.
    for (const std::string_view key : body_keys) entry.has(key);
    return body;
  }
  body.shape = parse_shape(entry);
  body.path = parse_path(entry);
  return body;
}

SceneOutput parse_output(TomlTable output) {
  SceneOutput o;
  o.frames_every = output.integer("frames_every", 1, 1'000'000).value_or(o.frames_every);
  o.vtu = output.flag("vtu").value_or(o.vtu);
  if (output.choice("content", frame_contents).value_or("tets") == "surface")
    o.content = FrameContent::surface;
  o.combined = output.flag("combined").value_or(o.combined);
  o.plane_size_m = output.number("plane_size_m", length_range).value_or(o.plane_size_m);
  return o;
}

void check_names(TomlTable& root, const Scene& scene) {
  std::set<std::string> names{"scene"};  // the combined frames are called so
  for (const SceneBody& body : scene.bodies)
    if (!names.insert(scene_body_name(body)).second)
      root.refuse(IssueCode::config_bad_value,
                  "two bodies are called \"" + scene_body_name(body) + "\", or one \"scene\"", "body",
                  "Give every body a name of its own, other than \"scene\".");
}

Result<Scene> parse_scene_table(TomlTable& root) {
  Scene scene;
  scene.world = parse_world(root.table("world"));
  scene.output = parse_output(root.table("output"));
  std::vector<TomlTable> bodies = root.tables("body");
  root.require("body", "a scene needs at least one [[body]]");
  root.require("world", "a table with the time step and the laws");
  if (bodies.size() > body_limit)
    root.refuse(IssueCode::config_bad_value, "more than " + std::to_string(body_limit) + " bodies",
                "body");
  else
    for (TomlTable& entry : bodies) scene.bodies.push_back(parse_body(entry, scene.bodies.size() + 1));
  if (root.status()) check_names(root, scene);
  if (auto status = root.finish(); !status) return status.issue();
  return scene;
}

}  // namespace

Result<Scene> parse_scene(std::string_view text, const std::string& name) {
  auto root = TomlTable::parse(text, name);
  if (!root) return root.issue();
  return parse_scene_table(*root);
}

Result<Scene> read_scene(const std::filesystem::path& file) {
  auto root = TomlTable::parse_file(file);
  if (!root) return root.issue();
  auto scene = parse_scene_table(*root);
  if (!scene) return scene;
  for (SceneBody& body : scene->bodies)
    if (auto* soft = std::get_if<SceneSoftBody>(&body); soft != nullptr && soft->asset.is_relative())
      soft->asset = file.parent_path() / soft->asset;
  return scene;
}

const std::string& scene_body_name(const SceneBody& body) {
  if (const auto* soft = std::get_if<SceneSoftBody>(&body)) return soft->description.name;
  return std::get<RigidBodyDescription>(body).name;
}

std::string_view contact_method_name(ContactMethod method) {
  return contact_methods[static_cast<std::size_t>(method)];
}

}  // namespace souple
