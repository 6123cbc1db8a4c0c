// SPDX-License-Identifier: MIT
#pragma once
#include "runtime/haptics/haptic_settings.hpp"

namespace souple {

/// From what the laws say to what the device is told: no step when a problem takes over from another,
/// no force from physics that is dead, nothing beyond what the device declares.
class WrenchShaper {
 public:
  explicit WrenchShaper(const HapticSettings& settings) : settings_(settings) {}

  /// At the next wrench the force goes on from the last one; the difference to what the laws then say
  /// fades within `fade_s`, or what is left of the fade before if that is longer.
  void hand_over(double fade_s);
  /// The laws begin anew somewhere else: their force comes up from zero.
  void begin_anew(double fade_s);

  /// A tick of `passed_s` later. `alive`: physics still publishes.
  Wrench shape(const Wrench& lawful, double passed_s, bool alive);

  /// From the next wrench on.
  void set_limits(const DeviceLimits& limits);

  bool was_limited() const { return was_limited_; }

 private:
  void fade(double passed_s);
  Wrench limit(const Wrench& wrench, double passed_s);

  HapticSettings settings_;
  Wrench last_, difference_, sent_;
  bool takes_over_ = false, was_zero_ = true, was_limited_ = false;
  bool begins_ = false;  ///< from zero: then the whole time is taken
  double next_fade_s_ = 0;
  double range_ = 0;              ///< largest force of late, N
  double share_ = 1;              ///< of the lawful wrench
  double left_ = 0, fade_s_ = 0;  ///< of the difference
};

}  // namespace souple
