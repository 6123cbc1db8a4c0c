// SPDX-License-Identifier: MIT
// What a haptic device says and is told: poses in, wrenches out, and the limits it declares.
#pragma once
#include <cstdint>
#include <limits>

#include "formats/core/mesh.hpp"
#include "runtime/world/settings.hpp"

namespace souple {

/// What a device measured at one instant, in the world's frame and units.
struct DeviceSample {
  double time_s = 0;       ///< of the device's own clock, which never goes back
  Pose pose;               ///< of the handle
  double opening_rad = 0;  ///< of a gripper, between its jaws; 0 of a device that has none
};

/// What the hand is to feel. The torque is about the handle's origin.
struct Wrench {
  Point force_n{};        ///< on the hand, world axes
  Point torque_nm{};      ///< on the hand, world axes
  double opening_nm = 0;  ///< opens the jaws where positive
};

/// What a device can do, as it declares it. Unlimited unless said.
struct DeviceLimits {
  double rate_hz = 1000;  ///< how often it wants a wrench
  double force_n = std::numeric_limits<double>::infinity();
  double torque_nm = std::numeric_limits<double>::infinity();
  double opening_nm = std::numeric_limits<double>::infinity();
  double force_slew_n_s = std::numeric_limits<double>::infinity();
  double torque_slew_nm_s = std::numeric_limits<double>::infinity();
  bool has_opening = false;
};

/// A haptic device. `read` and `write` are called from the haptic thread once a tick, and must neither
/// block, nor allocate, nor throw.
class HapticDevice {
 public:
  virtual ~HapticDevice() = default;
  virtual DeviceLimits limits() const = 0;
  /// The newest sample; false if there is none that is new, `sample` being unchanged.
  virtual bool read(DeviceSample& sample) = 0;
  virtual void write(const Wrench& wrench) = 0;
};

}  // namespace souple
