// SPDX-License-Identifier: GPL-3.0-or-later
// `[[probe]]` of a scene: tools that a hand holds.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <set>

#include "tools/scene/scene_parts.hpp"

namespace souple {
namespace {

constexpr std::size_t probe_limit = 16;
constexpr double turn = 3.14159;  // just within half a turn
constexpr NumberRange coordinate_range{-1e3, 1e3};
constexpr NumberRange opening_range{-turn, turn};
constexpr NumberRange stiffness_range{0, 1e9, true};
constexpr NumberRange damping_range{0, 1e9};
constexpr NumberRange limit_range{0, 1e9, true};

const std::array<std::string, 3> devices{"path", "hand", "udp"};
const std::array<std::string, 3> passivities{"off", "each_freedom", "total_power"};

std::string parse_jaw(TomlTable& entry, std::string_view key, Scene& scene,
                      std::set<std::string>& held) {
  const std::string name = entry.plain_name(key).value_or("");
  if (name.empty()) return name;
  const auto body = std::ranges::find(scene.bodies, name, scene_body_name);
  if (body == scene.bodies.end()) {
    entry.refuse(IssueCode::config_bad_value, "no body is called \"" + name + "\"", key);
    return name;
  }
  const auto* rigid = std::get_if<SceneRigidBody>(&*body);
  if (rigid == nullptr || (rigid->description.shape.kind == RigidShapeKind::plane && !rigid->mesh))
    entry.refuse(IssueCode::config_bad_value, "\"" + name + "\" is no rigid body of some end", key);
  else if (rigid->description.free || rigid->description.path.size() > 1)
    entry.refuse(IssueCode::usage_conflict,
                 "\"" + name + "\" is free or follows keyframes: a hand cannot hold it as well", key);
  if (!held.insert(name).second)
    entry.refuse(IssueCode::usage_conflict, "\"" + name + "\" is held twice", key);
  return name;
}

void parse_tool(TomlTable& entry, Scene& scene, std::set<std::string>& held, SceneProbe& probe) {
  if (entry.has("body") && entry.has("jaw_a"))
    entry.refuse(IssueCode::usage_conflict, "a body and jaws were given", "body");
  if (entry.has("jaw_a") || entry.has("jaw_b")) {
    entry.require("jaw_a", "the rigid body that is the first jaw");
    entry.require("jaw_b", "the rigid body that is the second jaw");
    probe.jaws = {parse_jaw(entry, "jaw_a", scene, held), parse_jaw(entry, "jaw_b", scene, held)};
    entry.require("hinge", "a point that the jaws open about, in the world at the start");
    entry.require("axis", "of the hinge: the first jaw turns about it as the tool opens");
    probe.hinge_m = entry.point("hinge", coordinate_range).value_or(probe.hinge_m);
    probe.axis = entry.point("axis", {-1e6, 1e6}).value_or(probe.axis);
    if (!(std::hypot(probe.axis[0], probe.axis[1], probe.axis[2]) > 1e-9))
      entry.refuse(IssueCode::config_bad_value, "the axis has no length", "axis");
  } else {
    entry.require("body", "the rigid body that the hand holds, or else jaw_a and jaw_b");
    probe.jaws = {parse_jaw(entry, "body", scene, held)};
  }
}

void parse_coupling(TomlTable& entry, HandleCoupling& c) {
  c.stiffness_n_m = entry.number("stiffness_n_m", stiffness_range).value_or(c.stiffness_n_m);
  c.turn_stiffness_nm_rad =
      entry.number("turn_stiffness_nm_rad", stiffness_range).value_or(c.turn_stiffness_nm_rad);
  c.damping_n_s_m = entry.number("damping_n_s_m", damping_range).value_or(c.damping_n_s_m);
  c.turn_damping_nm_s_rad =
      entry.number("turn_damping_nm_s_rad", damping_range).value_or(c.turn_damping_nm_s_rad);
  c.look_ahead_m = entry.number("look_ahead_m", {0, 1}).value_or(c.look_ahead_m);
}

DeviceLimits parse_limits(TomlTable& entry, std::size_t jaw_count) {
  DeviceLimits limits;
  limits.rate_hz = entry.number("rate_hz", {1, 1e5}).value_or(limits.rate_hz);
  limits.force_n = entry.number("max_force_n", limit_range).value_or(limits.force_n);
  limits.torque_nm = entry.number("max_torque_nm", limit_range).value_or(limits.torque_nm);
  limits.force_slew_n_s =
      entry.number("max_force_slew_n_s", limit_range).value_or(limits.force_slew_n_s);
  limits.torque_slew_nm_s =
      entry.number("max_torque_slew_nm_s", limit_range).value_or(limits.torque_slew_nm_s);
  limits.has_opening = jaw_count == 2;
  if (jaw_count == 2)
    limits.opening_nm = entry.number("max_opening_nm", limit_range).value_or(limits.opening_nm);
  return limits;
}

// Without a budget only the sweeps end a tick, and a run is the same every time.
void parse_haptics(TomlTable& entry, SceneProbe& probe) {
  HapticSettings& h = probe.haptics;
  h.limits = parse_limits(entry, probe.jaws.size());
  h.tick_budget_s =
      entry.number("tick_budget_s", {1e-6, 1}).value_or(std::numeric_limits<double>::infinity());
  h.residual_goal = entry.number("residual_goal", {0, 1}).value_or(h.residual_goal);
  h.max_sweeps = static_cast<int>(entry.integer("max_sweeps", 1, 1'000'000).value_or(h.max_sweeps));
  h.contact_capacity =
      static_cast<std::size_t>(entry.integer("contact_capacity", 1, 4096)
                                   .value_or(static_cast<std::int64_t>(h.contact_capacity)));
  h.reach_m = entry.number("reach_m", {0, 1, true}).value_or(h.reach_m);
  h.lead_s = entry.number("lead_s", {0, 0.02}).value_or(h.lead_s);
  h.hand_over_s = entry.number("hand_over_s", {0, 10}).value_or(h.hand_over_s);
  if (const auto passivity = entry.choice("passivity", passivities))
    probe.passivity =
        static_cast<ProbePassivity>(std::ranges::find(passivities, *passivity) - passivities.begin());
}

std::vector<DeviceSample> parse_hand_keyframes(TomlTable& entry, std::size_t jaw_count) {
  std::vector<TomlTable> frames = entry.tables("keyframes");
  check_keyframe_count(entry, frames.size());
  std::vector<DeviceSample> path;
  for (TomlTable& frame : frames) {
    DeviceSample sample;
    sample.time_s = parse_time(frame, path.empty() ? -1 : path.back().time_s);
    frame.require("position", "where the handle is");
    sample.pose = parse_pose(frame);
    if (jaw_count == 2) sample.opening_rad = frame.number("opening_rad", opening_range).value_or(0);
    path.push_back(sample);
  }
  return path;
}

void parse_hand(TomlTable& entry, SceneProbe& probe) {
  probe.grip = entry.number("grip", {0, 1}).value_or(probe.grip);
  probe.resolution_m = entry.number("resolution_m", {0, 1}).value_or(0);
  probe.turn_resolution_rad = entry.number("turn_resolution_rad", {0, 1}).value_or(0);
  probe.opening_resolution_rad = entry.number("opening_resolution_rad", {0, 1}).value_or(0);
  probe.delay_ticks = static_cast<std::size_t>(entry.integer("delay_ticks", 0, 1000).value_or(0));
}

void parse_device(TomlTable& entry, SceneProbe& probe) {
  entry.require("device", "path, hand or udp");
  if (const auto device = entry.choice("device", devices))
    probe.device = static_cast<ProbeDevice>(std::ranges::find(devices, *device) - devices.begin());
  if (probe.device == ProbeDevice::udp) {
    entry.require("port", "of 127.0.0.1, to which the device sends");
    probe.port = static_cast<std::uint16_t>(entry.integer("port", 1024, 65535).value_or(0));
    probe.pose = parse_pose(entry);
    probe.opening_rad = entry.number("opening_rad", opening_range).value_or(0);
    return;
  }
  if (probe.device == ProbeDevice::hand) parse_hand(entry, probe);
  if (entry.has("file") == entry.has("keyframes"))
    entry.refuse(IssueCode::config_missing_key,
                 "a path or hand needs a file or keyframes, and not both", "device");
  probe.path_file = entry.text("file").value_or("");
  probe.path = parse_hand_keyframes(entry, probe.jaws.size());
}

SceneProbe parse_probe(TomlTable& entry, Scene& scene, std::set<std::string>& held) {
  SceneProbe probe;
  probe.name = entry.plain_name("name").value_or("probe" + std::to_string(scene.probes.size() + 1));
  parse_tool(entry, scene, held, probe);
  parse_coupling(entry, probe.coupling);
  parse_haptics(entry, probe);
  parse_device(entry, probe);
  return probe;
}

}  // namespace

void parse_probes(TomlTable& root, Scene& scene) {
  std::vector<TomlTable> entries = root.tables("probe");
  if (entries.size() > probe_limit) {
    root.refuse(IssueCode::config_bad_value, "more than " + std::to_string(probe_limit) + " probes",
                "probe");
    return;
  }
  std::set<std::string> held;
  for (TomlTable& entry : entries) scene.probes.push_back(parse_probe(entry, scene, held));
  std::set<std::string> names;
  for (const SceneProbe& probe : scene.probes)
    if (!names.insert(probe.name).second && root.status())
      root.refuse(IssueCode::config_bad_value, "two probes are called \"" + probe.name + "\"", "probe");
}

std::string_view probe_device_name(ProbeDevice device) {
  return devices[static_cast<std::size_t>(device)];
}

std::string_view probe_passivity_name(ProbePassivity passivity) {
  return passivities[static_cast<std::size_t>(passivity)];
}

}  // namespace souple
