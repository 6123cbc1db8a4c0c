// SPDX-License-Identifier: MIT
// Counters that one thread writes and any thread reads. Internal to the channel.
#pragma once
#include <array>
#include <atomic>
#include <cmath>

#include "runtime/haptics/telemetry.hpp"

namespace souple {

/// A plain load and store: there is only one writer.
template <class T>
class Counter {
 public:
  void set(T value) { value_.store(value, std::memory_order_relaxed); }
  void add(T value) { set(get() + value); }
  void raise_to(T value) {
    if (value > get()) set(value);
  }
  T get() const { return value_.load(std::memory_order_relaxed); }

 private:
  static_assert(std::atomic<T>::is_always_lock_free);
  std::atomic<T> value_{};
};

class HistogramCounter {
 public:
  explicit HistogramCounter(const LogHistogram& shape)
      : lowest_(shape.lowest), ratio_(shape.ratio), inverse_log_ratio_(1 / std::log(shape.ratio)) {}
  void add(double value) {
    std::size_t bin = 0;
    if (value >= lowest_) {
      const double place = std::log(value / lowest_) * inverse_log_ratio_;
      bin = place < double(LogHistogram::bin_count - 2) ? std::size_t(place) + 1
                                                        : LogHistogram::bin_count - 1;
    }
    count_[bin].add(1);
  }
  LogHistogram read() const {
    LogHistogram histogram{lowest_, ratio_, {}};
    for (std::size_t k = 0; k < count_.size(); ++k) histogram.count[k] = count_[k].get();
    return histogram;
  }

 private:
  double lowest_, ratio_, inverse_log_ratio_;
  std::array<Counter<std::uint64_t>, LogHistogram::bin_count> count_;
};

/// HapticTelemetry as it is being counted. `publications` belongs to the physics thread, all else to
/// the haptic one.
struct TickCounters {
  Counter<std::uint64_t> ticks, sweeps, idle_ticks, deadline_misses, unconverged_ticks, publications,
      hand_overs, refused_not_finite, refused_jumps, refused_clock, missing_samples, recoveries,
      dead_ticks, clamped_ticks, limited_ticks, contacts_left_out, contacts, active_contacts,
      active_sum, contact_sum;
  Counter<double> largest_force_n, largest_hand_over_step_n, largest_step_n, longest_silence_s;
  HistogramCounter tick_time_s{HapticTelemetry{}.tick_time_s};
  HistogramCounter sweeps_per_tick{HapticTelemetry{}.sweeps_per_tick};
  HistogramCounter residual{HapticTelemetry{}.residual};
  HistogramCounter hand_over_step_n{HapticTelemetry{}.hand_over_step_n};

  HapticTelemetry read() const {
    HapticTelemetry t;
    t.ticks = ticks.get();
    t.sweeps = sweeps.get();
    t.idle_ticks = idle_ticks.get();
    t.deadline_misses = deadline_misses.get();
    t.unconverged_ticks = unconverged_ticks.get();
    t.publications = publications.get();
    t.hand_overs = hand_overs.get();
    t.refused_not_finite = refused_not_finite.get();
    t.refused_jumps = refused_jumps.get();
    t.refused_clock = refused_clock.get();
    t.missing_samples = missing_samples.get();
    t.recoveries = recoveries.get();
    t.dead_ticks = dead_ticks.get();
    t.clamped_ticks = clamped_ticks.get();
    t.limited_ticks = limited_ticks.get();
    t.contacts_left_out = contacts_left_out.get();
    t.contacts = contacts.get();
    t.active_contacts = active_contacts.get();
    t.active_sum = active_sum.get();
    t.contact_sum = contact_sum.get();
    t.largest_force_n = largest_force_n.get();
    t.largest_hand_over_step_n = largest_hand_over_step_n.get();
    t.largest_step_n = largest_step_n.get();
    t.longest_silence_s = longest_silence_s.get();
    t.tick_time_s = tick_time_s.read();
    t.sweeps_per_tick = sweeps_per_tick.read();
    t.residual = residual.read();
    t.hand_over_step_n = hand_over_step_n.read();
    return t;
  }
};

}  // namespace souple
