// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <cstdint>
#include <limits>

#include "formats/core/result.hpp"
#include "runtime/haptics/device.hpp"

namespace souple {

enum class PassivityScope : std::uint8_t {
  each_freedom,  ///< what one degree of freedom has taken up, another one may not give
  total_power,   ///< the sum alone has to be passive
};

struct PassivitySettings {
  PassivityScope scope = PassivityScope::each_freedom;
  /// Of the damping that may be added. More than about the device's mass over a tick turns the
  /// measured velocity round within the tick.
  double largest_damping_n_s_m = 20;
  double largest_turn_damping_nm_s_rad = 0.02;
  double largest_opening_damping_nm_s_rad = 0.02;
  /// What the hand has given before is credited up to here, J: less than infinity, and a long passive
  /// time cannot pay for an active one later.
  double largest_credit_j = std::numeric_limits<double>::infinity();
};

/// Observes the energy between a hand and what it feels, and damps as much as was given too much (time
/// domain passivity: Hannaford and Ryu 2002). The observed work of a tick is wrench times measured
/// motion, so the energy is that of the samples, not an estimate from velocities (as in Stramigioli et
/// al. 2005). It has to see samples as fresh as the device gives them, whatever is late behind it: of a
/// device that itself tells late where it is it knows only what it is told. A wrench that is passive
/// goes through as it is, to the bit.
class PassivityController {
 public:
  /// Issue world_parameter_invalid: a bound that is negative or no number.
  static Result<PassivityController> create(const PassivitySettings& settings);

  /// At every sample: what to send instead of `wrench`. A sample that is not finite, or not later than
  /// the one before, is not observed, and the wrench goes through.
  Wrench control(const DeviceSample& sample, const Wrench& wrench);

  /// The device was not followed for some time: what comes next has no motion before it.
  void restart() { has_last_ = false; }

  /// Given by the hand less what it got back, J; below zero: not (yet) passive.
  double energy_j() const;
  double dissipated_j() const { return dissipated_j_; }  ///< by the dampings, so far
  std::uint64_t damped_ticks() const { return damped_ticks_; }

 private:
  static constexpr std::size_t freedom_count = 7;  ///< force, torque, opening
  using Freedoms = std::array<double, freedom_count>;

  explicit PassivityController(const PassivitySettings& settings);
  Freedoms motion_to(const DeviceSample& sample) const;
  void observe(const Freedoms& motion);
  bool choose_damping(const Freedoms& rate, double tick_s, Freedoms& damping) const;

  PassivitySettings settings_;
  Freedoms largest_damping_{};
  Freedoms energy_j_{};  ///< of each freedom; of the total power the first alone
  Freedoms sent_{}, damping_part_{};
  DeviceSample last_;
  bool has_last_ = false;
  double dissipated_j_ = 0;
  std::uint64_t damped_ticks_ = 0;
};

}  // namespace souple
