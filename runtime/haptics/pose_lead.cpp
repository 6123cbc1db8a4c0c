// SPDX-License-Identifier: MIT
#include "runtime/haptics/pose_lead.hpp"

#include <algorithm>

#include "runtime/collision/rigid_distance.hpp"
#include "runtime/fem/linear_algebra.hpp"
#include "runtime/world/rigid_path.hpp"

namespace souple {
namespace {

// The longest time over which samples tell a speed of now, s.
constexpr double longest_memory_s = 0.05;

}  // namespace

void PoseLead::add(const DeviceSample& sample) {
  newest_ = (newest_ + 1) % window;
  samples_[newest_] = sample;
  count_ = std::min(count_ + 1, window);
}

DeviceSample PoseLead::ahead() const {
  const DeviceSample& to = samples_[newest_];
  if (!(lead_s_ > 0) || count_ < 2) return to;
  const DeviceSample& from = samples_[(newest_ + window + 1 - count_) % window];
  const double passed = to.time_s - from.time_s;
  if (!(passed > 0) || passed > longest_memory_s) return to;
  const double share = lead_s_ / passed;
  const RigidPlacement a = placement(from.pose), b = placement(to.pose);
  const Eigen::AngleAxisd turn(Mat3(b.rotation * a.rotation.transpose()));
  const Mat3 rotation = Eigen::AngleAxisd(share * turn.angle(), turn.axis()) * b.rotation;
  const Eigen::Quaterniond q(rotation);
  DeviceSample ahead = to;
  ahead.pose.translation = as_point(b.translation + share * (b.translation - a.translation));
  ahead.pose.rotation = {q.w(), q.x(), q.y(), q.z()};
  ahead.opening_rad =
      std::clamp(to.opening_rad + share * (to.opening_rad - from.opening_rad), -M_PI, M_PI);
  return ahead;
}

}  // namespace souple
