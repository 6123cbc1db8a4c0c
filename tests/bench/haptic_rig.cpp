// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/bench/haptic_rig.hpp"

#include <algorithm>
#include <utility>

#include "runtime/fem/linear_algebra.hpp"
#include "tests/bench/bench_data.hpp"

namespace souple::bench {

const char* coupling_name(Coupling coupling) {
  switch (coupling) {
    case Coupling::virtual_coupling:
      return "virtual_coupling";
    case Coupling::god_object:
      return "god_object";
    default:
      return "contact_problem";
  }
}

HapticRig::HapticRig(World world, HapticChannel channel, double stiffness_n_m)
    : world_(std::move(world)), channel_(std::move(channel)), stiffness_(stiffness_n_m) {
  problem_.reserve(channel_.settings().contact_capacity);
}

HapticRig HapticRig::make(World world, const Point& at, double radius_m, double stiffness_n_m,
                          double tick_s) {
  JawDescription ball;
  ball.shape.kind = RigidShapeKind::sphere;
  ball.shape.radius_m = radius_m;
  ball.coupling.stiffness_n_m = stiffness_n_m;
  ball.coupling.look_ahead_m = 0.005;
  ToolDescription description;
  description.name = "tool";
  description.jaws = {ball};
  description.pose.translation = at;
  HapticSettings settings;
  settings.tick_budget_s = 1e9;
  settings.limits.rate_hz = 1 / tick_s;
  Tool tool = value_or_exit(Tool::create(world, description));
  HapticChannel channel = value_or_exit(HapticChannel::create(std::move(tool), settings));
  return HapticRig(std::move(world), std::move(channel), stiffness_n_m);
}

void HapticRig::physics_step() {
  if (auto status = channel_.begin_step(world_); !status) exit_with(status.issue());
  value_or_exit(world_.step());
  if (auto status = channel_.publish(world_); !status) exit_with(status.issue());
  if (auto status = world_.tool_problem(channel_.tool().bodies(), problem_); !status)
    exit_with(status.issue());
}

// The place nearest to the device on the free side of every plane; by projecting on them in turn.
Vec3 HapticRig::god_object(const Vec3& device) const {
  constexpr int rounds = 200;
  const Vec3 start = as_vec3(world_.rigid_pose(channel_.tool().bodies().front()).translation);
  Vec3 proxy = device;
  for (int round = 0; round < rounds; ++round)
    for (std::size_t i = 0; i < problem_.contacts.size(); ++i) {
      const ToolContact& contact = problem_.contacts[i];
      if (contact.a.jaw < 0 && contact.b.jaw < 0) continue;
      const Vec3 normal = (contact.a.jaw >= 0 ? 1.0 : -1.0) * contact.frame.col(0);
      const double gap = double(problem_.gap[3 * i]) + normal.dot(proxy - start);
      if (gap < 0) proxy -= gap * normal;
    }
  return proxy;
}

Wrench HapticRig::tick(Coupling coupling, const DeviceSample& sample) {
  const Wrench lawful = channel_.tick(sample);
  if (coupling == Coupling::contact_problem) return lawful;
  const Vec3 device = as_vec3(sample.pose.translation);
  const Vec3 tool =
      coupling == Coupling::god_object
          ? god_object(device)
          : Vec3(as_vec3(world_.rigid_pose(channel_.tool().bodies().front()).translation));
  Wrench wrench;
  wrench.force_n = as_point(stiffness_ * (tool - device));
  return wrench;
}

}  // namespace souple::bench
