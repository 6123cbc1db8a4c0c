// SPDX-License-Identifier: MIT
#include "runtime/haptics/sample_guard.hpp"

#include <algorithm>
#include <cmath>

#include "formats/core/mesh.hpp"
#include "runtime/fem/linear_algebra.hpp"

namespace souple {
namespace {

// However long a device was silent, its handle has not gone farther than in this time at full speed.
constexpr double longest_course_s = 0.02;

// A metre is farther than any sample is believed from the one before; places are within a kilometre.
constexpr double farthest_m = 1e3;

Eigen::Vector4d as_vec4(const Pose& pose) { return Eigen::Vector4d::Map(pose.rotation.data()); }

bool is_finite(const DeviceSample& s) {
  const Eigen::Vector4d q = as_vec4(s.pose);
  return std::isfinite(s.time_s) && std::abs(s.opening_rad) <= M_PI && q.allFinite() &&
         std::abs(q.norm() - 1) < 0.01 && as_vec3(s.pose.translation).allFinite() &&
         as_vec3(s.pose.translation).norm() < farthest_m;
}

DeviceSample normalised(DeviceSample sample) {
  Eigen::Vector4d::Map(sample.pose.rotation.data()).normalize();
  return sample;
}

}  // namespace

// A device may stamp its samples unevenly; it never moves less than in a tick.
double SampleGuard::course(const DeviceSample& from, const DeviceSample& to) const {
  const double tick = std::min(1 / settings_.limits.rate_hz, longest_course_s);
  return std::clamp(to.time_s - from.time_s, tick, longest_course_s);
}

SampleGuard::Verdict SampleGuard::compare(const DeviceSample& from, const DeviceSample& to) const {
  if (!(to.time_s > from.time_s)) return Verdict::clock;
  const double time = course(from, to);
  const double way = (as_vec3(to.pose.translation) - as_vec3(from.pose.translation)).norm();
  const double cosine = std::min(1.0, std::abs(as_vec4(from.pose).dot(as_vec4(to.pose))));
  const double turn = std::max(2 * std::acos(cosine), std::abs(to.opening_rad - from.opening_rad));
  const bool credible =
      way <= settings_.credible_speed_m_s * time && turn <= settings_.credible_turn_rad_s * time;
  return credible ? Verdict::good : Verdict::jump;
}

// What is refused again and again, but agrees with itself, is where the device is.
SampleGuard::Verdict SampleGuard::refuse(const DeviceSample& sample, Verdict verdict) {
  const bool agrees = has_refused_ && compare(refused_, sample) == Verdict::good;
  agreed_s_ = agrees ? agreed_s_ + course(refused_, sample) : 0;
  refused_ = sample;
  has_refused_ = true;
  if (agreed_s_ < settings_.recover_after_s) return verdict;
  sample_ = sample;
  has_refused_ = false;
  return Verdict::recovered;
}

SampleGuard::Verdict SampleGuard::look_at(const DeviceSample& raw) {
  if (!is_finite(raw)) return Verdict::not_finite;
  const DeviceSample sample = normalised(raw);
  if (has_sample_)
    if (const Verdict verdict = compare(sample_, sample); verdict != Verdict::good)
      return refuse(sample, verdict);
  sample_ = sample;
  has_sample_ = true;
  has_refused_ = false;
  return Verdict::good;
}

}  // namespace souple
