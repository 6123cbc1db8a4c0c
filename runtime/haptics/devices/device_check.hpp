// SPDX-License-Identifier: MIT
// Whether a device keeps to its interface: what its samples say of themselves and of their times.
#pragma once
#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

#include "runtime/haptics/device.hpp"

namespace souple {

struct DeviceCheckSettings {
  double rate_share = 0.02;       ///< by which the measured rate may miss the declared one
  double largest_gap_ticks = 10;  ///< between two samples that arrive
  double clock_share = 0.01;      ///< by which the device's clock may run fast or slow
  double largest_speed_m_s = 10, largest_turn_rad_s = 100;
  double largest_latency_ticks = 3;  ///< at the 99th of a hundred, if the device tells what it answers
  double least_samples = 100;
};

struct DeviceVerdict {
  std::string_view check;
  bool passed = false;
  double value = 0, bound = 0;
  std::string_view unit;
};

/// Is shown what a device does, and judges. Allocates in `judge` alone.
class DeviceCheck {
 public:
  explicit DeviceCheck(const DeviceLimits& limits, const DeviceCheckSettings& settings = {})
      : limits_(limits), settings_(settings) {}

  /// A sample that arrived at this time of the observer's clock.
  void saw_sample(double now_s, const DeviceSample& sample);
  /// A wrench that was sent to the device.
  void saw_wrench(const Wrench& wrench);
  /// From sending a wrench until a sample came that tells of it.
  void saw_answer(double latency_s);

  std::uint64_t sample_count() const { return samples_; }
  /// One for each check; those about answers only if there were some.
  std::vector<DeviceVerdict> judge() const;

 private:
  static constexpr std::size_t latency_bins = 1000;
  static constexpr double latency_bin_s = 1e-4;
  double latency_quantile(double share) const;

  DeviceLimits limits_;
  DeviceCheckSettings settings_;
  std::uint64_t samples_ = 0, refused_ = 0, clock_faults_ = 0, answers_ = 0, wrenches_over_ = 0;
  double first_s_ = 0, last_s_ = 0, longest_gap_s_ = 0;
  double largest_speed_ = 0, largest_turn_ = 0;
  DeviceSample first_, last_;
  std::array<std::uint64_t, latency_bins> latency_{};  ///< the last bin holds all above
};

}  // namespace souple
