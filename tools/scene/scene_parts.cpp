// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/scene/scene_parts.hpp"

#include <array>
#include <cmath>
#include <numbers>

namespace souple {
namespace {

constexpr std::size_t keyframe_limit = 100000;
constexpr std::size_t load_limit = 1000;  // of a body

constexpr NumberRange coordinate_range{-1e6, 1e6};
constexpr NumberRange load_range{-1e12, 1e12};  // N or Pa

const std::array<std::string, 3> load_kinds{"force", "traction", "pressure"};

}  // namespace

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

void check_keyframe_count(TomlTable& entry, std::size_t count) {
  if (count > keyframe_limit)
    entry.refuse(IssueCode::config_bad_value,
                 "more than " + std::to_string(keyframe_limit) + " keyframes", "keyframes");
}

double parse_time(TomlTable& frame, double last) {
  frame.require("time_s", "when this holds");
  const double time_s = frame.number("time_s", {0, 1e6}).value_or(0);
  if (time_s <= last && frame.status())
    frame.refuse(IssueCode::config_bad_value, "the times of keyframes have to ascend", "time_s");
  return time_s;
}

Pose parse_pose(TomlTable& table) {
  Pose pose;
  pose.translation = table.point("position", coordinate_range).value_or(Point{});
  pose.rotation = parse_rotation(table.table("rotation"));
  return pose;
}

std::vector<Keyframe> parse_path(TomlTable& entry) {
  std::vector<TomlTable> frames = entry.tables("keyframes");
  if (frames.empty()) return {Keyframe{0, parse_pose(entry)}};
  check_keyframe_count(entry, frames.size());
  if (entry.has("position") || entry.has("rotation"))
    entry.refuse(IssueCode::usage_conflict, "a pose and keyframes were given", "keyframes");
  std::vector<Keyframe> path;
  for (TomlTable& frame : frames) {
    const double time_s = parse_time(frame, path.empty() ? -1 : path.back().time_s);
    path.push_back({time_s, parse_pose(frame)});
  }
  return path;
}

std::vector<DrivenSet> parse_driven(TomlTable& entry) {
  std::vector<DrivenSet> driven;
  for (TomlTable& part : entry.tables("driven")) {
    part.require("set", "the nodes that are driven, a set of the asset");
    const std::string name = part.plain_name("set").value_or("");
    driven.push_back({name, parse_path(part)});
  }
  return driven;
}

namespace {

/// A value of a load: `vector`, or `pressure_pa` of a pressure.
LoadKeyframe parse_load_value(TomlTable& table, LoadKind kind, double time_s) {
  LoadKeyframe value{time_s, {}, 0};
  if (kind == LoadKind::pressure) {
    table.require("pressure_pa", "of the pressure; > 0 pushes inwards");
    value.pressure_pa = table.number("pressure_pa", load_range).value_or(0);
  } else {
    table.require("vector", "of the force in N, or of the traction in Pa");
    value.vector = table.point("vector", load_range).value_or(Point{});
  }
  return value;
}

std::vector<LoadKeyframe> parse_load_course(TomlTable& entry, LoadKind kind) {
  std::vector<TomlTable> frames = entry.tables("keyframes");
  if (frames.empty()) return {parse_load_value(entry, kind, 0)};
  check_keyframe_count(entry, frames.size());
  if (entry.has("vector") || entry.has("pressure_pa"))
    entry.refuse(IssueCode::usage_conflict, "a value and keyframes were given", "keyframes");
  std::vector<LoadKeyframe> course;
  for (TomlTable& frame : frames) {
    const double time_s = parse_time(frame, course.empty() ? -1 : course.back().time_s);
    course.push_back(parse_load_value(frame, kind, time_s));
  }
  return course;
}

LoadPlace parse_load_place(TomlTable& entry, LoadKind kind) {
  LoadPlace place;
  place.set = entry.plain_name("set").value_or("");
  place.point = entry.point("point", coordinate_range);
  if (entry.has("box")) {
    TomlTable box = entry.table("box");
    box.require("min", "the lower corner");
    box.require("max", "the upper corner");
    place.box = {box.point("min", coordinate_range).value_or(Point{}),
                 box.point("max", coordinate_range).value_or(Point{})};
  }
  const int given = !place.set.empty() + place.point.has_value() + place.box.has_value();
  if (given > 1)
    entry.refuse(IssueCode::usage_conflict, "set, box and point exclude each other", "kind");
  if (kind == LoadKind::node_force && given == 0)
    entry.refuse(IssueCode::config_missing_key, "a force needs a set, a box or a point", "kind");
  if (kind != LoadKind::node_force && place.point)
    entry.refuse(IssueCode::usage_conflict, "only a force acts at a point", "point");
  return place;
}

SceneLoad parse_load(TomlTable& entry, std::size_t number) {
  SceneLoad scene_load;
  LoadDescription& load = scene_load.load;
  entry.require("kind", "force, traction or pressure");
  const std::string kind = entry.choice("kind", load_kinds).value_or("force");
  load.kind = kind == "force"      ? LoadKind::node_force
              : kind == "traction" ? LoadKind::traction
                                   : LoadKind::pressure;
  load.name = entry.plain_name("name").value_or("load" + std::to_string(number));
  load.follows = entry.flag("follows").value_or(load.kind == LoadKind::pressure);
  load.course = parse_load_course(entry, load.kind);
  scene_load.place = parse_load_place(entry, load.kind);
  if (scene_load.place.point) load.kind = LoadKind::point_force;
  return scene_load;
}

}  // namespace

std::vector<SceneLoad> parse_loads(TomlTable& entry) {
  std::vector<SceneLoad> loads;
  std::vector<TomlTable> entries = entry.tables("load");
  if (entries.size() > load_limit)
    entry.refuse(IssueCode::config_bad_value, "more than " + std::to_string(load_limit) + " loads",
                 "load");
  else
    for (TomlTable& one : entries) loads.push_back(parse_load(one, loads.size() + 1));
  return loads;
}

}  // namespace souple
