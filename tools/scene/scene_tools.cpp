// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/scene/scene_tools.hpp"

#include <algorithm>

#include "tools/scene/hand_path_file.hpp"

namespace souple {
namespace {

RigidPlacement inverse(const RigidPlacement& p) {
  return {p.rotation.transpose(), -(p.rotation.transpose() * p.translation)};
}

RigidPlacement after(const RigidPlacement& outer, const RigidPlacement& inner) {
  return {outer.rotation * inner.rotation, outer.rotation * inner.translation + outer.translation};
}

Pose pose_of(const RigidPlacement& at) {
  const Eigen::Quaterniond q(at.rotation);
  return {{q.w(), q.x(), q.y(), q.z()}, as_point(at.translation)};
}

const SceneRigidBody& rigid_body(const Scene& scene, const std::string& name) {
  return std::get<SceneRigidBody>(*std::ranges::find(scene.bodies, name, scene_body_name));
}

Result<std::optional<RecordedPath>> path_of(const SceneProbe& probe) {
  if (probe.device == ProbeDevice::udp) return std::optional<RecordedPath>();
  auto path =
      probe.path_file.empty() ? RecordedPath::create(probe.path) : read_hand_path(probe.path_file);
  if (!path) return path.issue();
  return std::optional<RecordedPath>(std::move(*path));
}

/// handle * hinge * turn * mount is where the scene has the body.
JawDescription jaw_of(const SceneRigidBody& body, const RigidShape& shape, const SceneProbe& probe,
                      const RigidPlacement& handle, double opening_rad, double turn_per_opening) {
  JawDescription jaw;
  jaw.shape = shape;
  jaw.coupling = probe.coupling;
  jaw.turn_per_opening = turn_per_opening;
  RigidPlacement hinge, turn;
  if (turn_per_opening != 0) {
    hinge.translation = inverse(handle).rotation * (as_vec3(probe.hinge_m) - handle.translation);
    const Vec3 axis = inverse(handle).rotation * as_vec3(probe.axis).normalized();
    jaw.axis = as_point(axis);
    turn.rotation = Mat3(Eigen::AngleAxisd(turn_per_opening * opening_rad, axis));
  }
  jaw.hinge = pose_of(hinge);
  const RigidPlacement stands = placement(body.description.path.front().pose);
  jaw.mount = pose_of(after(inverse(after(after(handle, hinge), turn)), stands));
  return jaw;
}

}  // namespace

bool is_held(const Scene& scene, const std::string& body) {
  return std::ranges::any_of(scene.probes, [&](const SceneProbe& probe) {
    return std::ranges::find(probe.jaws, body) != probe.jaws.end();
  });
}

Result<SceneTool> add_tool(World& world, const Scene& scene, const SceneProbe& probe,
                           const std::vector<RigidShape>& shapes) {
  auto path = path_of(probe);
  if (!path) return path.issue();
  ToolDescription description;
  description.name = probe.name;
  description.pose = probe.pose;
  description.opening_rad = probe.opening_rad;
  if (*path) {
    const DeviceSample begin = (*path)->at((*path)->begin_s());
    description.pose = begin.pose;
    description.opening_rad = begin.opening_rad;
  }
  const RigidPlacement handle = placement(description.pose);
  for (std::size_t k = 0; k < probe.jaws.size(); ++k) {
    const double turn = probe.jaws.size() == 1 ? 0 : k == 0 ? 0.5 : -0.5;
    description.jaws.push_back(jaw_of(rigid_body(scene, probe.jaws[k]), shapes[k], probe, handle,
                                      description.opening_rad, turn));
  }
  description.filter = rigid_body(scene, probe.jaws.front()).description.filter;
  auto tool = Tool::create(world, description);
  if (!tool) return tool.issue();
  return SceneTool{std::move(*tool), std::move(*path)};
}

}  // namespace souple
