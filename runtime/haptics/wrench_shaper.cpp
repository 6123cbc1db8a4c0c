// SPDX-License-Identifier: MIT
#include "runtime/haptics/wrench_shaper.hpp"

#include <algorithm>
#include <cmath>

#include "formats/core/mesh.hpp"
#include "runtime/fem/linear_algebra.hpp"

namespace souple {
namespace {

// a x + b y
Wrench combine(double a, const Wrench& x, double b, const Wrench& y) {
  Wrench sum;
  for (std::size_t k = 0; k < 3; ++k) {
    sum.force_n[k] = a * x.force_n[k] + b * y.force_n[k];
    sum.torque_nm[k] = a * x.torque_nm[k] + b * y.torque_nm[k];
  }
  sum.opening_nm = a * x.opening_nm + b * y.opening_nm;
  return sum;
}

// Forces are remembered for so long.
constexpr double memory_s = 10;

// What rounding leaves of a share that has faded.
constexpr double nothing = 1e-9;

double norm2(const Wrench& w) {
  return as_vec3(w.force_n).squaredNorm() + as_vec3(w.torque_nm).squaredNorm() +
         w.opening_nm * w.opening_nm;
}

// Within `most` of `from`; whether it had to be cut.
bool cut(Vec3& value, const Vec3& from, double most) {
  const double length = (value - from).norm();
  if (!(length > most)) return false;
  value = from + (most / length) * (value - from);
  return true;
}

}  // namespace

void WrenchShaper::hand_over(double fade_s) {
  takes_over_ = true;
  next_fade_s_ = std::max(fade_s, left_ * fade_s_);
}

void WrenchShaper::begin_anew(double fade_s) {
  hand_over(fade_s);
  begins_ = true;
  share_ = 0;
}

Wrench WrenchShaper::shape(const Wrench& lawful, double passed_s, bool alive) {
  // In free motion nothing changes, and what fades goes on to fade until it is nothing.
  const bool is_zero = norm2(lawful) == 0;
  const bool takes_over = takes_over_ && !(is_zero && was_zero_);
  takes_over_ = false;
  was_zero_ = is_zero;
  if (takes_over) {
    difference_ = combine(1, last_, -share_, lawful);
    left_ = 1;
    fade_s_ = next_fade_s_;
  } else {
    const double step = passed_s / settings_.fade_s;
    share_ = std::clamp(share_ + (alive ? step : -step), 0.0, 1.0);
    fade(passed_s);
  }
  last_ = left_ > 0 ? combine(share_, lawful, left_, difference_) : combine(share_, lawful, 0, {});
  range_ = std::max(range_ * std::exp(-passed_s / memory_s), as_vec3(last_.force_n).norm());
  sent_ = limit(last_, passed_s);
  return sent_;
}

// In equal parts of the whole time, or sooner where the steps are small beside the forces of late.
void WrenchShaper::fade(double passed_s) {
  const double force = as_vec3(difference_.force_n).norm();
  double part = fade_s_ > 0 ? passed_s / fade_s_ : 1;
  if (!begins_ && force > 0) part = std::max(part, settings_.hand_over_share * range_ / force);
  left_ = std::max(0.0, left_ - part);
  if (left_ < nothing) {
    left_ = 0;
    begins_ = false;
  }
}

// What was sent last counts as within them: the slew would else hold the force beyond.
void WrenchShaper::set_limits(const DeviceLimits& limits) {
  settings_.limits = limits;
  Vec3 force = as_vec3(sent_.force_n), torque = as_vec3(sent_.torque_nm);
  cut(force, Vec3::Zero(), limits.force_n);
  cut(torque, Vec3::Zero(), limits.torque_nm);
  sent_.force_n = as_point(force);
  sent_.torque_nm = as_point(torque);
}

// Largest values first, then the slew: what it leaves lies between two wrenches within the limits.
Wrench WrenchShaper::limit(const Wrench& wrench, double passed_s) {
  const DeviceLimits& most = settings_.limits;
  Vec3 force = as_vec3(wrench.force_n), torque = as_vec3(wrench.torque_nm);
  bool limited = cut(force, Vec3::Zero(), most.force_n);
  limited |= cut(torque, Vec3::Zero(), most.torque_nm);
  limited |= cut(force, as_vec3(sent_.force_n), most.force_slew_n_s * passed_s);
  limited |= cut(torque, as_vec3(sent_.torque_nm), most.torque_slew_nm_s * passed_s);
  const double opening = std::clamp(wrench.opening_nm, -most.opening_nm, most.opening_nm);
  was_limited_ = limited || opening != wrench.opening_nm;
  return {as_point(force), as_point(torque), opening};
}

}  // namespace souple
