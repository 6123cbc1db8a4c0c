// SPDX-License-Identifier: MIT
#include "tests/support/tool_scenes.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "formats/core/issue.hpp"

namespace souple::test {
namespace {

Tool created(World& world, const ToolDescription& description) {
  auto tool = Tool::create(world, description);
  EXPECT_TRUE(tool.ok()) << (tool.ok() ? "" : format_issue(tool.issue()));
  return *tool;
}

void expect_ok(const Status& status) {
  EXPECT_TRUE(status.ok()) << (status.ok() ? "" : format_issue(status.issue()));
}

}  // namespace

DeviceSample sample_at(double time_s, const Vec3& place, const Mat3& rotation, double opening_rad) {
  return {time_s, pose_of(rotation, place), opening_rad};
}

Tool add_tool(World& world, const RigidShape& shape, const HandleCoupling& coupling,
              const Vec3& place) {
  ToolDescription tool;
  tool.name = "tool";
  tool.pose = pose_of(Mat3::Identity(), place);
  tool.jaws.resize(1);
  tool.jaws[0].shape = shape;
  tool.jaws[0].coupling = coupling;
  return created(world, tool);
}

Tool add_forceps(World& world, const HandleCoupling& coupling, const Vec3& place, double opening_rad) {
  ToolDescription tool;
  tool.name = "forceps";
  tool.pose = pose_of(Mat3::Identity(), place);
  tool.opening_rad = opening_rad;
  for (const double side : {1.0, -1.0}) {
    JawDescription jaw;
    jaw.shape = box_shape({0.02, 0.003, 0.02});
    jaw.mount = pose_of(Mat3::Identity(), {0.1, side * 0.003, 0});
    jaw.axis = {0, 0, 1};
    jaw.turn_per_opening = 0.5 * side;
    jaw.coupling = coupling;
    tool.jaws.push_back(jaw);
  }
  return created(world, tool);
}

HapticSettings patient_settings() {
  HapticSettings settings;
  settings.tick_budget_s = std::numeric_limits<double>::infinity();
  settings.residual_goal = 1e-5;
  settings.max_sweeps = 20000;
  settings.hand_over_s = 1e-9;
  settings.reach_m = 10;
  return settings;
}

HapticChannel make_channel(Tool tool, const HapticSettings& settings) {
  auto channel = HapticChannel::create(std::move(tool), settings);
  EXPECT_TRUE(channel.ok()) << (channel.ok() ? "" : format_issue(channel.issue()));
  return std::move(*channel);
}

StepReport physics_step(World& world, HapticChannel& channel) {
  expect_ok(channel.begin_step(world));
  const StepReport report = step(world);
  expect_ok(channel.publish(world));
  return report;
}

Vec3 force_of(const Wrench& wrench) { return as_vec3(wrench.force_n); }
Vec3 torque_of(const Wrench& wrench) { return as_vec3(wrench.torque_nm); }

}  // namespace souple::test
