// SPDX-License-Identifier: MIT
// Joints and grabs as pairs of points, and what these add to the contact problem.
#include "runtime/world/pins.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "runtime/world/rigid_path.hpp"
#include "runtime/world/world_state.hpp"

namespace souple {
namespace {

Status refuse(const std::string& what, const std::string& where) {
  return make_issue(IssueCode::joint_invalid, what, where);
}

Vec3 soft_point(const SoftBody& body, const ContactSide& side) {
  Vec3 point = Vec3::Zero();
  for (std::size_t k = 0; k < std::size_t(side.count); ++k)
    point += side.weight[k] * node_entry(body.x, side.node[k]);
  return point;
}

bool has_compliance(const SoftBody& body, Index node) {
  return body.is_fixed[std::size_t(node)] || !body.compliance ||
         body.compliance->row_of_node[std::size_t(node)] >= 0;
}

// The nearest point of the boundary of a soft body, as it is now.
Result<PinPoint> nearest_point(SoftBody& body, std::uint32_t index, const Vec3& point, double reach) {
  body.surface.refit(body.x);
  const SurfaceHit hit = body.surface.closest(point, std::max(reach, 1e-9));
  if (hit.triangle < 0)
    return refuse("no point of its boundary is within " + std::to_string(reach) + " m", body.name)
        .issue();
  PinPoint pin;
  pin.side.body = index;
  pin.side.count = 3;
  pin.side.node = body.asset->surface().triangles()[std::size_t(hit.triangle)];
  pin.side.weight = hit.closest.weight;
  for (const Index node : pin.side.node)
    if (!has_compliance(body, node))
      return refuse("the point is outside the region of the body's compliance", body.name).issue();
  return pin;
}

Vec3 in_frame(const RigidPlacement& frame, const Vec3& point) {
  return frame.rotation.transpose() * (point - frame.translation);
}

Vec3 out_of_frame(const RigidPlacement& frame, const Vec3& point) {
  return frame.rotation * point + frame.translation;
}

std::vector<Vec3> points_of(const JointDescription& d) {
  const Vec3 at = as_vec3(d.point_m);
  std::vector<Vec3> points{at};
  if (d.kind == JointKind::ball) return points;
  const Vec3 axis = as_vec3(d.axis).normalized();
  const Mat3 frame = contact_frame(axis);
  // Both ends of a hinge, or a triangle.
  points = {at - 0.5 * d.arm_m * axis, at + 0.5 * d.arm_m * axis};
  if (d.kind == JointKind::weld) points.push_back(at + d.arm_m * frame.col(1));
  return points;
}

}  // namespace

Result<PinPoint> World::State::pin_to(std::uint32_t index, const Vec3& point, double reach) {
  if (is_soft(index)) return nearest_point(soft(index), index, point, reach);
  PinPoint pin;
  pin.side.body = index;
  pin.local = in_frame(rigid(index).placement_at(time), point);
  return pin;
}

Status World::State::check_joint(const JointDescription& d) const {
  const auto known = [&](BodyId body) { return body.index < bodies.size(); };
  if (!known(d.body_a) || (d.body_b && !known(*d.body_b)) || (d.body_b && *d.body_b == d.body_a))
    return refuse("a joint is between two bodies of this world, or one and the world", d.name);
  const auto moved = [&](BodyId b) { return is_soft(b.index) || rigid(b.index).free.has_value(); };
  if (!moved(d.body_a) && !(d.body_b && moved(*d.body_b)))
    return refuse("forces move neither of its bodies", d.name);
  if (!as_vec3(d.point_m).allFinite() || !(as_vec3(d.point_m).norm() < 1e6) ||
      !as_vec3(d.axis).allFinite() || !(as_vec3(d.axis).norm() > 1e-12) ||
      !(d.arm_m > 1e-9 && d.arm_m < 1e6) || !(d.reach_m >= 0 && d.reach_m < 1e6))
    return refuse("a point, axis, arm or reach that is none", d.name);
  return {};
}

Status World::State::add_pins(const JointDescription& d, std::uint32_t joint) {
  std::vector<Pin> added;
  for (const Vec3& point : points_of(d)) {
    Pin pin;
    pin.serial = pins.serial_count + Index(added.size());
    pin.joint = joint;
    auto a = pin_to(d.body_a.index, point, d.reach_m);
    if (!a) return a.issue();
    pin.a = *a;
    // Held where they are: a point that a soft body does not have is taken where that has its own.
    const Vec3 held = where(pin.a);
    pin.b.local = held;
    if (d.body_b) {
      auto b = pin_to(d.body_b->index, held, d.reach_m);
      if (!b) return b.issue();
      pin.b = *b;
      if (!is_soft(d.body_a.index)) pin.a = *pin_to(d.body_a.index, where(pin.b), 0);
    }
    added.push_back(pin);
  }
  pins.serial_count += Index(added.size());
  pins.all.insert(pins.all.end(), added.begin(), added.end());
  return {};
}

// The boundary nodes that a grab takes hold of, the nearest first.
std::vector<Index> World::State::nodes_near(const SoftBody& body, const GrabDescription& d) const {
  std::vector<std::pair<double, Index>> near;
  for (const Index node : body.asset->surface().nodes()) {
    if (body.is_fixed[std::size_t(node)] || !has_compliance(body, node)) continue;
    near.emplace_back((node_entry(body.x, node) - as_vec3(d.point_m)).norm(), node);
  }
  std::ranges::sort(near);
  std::vector<Index> nodes;
  for (const auto& [distance, node] : near) {
    if (!nodes.empty() && (distance > d.radius_m || int(nodes.size()) >= d.most_nodes)) break;
    nodes.push_back(node);
  }
  return nodes;
}

Status World::State::add_grab_pins(const GrabDescription& d, std::uint32_t grab) {
  std::vector<PinPoint> held;
  if (is_soft(d.body.index)) {
    for (const Index node : nodes_near(soft(d.body.index), d)) {
      PinPoint point;
      point.side = {d.body.index, 1, {node}, {1.0}};
      held.push_back(point);
    }
  } else if (rigid(d.body.index).free) {
    JointDescription places;
    places.kind = d.radius_m > 0 ? JointKind::weld : JointKind::ball;
    places.point_m = d.point_m;
    places.arm_m = std::max(d.radius_m, 1e-9);
    for (const Vec3& p : points_of(places)) held.push_back(*pin_to(d.body.index, p, 0));
  }
  if (held.empty()) return refuse("there is nothing of the body that can be held", "");
  for (const PinPoint& point : held) {
    Pin pin;
    pin.serial = pins.serial_count++;
    pin.a = point;
    pin.grab = grab;
    pin.b.local = where(point);
    pins.all.push_back(pin);
  }
  return {};
}

// In the world, now.
Vec3 World::State::where(const PinPoint& point) const {
  if (point.side.body == ContactSide::no_body) return point.local;
  if (is_soft(point.side.body)) return soft_point(soft(point.side.body), point.side);
  return out_of_frame(rigid(point.side.body).placement_at(time), point.local);
}

void World::State::add_pin_contacts() {
  for (const Pin& pin : pins.all) {
    const bool a_moves = is_movable(pin.a.side.body);
    const bool b_moves = pin.b.side.body != ContactSide::no_body && is_movable(pin.b.side.body);
    if (!a_moves && !b_moves) continue;
    Contact c;
    c.key = {pin.a.side.body, -2 - pin.serial, pin.b.side.body, -1};
    c.a = pin.a.side;
    c.b = pin.b.side;
    c.law.kind = ConstraintLaw::Kind::bilateral;
    c.law.softness = 1e-6;
    c.point = where(pin.b);
    if (pin.grab != Pin::none) {
      const Handle& handle = pins.handles[pin.grab];
      c.point = out_of_frame(handle.now, pin.b.local);
      c.driven_motion = out_of_frame(handle.next, pin.b.local) - c.point;
    }
    const Vec3 apart = where(pin.a) - c.point;
    c.gap = apart[0];
    c.offset = apart.tail<2>();
    contacts.push_back(c);
  }
}

Result<JointId> World::add_joint(const JointDescription& description) {
  State& s = *state_;
  if (auto status = s.check_joint(description); !status) return status.issue();
  if (auto status = s.add_pins(description, s.pins.joint_count); !status) return status.issue();
  if (description.body_b && !description.collide) {
    PairRule rule = s.pair(description.body_a.index, description.body_b->index);
    rule.collides = false;
    s.pairs.set(description.body_a.index, description.body_b->index, rule);
  }
  wake(description.body_a);
  if (description.body_b) wake(*description.body_b);
  return JointId{s.pins.joint_count++};
}

Result<GrabId> World::grab(const GrabDescription& d) {
  State& s = *state_;
  if (d.body.index >= s.bodies.size() || !as_vec3(d.point_m).allFinite() ||
      !(d.radius_m >= 0 && d.radius_m < 1e6) || d.most_nodes < 1)
    return refuse("a grab is of a body of this world, at a point, with a radius and a node or more", "")
        .issue();
  const auto index = static_cast<std::uint32_t>(s.pins.handles.size());
  if (auto status = s.add_grab_pins(d, index); !status) return status.issue();
  s.pins.handles.emplace_back().is_held = true;
  wake(d.body);
  return GrabId{index};
}

Status World::move_grab(GrabId grab, const Pose& pose) {
  State& s = *state_;
  if (grab.index >= s.pins.handles.size() || !s.pins.handles[grab.index].is_held)
    return make_issue(IssueCode::world_parameter_invalid, "there is no such grab");
  if (auto status = check_pose(pose, IssueCode::world_parameter_invalid, "grab"); !status)
    return status;
  s.pins.handles[grab.index].next = placement(pose);
  for (const Pin& pin : s.pins.all)
    if (pin.grab == grab.index) s.wake_group(pin.a.side.body);
  return {};
}

Status World::release(GrabId grab) {
  State& s = *state_;
  if (grab.index >= s.pins.handles.size() || !s.pins.handles[grab.index].is_held)
    return make_issue(IssueCode::world_parameter_invalid, "there is no such grab");
  s.pins.handles[grab.index].is_held = false;
  for (const Pin& pin : s.pins.all)
    if (pin.grab == grab.index) s.wake_group(pin.a.side.body);
  std::erase_if(s.pins.all, [&](const Pin& pin) { return pin.grab == grab.index; });
  return {};
}

}  // namespace souple
