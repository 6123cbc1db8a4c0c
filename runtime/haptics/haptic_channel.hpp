// SPDX-License-Identifier: MIT
#pragma once
#include <memory>

#include "formats/core/result.hpp"
#include "runtime/haptics/device.hpp"
#include "runtime/haptics/haptic_settings.hpp"
#include "runtime/haptics/telemetry.hpp"
#include "runtime/haptics/tool.hpp"
#include "runtime/world/world.hpp"

namespace souple {

/// Between a world that steps at its own rate and a hand that wants forces at another (METHOD 5). One
/// thread steps the world, another one ticks; neither ever waits for the other, nor allocates.
///
///   physics thread                            haptic thread
///     channel.begin_step(world);                device.read(sample) ? wrench = channel.tick(sample)
///     world.step();                                                  : wrench = channel.tick();
///     channel.publish(world);                   device.write(wrench);
class HapticChannel {
 public:
  /// Issue world_parameter_invalid.
  static Result<HapticChannel> create(Tool tool, const HapticSettings& settings);
  HapticChannel(HapticChannel&&) noexcept;
  HapticChannel& operator=(HapticChannel&&) noexcept;
  ~HapticChannel();

  const Tool& tool() const;
  const HapticSettings& settings() const;

  // Physics thread.

  /// Moves the tool to the newest pose that the haptic thread believed; before the first one it stays.
  Status begin_step(World& world);
  /// The newest sample that the haptic thread believed; false before the first one.
  bool newest_sample(DeviceSample& sample);
  /// Makes the problem of the world's last step the one that ticks solve. Issue
  /// world_parameter_invalid: the tool is not of this world.
  Status publish(const World& world);

  // Haptic thread.

  /// What the hand feels with the device there: the newest published problem solved with the tool moved
  /// to this pose (METHOD Alg. 15). Exactly zero in free motion.
  Wrench tick(const DeviceSample& sample);
  /// The device has nothing new: the same at the last pose that was believed, a tick later.
  Wrench tick();
  /// What the device declares from now on; the rate stays that of the settings. A limit that is no
  /// number or below zero is taken for zero.
  void set_limits(const DeviceLimits& limits);
  /// Of the last tick, before limits, hand-over and fading: what the laws alone say.
  Wrench lawful_wrench() const;
  /// Residual of the laws after the last tick (natural map over the norm of the forces).
  double residual() const;

  // Any thread.

  /// A copy of counters that may be a tick apart from each other.
  HapticTelemetry telemetry() const;

 private:
  struct State;
  explicit HapticChannel(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace souple
