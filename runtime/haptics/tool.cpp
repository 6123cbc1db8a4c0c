// SPDX-License-Identifier: MIT
#include "runtime/haptics/tool.hpp"

#include <cmath>

#include "runtime/world/rigid_path.hpp"

namespace souple {
namespace {

RigidPlacement operator*(const RigidPlacement& a, const RigidPlacement& b) {
  return {a.rotation * b.rotation, a.rotation * b.translation + a.translation};
}

Pose pose_of(const RigidPlacement& at) {
  const Eigen::Quaterniond q(at.rotation);
  return {{q.w(), q.x(), q.y(), q.z()}, as_point(at.translation)};
}

Status refuse(const std::string& what, const std::string& where) {
  return make_issue(IssueCode::world_parameter_invalid, what, where);
}

Status check_opening(double opening_rad, const std::string& where) {
  if (std::abs(opening_rad) <= M_PI) return {};
  return refuse("the opening of a tool is within half a turn", where);
}

Status check_tool(const ToolDescription& d) {
  if (d.jaws.empty() || d.jaws.size() > most_jaws)
    return refuse("a tool has one jaw or two, not " + std::to_string(d.jaws.size()), d.name);
  if (auto status = check_pose(d.pose, IssueCode::world_parameter_invalid, d.name); !status)
    return status;
  for (const JawDescription& jaw : d.jaws) {
    for (const Pose* pose : {&jaw.hinge, &jaw.mount})
      if (auto status = check_pose(*pose, IssueCode::world_parameter_invalid, d.name); !status)
        return status;
    const double length = as_vec3(jaw.axis).norm();
    if (!std::isfinite(length) || !(length > 1e-12) || !(std::abs(jaw.turn_per_opening) <= 10))
      return refuse("a hinge needs an axis of some length and a turn of at most 10 per opening",
                    d.name);
  }
  return check_opening(d.opening_rad, d.name);
}

}  // namespace

Result<Tool> Tool::create(World& world, const ToolDescription& d) {
  if (auto status = check_tool(d); !status) return status.issue();
  Tool tool;
  for (const JawDescription& jaw : d.jaws)
    tool.jaws_.push_back({placement(jaw.hinge), placement(jaw.mount), as_vec3(jaw.axis).normalized(),
                          jaw.turn_per_opening});
  for (std::size_t k = 0; k < d.jaws.size(); ++k) {
    RigidBodyDescription body;
    body.name = d.jaws.size() == 1 ? d.name : d.name + " jaw " + std::to_string(k + 1);
    body.shape = d.jaws[k].shape;
    body.path = {{0, pose_of(tool.jaw_pose(k, placement(d.pose), d.opening_rad))}};
    body.handle = d.jaws[k].coupling;
    body.filter = d.filter;
    auto id = world.add_rigid_body(body);
    if (!id) return id.issue();
    tool.bodies_.push_back(*id);
  }
  if (tool.bodies_.size() == 2)
    if (auto status = world.set_pair(tool.bodies_[0], tool.bodies_[1], {.collides = false}); !status)
      return status.issue();
  return tool;
}

bool Tool::has_opening() const {
  for (const Jaw& jaw : jaws_)
    if (jaw.turn_per_opening != 0) return true;
  return false;
}

RigidPlacement Tool::jaw_pose(std::size_t jaw, const RigidPlacement& handle, double opening_rad) const {
  const Jaw& j = jaws_[jaw];
  const double angle = j.turn_per_opening * opening_rad;
  const RigidPlacement turned{Mat3(Eigen::AngleAxisd(angle, j.axis)), Vec3::Zero()};
  return handle * j.hinge * turned * j.mount;
}

Vec3 Tool::hinge_point(std::size_t jaw, const RigidPlacement& handle) const {
  return handle.rotation * jaws_[jaw].hinge.translation + handle.translation;
}

Vec3 Tool::hinge_turn(std::size_t jaw, const RigidPlacement& handle) const {
  const Jaw& j = jaws_[jaw];
  return j.turn_per_opening * (handle.rotation * (j.hinge.rotation * j.axis));
}

template <class Set>
Status Tool::for_each_pose(const Pose& handle, double opening_rad, Set&& set) const {
  if (auto status = check_pose(handle, IssueCode::world_parameter_invalid, "tool"); !status)
    return status;
  if (auto status = check_opening(opening_rad, "tool"); !status) return status;
  const RigidPlacement at = placement(handle);
  for (std::size_t k = 0; k < jaws_.size(); ++k)
    if (auto status = set(bodies_[k], pose_of(jaw_pose(k, at, opening_rad))); !status) return status;
  return {};
}

Status Tool::move(World& world, const Pose& handle, double opening_rad) const {
  return for_each_pose(handle, opening_rad,
                       [&](BodyId body, const Pose& pose) { return world.move_handle(body, pose); });
}

Status Tool::place(World& world, const Pose& handle, double opening_rad) const {
  return for_each_pose(handle, opening_rad, [&](BodyId body, const Pose& pose) {
    return world.set_rigid_state(body, pose, {}, {});
  });
}

}  // namespace souple
