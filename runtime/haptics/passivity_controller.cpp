// SPDX-License-Identifier: MIT
#include "runtime/haptics/passivity_controller.hpp"

#include <algorithm>
#include <cmath>

#include "runtime/haptics/devices/turns.hpp"

namespace souple {
namespace {

bool is_finite(const DeviceSample& s) {
  return std::isfinite(s.time_s) && std::isfinite(s.opening_rad) &&
         as_vec3(s.pose.translation).allFinite() && quaternion_of(s.pose).coeffs().allFinite();
}

std::array<double, 7> freedoms_of(const Wrench& w) {
  return {w.force_n[0],   w.force_n[1],   w.force_n[2], w.torque_nm[0],
          w.torque_nm[1], w.torque_nm[2], w.opening_nm};
}

}  // namespace

PassivityController::PassivityController(const PassivitySettings& settings) : settings_(settings) {
  std::fill_n(largest_damping_.begin(), 3, settings.largest_damping_n_s_m);
  std::fill_n(largest_damping_.begin() + 3, 3, settings.largest_turn_damping_nm_s_rad);
  largest_damping_[6] = settings.largest_opening_damping_nm_s_rad;
}

Result<PassivityController> PassivityController::create(const PassivitySettings& settings) {
  for (const double bound : {settings.largest_damping_n_s_m, settings.largest_turn_damping_nm_s_rad,
                             settings.largest_opening_damping_nm_s_rad})
    if (!(bound >= 0 && bound <= 1e9))
      return make_issue(IssueCode::world_parameter_invalid,
                        "a largest damping of passivity control is not within [0, 1e9]");
  if (!(settings.largest_credit_j >= 0))
    return make_issue(IssueCode::world_parameter_invalid,
                      "the largest credit of passivity control is negative or no number");
  return PassivityController(settings);
}

double PassivityController::energy_j() const {
  double sum = 0;
  for (const double energy : energy_j_) sum += energy;
  return sum;
}

PassivityController::Freedoms PassivityController::motion_to(const DeviceSample& sample) const {
  const Vec3 move = as_vec3(sample.pose.translation) - as_vec3(last_.pose.translation);
  const Vec3 turn = rotation_vector(quaternion_of(sample.pose) * quaternion_of(last_.pose).conjugate());
  return {move[0], move[1], move[2], turn[0], turn[1], turn[2], sample.opening_rad - last_.opening_rad};
}

// The wrench sent a tick ago has acted along this motion.
void PassivityController::observe(const Freedoms& motion) {
  const bool total = settings_.scope == PassivityScope::total_power;
  for (std::size_t k = 0; k < freedom_count; ++k) {
    energy_j_[total ? 0 : k] -= sent_[k] * motion[k];
    dissipated_j_ -= damping_part_[k] * motion[k];
  }
  for (double& energy : energy_j_) energy = std::min(energy, settings_.largest_credit_j);
}

// At the rate of the last tick the damping takes back within the next one what is owed. Of the total
// power every freedom is damped by the same share of its bound.
bool PassivityController::choose_damping(const Freedoms& rate, double tick_s, Freedoms& damping) const {
  bool any = false;
  if (settings_.scope == PassivityScope::total_power) {
    double power = 0;
    for (std::size_t k = 0; k < freedom_count; ++k) power += largest_damping_[k] * rate[k] * rate[k];
    if (!(energy_j_[0] < 0 && power > 0)) return false;
    const double share = std::min(1.0, -energy_j_[0] / (tick_s * power));
    for (std::size_t k = 0; k < freedom_count; ++k) damping[k] = share * largest_damping_[k];
    return true;
  }
  for (std::size_t k = 0; k < freedom_count; ++k) {
    damping[k] = 0;
    if (!(energy_j_[k] < 0 && rate[k] != 0)) continue;
    damping[k] = std::min(largest_damping_[k], -energy_j_[k] / (tick_s * rate[k] * rate[k]));
    any = any || damping[k] > 0;
  }
  return any;
}

Wrench PassivityController::control(const DeviceSample& sample, const Wrench& wrench) {
  if (!is_finite(sample)) return wrench;
  if (has_last_ && !(sample.time_s > last_.time_s)) return wrench;
  Freedoms part{};
  if (has_last_) {
    const double tick_s = sample.time_s - last_.time_s;
    Freedoms rate = motion_to(sample), damping{};
    observe(rate);
    for (double& r : rate) r /= tick_s;
    if (choose_damping(rate, tick_s, damping)) {
      ++damped_ticks_;
      for (std::size_t k = 0; k < freedom_count; ++k) part[k] = -damping[k] * rate[k];
    }
  }
  last_ = sample;
  has_last_ = true;
  Wrench sent = wrench;
  const auto add = [](double& value, double more) {
    if (more != 0) value += more;
  };
  for (std::size_t k = 0; k < 3; ++k) {
    add(sent.force_n[k], part[k]);
    add(sent.torque_nm[k], part[3 + k]);
  }
  add(sent.opening_nm, part[6]);
  sent_ = freedoms_of(sent);
  damping_part_ = part;
  return sent;
}

}  // namespace souple
