// SPDX-License-Identifier: MIT
// Tools and channels for small haptic scenes.
#pragma once
#include "runtime/haptics/haptic_channel.hpp"
#include "tests/support/rigid_scenes.hpp"

namespace souple::test {

/// Where the hand is at a time.
DeviceSample sample_at(double time_s, const Vec3& place, const Mat3& rotation = Mat3::Identity(),
                       double opening_rad = 0);

/// One rigid jaw, its shape at the handle.
Tool add_tool(World& world, const RigidShape& shape, const HandleCoupling& coupling, const Vec3& place);

/// Two flat jaws of 4 cm x 6 mm x 4 cm that close along y, their middles 10 cm in front (+x) of the
/// handle, where the hinge is; they touch where the opening is 0.
Tool add_forceps(World& world, const HandleCoupling& coupling, const Vec3& place, double opening_rad);

/// Unlimited time, a fine goal, one tick a millisecond, no hand-over and no reach to mind.
HapticSettings patient_settings();

/// A channel; fails the test if it is refused.
HapticChannel make_channel(Tool tool, const HapticSettings& settings);

/// begin_step, step, publish; fails the test if one of them does.
StepReport physics_step(World& world, HapticChannel& channel);

Vec3 force_of(const Wrench& wrench);
Vec3 torque_of(const Wrench& wrench);

}  // namespace souple::test
