// SPDX-License-Identifier: MIT
#pragma once
#include <cstdint>

#include "runtime/haptics/haptic_settings.hpp"

namespace souple {

/// Believes what a hand can have done, and holds the last good sample against everything else.
class SampleGuard {
 public:
  enum class Verdict : std::uint8_t {
    good,
    recovered,  ///< good, and far from the last good one: the force has to begin anew
    not_finite,
    jump,
    clock,
  };

  explicit SampleGuard(const HapticSettings& settings) : settings_(settings) {}
  Verdict look_at(const DeviceSample& sample);

  bool has_sample() const { return has_sample_; }
  /// The last one that was believed, its rotation of unit length.
  const DeviceSample& sample() const { return sample_; }

 private:
  double course(const DeviceSample& from, const DeviceSample& to) const;
  Verdict compare(const DeviceSample& from, const DeviceSample& to) const;
  Verdict refuse(const DeviceSample& sample, Verdict verdict);

  HapticSettings settings_;
  DeviceSample sample_, refused_;
  bool has_sample_ = false, has_refused_ = false;
  double agreed_s_ = 0;  ///< how long the refused samples have agreed with each other
};

}  // namespace souple
