// SPDX-License-Identifier: MIT
// Times of meeting without roots of polynomials: additive conservative advancement (Li, Kaufman, Jiang
// 2021, Codimensional Incremental Potential Contact, section 5).
#pragma once
#include <optional>

namespace souple {

/// The first time in [0, 1] at which `distance_at(t)` falls to 1e-4 of its value at 0, if it changes by
/// no more than `speed` per unit of time and is positive at 0. A pair that comes nearer slowly and
/// never quite meets counts as meeting after 300 advances: no meeting is missed.
template <class Distance>
std::optional<double> time_of_meeting(const Distance& distance_at, double speed) {
  constexpr int most_advances = 300;
  double distance = distance_at(0.0);
  const double met = 1e-4 * distance;
  double time = 0;
  for (int k = 0; k < most_advances; ++k) {
    if (distance <= met) return time;
    // Half of the rest is kept, so that there is a direction left between the two.
    time += (distance - 0.5 * met) / speed;
    if (!(time <= 1)) return std::nullopt;
    distance = distance_at(time);
  }
  return time;
}

}  // namespace souple
