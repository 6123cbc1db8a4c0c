// SPDX-License-Identifier: GPL-3.0-or-later
// The scene of the haptic benchmarks: a liver, held at one end, whose other lobe a hand grips with
// toothed forceps.
#pragma once
#include <ctime>

#include "runtime/haptics/haptic_channel.hpp"
#include "tests/bench/liver.hpp"

namespace souple::bench {

/// Liver at the reference scale and material with the dynamic compliance of a time step; its nodes
/// beyond x = -0.12 m are fixed ("held").
std::shared_ptr<const SoftBodyAsset> held_liver(std::int64_t tets, double time_step_s);

struct GripSettings {
  double time_step_s = 0.005;
  int teeth = 10;  ///< ridges across the jaws
  double look_ahead_m = 0.001;
  HapticSettings haptics;
};

/// The forceps' handle is to the right of the lobe, its jaws close along z.
struct GripScene {
  World world;
  HapticChannel channel;
  BodyId liver;
  double step_s = 0;
  double time_s = 0;  ///< of the device

  static GripScene make(std::shared_ptr<const SoftBodyAsset> liver, const GripSettings& settings);
  /// Closes the jaws, in a hundred steps.
  void grip();
  void physics_step();
  Wrench tick(double passed_s, const DeviceSample& sample);
};

/// Where the hand is at a time after the grip: it pulls, turns and squeezes as one who probes, with
/// this peak speed of the handle.
DeviceSample probing_hand(double time_s, double peak_speed_m_s);

/// CPU time of this thread, s.
inline double thread_seconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return double(now.tv_sec) + 1e-9 * double(now.tv_nsec);
}

/// The value below which a share of all lie.
double quantile(std::vector<double> values, double share);

}  // namespace souple::bench
