// SPDX-License-Identifier: MIT
#include "runtime/haptics/devices/synthetic_hand.hpp"

#include <algorithm>
#include <cmath>

#include "runtime/haptics/devices/turns.hpp"

namespace souple {
namespace {

double to_grid(double value, double resolution) {
  return resolution > 0 ? std::round(value / resolution) * resolution : value;
}

Vec3 cut(const Vec3& value, double largest) {
  const double size = value.norm();
  return size > largest ? Vec3(value * (largest / size)) : value;
}

bool is_finite(const Wrench& w) {
  return as_vec3(w.force_n).allFinite() && as_vec3(w.torque_nm).allFinite() &&
         std::isfinite(w.opening_nm);
}

HeldMass held(double mass, double own_damping, double stiffness) {
  constexpr double damping_ratio = 0.3;
  return {mass, own_damping, 2 * damping_ratio * std::sqrt(stiffness * mass), stiffness};
}

}  // namespace

HandModel hand_of_grip(double grip) {
  const double stiffness = 20 * std::pow(75.0, std::clamp(grip, 0.0, 1.0));  // N/m
  constexpr double lever2 = 0.03 * 0.03;  // m^2: the hand holds a stylus with fingers about 3 cm apart
  HandModel model;
  model.move = held(0.08, 0.1, stiffness);
  model.turn = held(0.08 * lever2, 0.1 * lever2, stiffness * lever2);
  model.opening = model.turn;
  return model;
}

SyntheticHand::SyntheticHand(RecordedPath wish, const SyntheticHandSettings& settings,
                             const HeldMassStep& move, const HeldMassStep& turn,
                             const HeldMassStep& opening)
    : wish_(std::move(wish)), settings_(settings), move_(move), turn_(turn), opening_(opening) {
  truth_ = wish_.at(wish_.begin_s());
  start_ = truth_.pose;
  measured_.resize(settings_.delay_samples + 1);
  for (std::size_t k = 0; k < measured_.size(); ++k) {
    measured_[k] = measured();
    measured_[k].time_s -= double((measured_.size() - k) % measured_.size()) / settings_.limits.rate_hz;
  }
}

Result<SyntheticHand> SyntheticHand::create(RecordedPath wish, const SyntheticHandSettings& settings) {
  const auto bad = [](const char* what) {
    return make_issue(IssueCode::world_parameter_invalid, what);
  };
  const double rate = settings.limits.rate_hz;
  if (!(rate >= 1 && rate <= 1e6)) return bad("the rate of a hand is not within [1, 1e6] Hz");
  for (const double r :
       {settings.resolution_m, settings.turn_resolution_rad, settings.opening_resolution_rad})
    if (!(r >= 0 && r <= 1)) return bad("the resolution of an encoder is not within [0, 1]");
  if (settings.delay_samples > delay_limit) return bad("a hand is delayed by more than 1000 samples");
  const Result<HeldMassStep> move = HeldMassStep::create(settings.model.move, 1 / rate);
  if (!move) return move.issue();
  const Result<HeldMassStep> turn = HeldMassStep::create(settings.model.turn, 1 / rate);
  if (!turn) return turn.issue();
  const Result<HeldMassStep> opening = HeldMassStep::create(settings.model.opening, 1 / rate);
  if (!opening) return opening.issue();
  return SyntheticHand(std::move(wish), settings, *move, *turn, *opening);
}

DeviceSample SyntheticHand::measured() const {
  DeviceSample sample = truth_;
  for (double& x : sample.pose.translation) x = to_grid(x, settings_.resolution_m);
  if (settings_.turn_resolution_rad > 0) {
    const Eigen::Quaterniond start = quaternion_of(start_);
    Vec3 turn = rotation_vector(quaternion_of(truth_.pose) * start.conjugate());
    for (double& x : turn) x = to_grid(x, settings_.turn_resolution_rad);
    set_rotation(sample.pose, (turn_by(turn) * start).normalized());
  }
  sample.opening_rad = to_grid(sample.opening_rad, settings_.opening_resolution_rad);
  return sample;
}

bool SyntheticHand::read(DeviceSample& sample) {
  if (!has_new_) return false;
  has_new_ = false;
  // The slot after the newest one is the oldest.
  sample = measured_[(ticks_ + 1) % measured_.size()];
  return true;
}

Wrench SyntheticHand::by_motor(const Wrench& wrench) {
  if (!is_finite(wrench)) {
    ++refused_wrenches_;
    return {};
  }
  Wrench cut_wrench;
  as_vec3(cut_wrench.force_n) = cut(as_vec3(wrench.force_n), settings_.limits.force_n);
  as_vec3(cut_wrench.torque_nm) = cut(as_vec3(wrench.torque_nm), settings_.limits.torque_nm);
  cut_wrench.opening_nm =
      std::clamp(wrench.opening_nm, -settings_.limits.opening_nm, settings_.limits.opening_nm);
  return cut_wrench;
}

void SyntheticHand::write(const Wrench& wrench) {
  const Wrench felt = by_motor(wrench);
  const double tick_s = 1 / settings_.limits.rate_hz;
  const DeviceSample from = wish_.at(wish_.begin_s() + double(ticks_) * tick_s);
  const DeviceSample to = wish_.at(wish_.begin_s() + double(ticks_ + 1) * tick_s);
  advance_place(from, to, tick_s, as_vec3(felt.force_n));
  advance_turn(from, to, tick_s, as_vec3(felt.torque_nm));
  advance_opening(from, to, tick_s, felt.opening_nm);
  truth_.time_s = to.time_s;
  ++ticks_;
  measured_[ticks_ % measured_.size()] = measured();
  has_new_ = true;
}

void SyntheticHand::advance_place(const DeviceSample& from, const DeviceSample& to, double tick_s,
                                  const Vec3& force) {
  const Vec3 wish = as_vec3(from.pose.translation), next_wish = as_vec3(to.pose.translation);
  const Vec3 before = as_vec3(truth_.pose.translation), wish_rate = (next_wish - wish) / tick_s;
  Vec3 offset = before - wish, rate = velocity_ - wish_rate;
  move_.advance(offset, rate, wish_rate, force);
  velocity_ = rate + wish_rate;
  as_vec3(truth_.pose.translation) = next_wish + offset;
  received_j_ += force.dot(as_vec3(truth_.pose.translation) - before);
}

void SyntheticHand::advance_turn(const DeviceSample& from, const DeviceSample& to, double tick_s,
                                 const Vec3& torque) {
  const Eigen::Quaterniond wish = quaternion_of(from.pose), next_wish = quaternion_of(to.pose);
  const Eigen::Quaterniond before = quaternion_of(truth_.pose);
  const Vec3 wish_rate = rotation_vector(next_wish * wish.conjugate()) / tick_s;
  Vec3 offset = rotation_vector(before * wish.conjugate()), rate = spin_ - wish_rate;
  turn_.advance(offset, rate, wish_rate, torque);
  spin_ = rate + wish_rate;
  const Eigen::Quaterniond after = (turn_by(offset) * next_wish).normalized();
  set_rotation(truth_.pose, after);
  received_j_ += torque.dot(rotation_vector(after * before.conjugate()));
}

void SyntheticHand::advance_opening(const DeviceSample& from, const DeviceSample& to, double tick_s,
                                    double torque) {
  const double wish_rate = (to.opening_rad - from.opening_rad) / tick_s, before = truth_.opening_rad;
  Vec3 offset(before - from.opening_rad, 0, 0), rate(opening_rate_ - wish_rate, 0, 0);
  opening_.advance(offset, rate, {wish_rate, 0, 0}, {torque, 0, 0});
  opening_rate_ = rate.x() + wish_rate;
  truth_.opening_rad = to.opening_rad + offset.x();
  received_j_ += torque * (truth_.opening_rad - before);
}

}  // namespace souple
