// SPDX-License-Identifier: MIT
#include "runtime/haptics/devices/device_check.hpp"

#include <algorithm>
#include <cmath>

#include "runtime/haptics/devices/turns.hpp"

namespace souple {
namespace {

bool is_sound(const DeviceSample& s) {
  return std::isfinite(s.time_s) && std::abs(s.opening_rad) <= M_PI &&
         as_vec3(s.pose.translation).allFinite() && std::abs(quaternion_of(s.pose).norm() - 1) < 1e-3;
}

bool is_within(const Wrench& w, const DeviceLimits& limits) {
  constexpr double rounding = 1 + 1e-9;
  return as_vec3(w.force_n).norm() <= limits.force_n * rounding &&
         as_vec3(w.torque_nm).norm() <= limits.torque_nm * rounding &&
         std::abs(w.opening_nm) <= limits.opening_nm * rounding;
}

}  // namespace

void DeviceCheck::saw_sample(double now_s, const DeviceSample& sample) {
  if (!is_sound(sample)) {
    ++refused_;
    return;
  }
  if (samples_ == 0) {
    first_ = sample;
    first_s_ = now_s;
  } else {
    longest_gap_s_ = std::max(longest_gap_s_, now_s - last_s_);
    const double passed = sample.time_s - last_.time_s;
    if (passed > 0) {
      const Vec3 way = as_vec3(sample.pose.translation) - as_vec3(last_.pose.translation);
      const Vec3 turn =
          rotation_vector(quaternion_of(sample.pose) * quaternion_of(last_.pose).conjugate());
      largest_speed_ = std::max(largest_speed_, way.norm() / passed);
      largest_turn_ = std::max(largest_turn_, turn.norm() / passed);
    } else {
      ++clock_faults_;
    }
  }
  last_ = sample;
  last_s_ = now_s;
  ++samples_;
}

void DeviceCheck::saw_wrench(const Wrench& wrench) {
  if (!is_within(wrench, limits_)) ++wrenches_over_;
}

void DeviceCheck::saw_answer(double latency_s) {
  const double bin = std::clamp(latency_s / latency_bin_s, 0.0, double(latency_bins - 1));
  ++latency_[std::size_t(bin)];
  ++answers_;
}

double DeviceCheck::latency_quantile(double share) const {
  std::uint64_t below = 0;
  for (std::size_t bin = 0; bin < latency_bins; ++bin) {
    below += latency_[bin];
    if (double(below) >= share * double(answers_)) return double(bin + 1) * latency_bin_s;
  }
  return double(latency_bins) * latency_bin_s;
}

std::vector<DeviceVerdict> DeviceCheck::judge() const {
  std::vector<DeviceVerdict> verdicts;
  const auto at_most = [&](std::string_view check, double value, double bound, std::string_view unit) {
    verdicts.push_back({check, value <= bound, value, bound, unit});
  };
  const double count = double(samples_), passed = last_s_ - first_s_;
  verdicts.push_back({"samples", count >= settings_.least_samples, count, settings_.least_samples, ""});
  at_most("samples_refused", double(refused_), 0, "");
  at_most("clock_faults", double(clock_faults_), 0, "");
  if (samples_ < 2 || !(passed > 0)) return verdicts;
  const double rate = (count - 1) / passed;
  at_most("rate_error", std::abs(rate / limits_.rate_hz - 1), settings_.rate_share, "");
  at_most("longest_gap", longest_gap_s_, settings_.largest_gap_ticks / limits_.rate_hz, "s");
  at_most("clock_error", std::abs((last_.time_s - first_.time_s) / passed - 1), settings_.clock_share,
          "");
  at_most("speed", largest_speed_, settings_.largest_speed_m_s, "m/s");
  at_most("turn_speed", largest_turn_, settings_.largest_turn_rad_s, "rad/s");
  at_most("wrenches_beyond_limits", double(wrenches_over_), 0, "");
  if (answers_ > 0)
    at_most("latency_p99", latency_quantile(0.99), settings_.largest_latency_ticks / limits_.rate_hz,
            "s");
  return verdicts;
}

}  // namespace souple
