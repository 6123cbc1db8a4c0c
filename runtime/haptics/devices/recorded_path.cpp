// SPDX-License-Identifier: MIT
#include "runtime/haptics/devices/recorded_path.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "runtime/haptics/devices/turns.hpp"

namespace souple {
namespace {

constexpr double farthest_m = 1e3, latest_s = 1e9;

Status check_sample(const DeviceSample& sample, std::size_t number) {
  const std::string where = "sample " + std::to_string(number);
  const auto bad = [&](const char* what) {
    return make_issue(IssueCode::hand_path_bad_value, what, where);
  };
  if (!(std::abs(sample.time_s) <= latest_s)) return bad("the time is not within 1e9 s");
  for (const double x : sample.pose.translation)
    if (!(std::abs(x) <= farthest_m)) return bad("the place is not within 1000 m");
  const double length = quaternion_of(sample.pose).norm();
  if (!(std::abs(length - 1) < 0.01)) return bad("the quaternion is not of unit length");
  if (!(std::abs(sample.opening_rad) <= 2 * M_PI)) return bad("the opening is not within a turn");
  return {};
}

}  // namespace

Result<RecordedPath> RecordedPath::create(std::vector<DeviceSample> samples) {
  if (samples.empty()) return make_issue(IssueCode::hand_path_malformed, "the path has no samples");
  if (samples.size() > sample_limit)
    return make_issue(IssueCode::hand_path_too_large, "the path has " + std::to_string(samples.size()) +
                                                          " samples, more than " +
                                                          std::to_string(sample_limit));
  for (std::size_t k = 0; k < samples.size(); ++k) {
    if (Status status = check_sample(samples[k], k); !status) return status.issue();
    if (k > 0 && !(samples[k].time_s > samples[k - 1].time_s))
      return make_issue(IssueCode::hand_path_bad_time,
                        std::to_string(samples[k].time_s) + " s after " +
                            std::to_string(samples[k - 1].time_s) + " s",
                        "sample " + std::to_string(k));
    set_rotation(samples[k].pose, quaternion_of(samples[k].pose).normalized());
  }
  return RecordedPath(std::move(samples));
}

DeviceSample RecordedPath::at(double time_s) const {
  const auto after =
      std::upper_bound(samples_.begin(), samples_.end(), time_s,
                       [](double time, const DeviceSample& sample) { return time < sample.time_s; });
  DeviceSample sample = after == samples_.begin() ? samples_.front() : *(after - 1);
  if (after != samples_.begin() && after != samples_.end()) {
    const DeviceSample& next = *after;
    const double share = (time_s - sample.time_s) / (next.time_s - sample.time_s);
    for (std::size_t k = 0; k < 3; ++k)
      sample.pose.translation[k] += share * (next.pose.translation[k] - sample.pose.translation[k]);
    set_rotation(sample.pose,
                 quaternion_of(sample.pose).slerp(share, quaternion_of(next.pose)).normalized());
    sample.opening_rad += share * (next.opening_rad - sample.opening_rad);
  }
  sample.time_s = time_s;
  return sample;
}

Result<RecordedPathDevice> RecordedPathDevice::create(RecordedPath path, const DeviceLimits& limits) {
  if (!(limits.rate_hz > 0 && limits.rate_hz <= 1e6))
    return make_issue(IssueCode::hand_path_bad_value,
                      "a rate of " + std::to_string(limits.rate_hz) + " Hz is not within (0, 1e6]");
  return RecordedPathDevice(std::move(path), limits);
}

double RecordedPathDevice::next_time_s() const {
  return path_.begin_s() + double(ticks_) / limits_.rate_hz;
}

bool RecordedPathDevice::read(DeviceSample& sample) {
  sample = path_.at(next_time_s());
  ++ticks_;
  return true;
}

bool RecordedPathDevice::finished() const { return next_time_s() > path_.end_s(); }

}  // namespace souple
