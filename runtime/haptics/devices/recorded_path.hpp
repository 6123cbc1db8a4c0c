// SPDX-License-Identifier: MIT
#pragma once
#include <vector>

#include "formats/core/result.hpp"
#include "runtime/haptics/device.hpp"

namespace souple {

/// Where a hand was: linear between samples, turns slerped, held before the first and after the last.
class RecordedPath {
 public:
  static constexpr std::size_t sample_limit = 10'000'000;

  /// At least one sample, ascending finite times, finite places within a kilometre, quaternions of
  /// about unit length, openings within a turn. Issues: hand_path_malformed (none),
  /// hand_path_too_large, hand_path_bad_value, hand_path_bad_time.
  static Result<RecordedPath> create(std::vector<DeviceSample> samples);

  DeviceSample at(double time_s) const;
  double begin_s() const { return samples_.front().time_s; }
  double end_s() const { return samples_.back().time_s; }
  std::size_t sample_count() const { return samples_.size(); }

 private:
  explicit RecordedPath(std::vector<DeviceSample> samples) : samples_(std::move(samples)) {}
  std::vector<DeviceSample> samples_;
};

/// Plays a path at the rate of its limits from the path's beginning, one sample a tick, and feels
/// nothing. Beyond the end it goes on giving the last pose, with times that go on.
class RecordedPathDevice final : public HapticDevice {
 public:
  /// Issue hand_path_bad_value: the rate of the limits is not within (0, 1e6].
  static Result<RecordedPathDevice> create(RecordedPath path, const DeviceLimits& limits);

  DeviceLimits limits() const override { return limits_; }
  bool read(DeviceSample& sample) override;
  void write(const Wrench& wrench) override { last_wrench_ = wrench; }

  bool finished() const;
  const Wrench& last_wrench() const { return last_wrench_; }

 private:
  RecordedPathDevice(RecordedPath path, const DeviceLimits& limits)
      : path_(std::move(path)), limits_(limits) {}
  double next_time_s() const;

  RecordedPath path_;
  DeviceLimits limits_;
  Wrench last_wrench_;
  std::uint64_t ticks_ = 0;
};

}  // namespace souple
