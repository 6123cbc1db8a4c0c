// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <cstddef>

#include "runtime/haptics/device.hpp"

namespace souple {

/// Where a handle will be a little later if it goes on as it went of late. A spring that is late by t
/// pushes a moving hand as a damping of -k t would; looking ahead by t takes that away.
class PoseLead {
 public:
  explicit PoseLead(double lead_s) : lead_s_(lead_s) {}

  /// A believed sample, later than the one before.
  void add(const DeviceSample& sample);
  /// The handle is somewhere else: what it did before says nothing.
  void restart() { count_ = 0; }
  /// The newest sample, `lead_s` later. Only after add().
  DeviceSample ahead() const;

 private:
  // Of the speed. Fewer: the steps of an encoder show in it; more: it is that of a while ago.
  static constexpr std::size_t window = 5;

  double lead_s_;
  std::array<DeviceSample, window> samples_;
  std::size_t newest_ = 0, count_ = 0;
};

}  // namespace souple
