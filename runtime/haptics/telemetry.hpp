// SPDX-License-Identifier: MIT
// What a haptic channel tells of itself: plain counts and fixed histograms.
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>

namespace souple {

/// Counts in bins of equal ratio: bin k holds values in [lowest ratio^(k-1), lowest ratio^k), the first
/// all below `lowest`, the last all above.
struct LogHistogram {
  static constexpr std::size_t bin_count = 48;
  double lowest = 0, ratio = 1;
  std::array<std::uint64_t, bin_count> count{};

  double upper_bound(std::size_t bin) const;  ///< of the last one: infinite
  std::uint64_t total() const;
  /// Upper bound of the bin in which the value lies that a share of all stay below; 0 of none.
  double quantile(double share) const;
};

struct HapticTelemetry {
  std::uint64_t ticks = 0;
  std::uint64_t sweeps = 0;              ///< of all ticks
  std::uint64_t idle_ticks = 0;          ///< without a contact near: nothing to be solved
  std::uint64_t deadline_misses = 0;     ///< ticks longer than the budget, wall time
  std::uint64_t unconverged_ticks = 0;   ///< ended by budget or sweeps above the residual goal
  std::uint64_t publications = 0;        ///< by physics
  std::uint64_t hand_overs = 0;          ///< that a tick took up
  std::uint64_t refused_not_finite = 0;  ///< samples with a number that is none
  std::uint64_t refused_jumps = 0;       ///< faster than any hand
  std::uint64_t refused_clock = 0;       ///< time not later than that of the sample before
  std::uint64_t missing_samples = 0;     ///< ticks for which the device had nothing new
  std::uint64_t recoveries = 0;          ///< a device believed again after its samples were refused
  std::uint64_t dead_ticks = 0;          ///< physics silent for too long
  std::uint64_t clamped_ticks = 0;       ///< the hand beyond the reach of the published problem
  std::uint64_t limited_ticks = 0;       ///< force, torque or slew limits of the device at work
  std::uint64_t contacts_left_out = 0;   ///< of the newest problem, for want of capacity
  std::uint64_t contacts = 0;            ///< in the newest problem
  std::uint64_t active_contacts = 0;     ///< of them, bearing a force at the newest tick
  std::uint64_t active_sum = 0;          ///< over all ticks
  std::uint64_t contact_sum = 0;         ///< over all ticks
  double largest_force_n = 0;
  double largest_hand_over_step_n = 0;  ///< of the force, at the tick that took up a publication
  double largest_step_n = 0;            ///< of the force, between any two ticks
  double longest_silence_s = 0;         ///< between two publications
  LogHistogram tick_time_s{1e-6, 1.2589254117941673};  ///< wall time, ten bins a decade
  LogHistogram sweeps_per_tick{1, 1.2589254117941673};
  LogHistogram residual{1e-8, 1.5848931924611136};  ///< five bins a decade
  LogHistogram hand_over_step_n{1e-5, 1.5848931924611136};
};

}  // namespace souple
