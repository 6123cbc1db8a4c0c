// SPDX-License-Identifier: GPL-3.0-or-later
// How stiff a contact may be before a hand that presses it begins to shake: the spring of the coupling
// to a rigid ball on a rigid floor, felt by a simulated hand that is one tick late, over the hand's own
// stiffness. Physics runs at 100 Hz, the hand at 1 kHz.
//   virtual coupling: the force of its spring after a step of physics, held until the next
//   ticked spring: between the hand now and the tool where the last step left it
//   NLCP in the loop: HapticChannel, as it is; with a lead of what the device is late by; with
//   passivity control
// souple_bench_haptic_stability [FILE.svg]
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <string>

#include "runtime/haptics/devices/synthetic_hand.hpp"
#include "runtime/haptics/haptic_channel.hpp"
#include "runtime/haptics/passivity_controller.hpp"
#include "tests/bench/line_plot.hpp"
#include "tests/bench/row.hpp"

namespace souple::bench {
namespace {

constexpr double time_step_s = 0.01, tick_s = 0.001, radius = 0.02, depth = 0.008, seconds = 3;
constexpr double still_m = 2e-5;  // a hand that swings less than this at the end is at rest
constexpr double softest = 5, stiffest = 1e6;

template <class T>
T value_or_exit(Result<T> result) {
  if (result) return std::move(*result);
  std::fprintf(stderr, "%s\n", format_issue(result.issue()).c_str());
  std::exit(4);
}

void check(const Status& status) {
  if (status) return;
  std::fprintf(stderr, "%s\n", format_issue(status.issue()).c_str());
  std::exit(4);
}

enum Coupling : std::size_t {
  virtual_coupling,
  ticked_spring,
  nlcp,
  led_nlcp,
  controlled_nlcp,
  coupling_count
};
constexpr std::array<const char*, coupling_count> names{"virtual coupling", "ticked spring", "NLCP",
                                                        "NLCP, lead", "NLCP, passivity control"};
// The tick of the delay, half of one in which a force is held, and half of one that steadies what is
// left.
constexpr double lead_s = 2 * tick_s;

struct Bench {
  World world;
  Tool tool;
};

Bench ball_on_floor(double stiffness_n_m) {
  WorldSettings settings;
  settings.time_step_s = time_step_s;
  settings.measure_laws = false;
  World world = value_or_exit(World::create(settings));
  RigidBodyDescription floor;
  floor.name = "floor";
  floor.path = {{}};
  value_or_exit(world.add_rigid_body(floor));
  ToolDescription ball;
  ball.name = "ball";
  ball.pose.translation = {0, 0, radius + 0.005};
  JawDescription jaw;
  jaw.shape.kind = RigidShapeKind::sphere;
  jaw.shape.radius_m = radius;
  jaw.coupling.stiffness_n_m = stiffness_n_m;
  jaw.coupling.look_ahead_m = 0.005;
  ball.jaws.push_back(jaw);
  Tool tool = value_or_exit(Tool::create(world, ball));
  return {std::move(world), std::move(tool)};
}

SyntheticHand pressing_hand(double grip) {
  DeviceSample above, below;
  above.pose.translation = {0, 0, radius + 0.005};
  below.time_s = 0.3;
  below.pose.translation = {0, 0, radius - depth};
  SyntheticHandSettings settings;
  settings.model = hand_of_grip(grip);
  settings.delay_samples = 1;
  return value_or_exit(
      SyntheticHand::create(value_or_exit(RecordedPath::create({above, below})), settings));
}

/// Whether the hand comes to rest.
bool is_stable(Coupling coupling, double grip, double stiffness_n_m) {
  Bench bench = ball_on_floor(stiffness_n_m);
  HapticSettings settings;
  settings.tick_budget_s = std::numeric_limits<double>::infinity();
  settings.reach_m = 0.05;
  if (coupling == led_nlcp) settings.lead_s = lead_s;
  HapticChannel channel = value_or_exit(HapticChannel::create(bench.tool, settings));
  SyntheticHand hand = pressing_hand(grip);
  PassivityController controller = value_or_exit(PassivityController::create({}));
  double low = 1, high = -1;
  DeviceSample sample;
  Wrench held;
  for (int k = 0; k < int(seconds / tick_s); ++k) {
    hand.read(sample);
    Wrench wrench = channel.tick(sample);
    const bool steps = k % int(time_step_s / tick_s) == 0;
    if (steps) {
      check(channel.begin_step(bench.world));
      value_or_exit(bench.world.step());
      check(channel.publish(bench.world));
    }
    if (coupling == controlled_nlcp) wrench = controller.control(sample, wrench);
    if (coupling == virtual_coupling || coupling == ticked_spring) {
      const Point at = bench.world.rigid_pose(bench.tool.bodies()[0]).translation;
      wrench = {};
      for (std::size_t i = 0; i < 3; ++i)
        wrench.force_n[i] = stiffness_n_m * (at[i] - sample.pose.translation[i]);
      if (steps) held = wrench;
      if (coupling == virtual_coupling) wrench = held;
    }
    hand.write(wrench);
    if (k * tick_s < seconds - 0.5) continue;
    low = std::min(low, hand.truth().pose.translation[2]);
    high = std::max(high, hand.truth().pose.translation[2]);
  }
  return high - low < still_m;
}

/// To 2 %, by halving in the logarithm; what is below the bound it returns has been stable throughout.
double largest_stable(Coupling coupling, double grip) {
  double stable = softest, unstable = stiffest;
  if (!is_stable(coupling, grip, stable)) return 0;
  while (unstable / stable > 1.02) {
    const double middle = std::sqrt(stable * unstable);
    (is_stable(coupling, grip, middle) ? stable : unstable) = middle;
  }
  return stable;
}

int run(const std::string& file) {
  Plot plot{"Stiffness of a contact that a hand can press, one tick late",
            "stiffness of the hand, N/m",
            "largest stable stiffness, N/m",
            true,
            {}};
  for (const char* name : names) plot.series.push_back({name, {}, true, true});
  double to_virtual = stiffest, to_ticked = stiffest;
  double led_to_virtual = stiffest, led_to_ticked = stiffest;
  ResultHash hash;
  for (const double grip : {0.0, 0.2, 0.4, 0.6, 0.8, 1.0}) {
    const double hand = hand_of_grip(grip).move.hand_stiffness;
    std::printf("hand %6.1f N/m:", hand);
    std::array<double, coupling_count> largest{};
    for (std::size_t k = 0; k < coupling_count; ++k) {
      largest[k] = largest_stable(Coupling(k), grip);
      plot.series[k].points.emplace_back(hand, largest[k]);
      std::printf("  %s %.1f N/m", names[k], largest[k]);
    }
    std::printf("\n");
    to_virtual = std::min(to_virtual, largest[nlcp] / largest[virtual_coupling]);
    to_ticked = std::min(to_ticked, largest[nlcp] / largest[ticked_spring]);
    led_to_virtual = std::min(led_to_virtual, largest[led_nlcp] / largest[virtual_coupling]);
    led_to_ticked = std::min(led_to_ticked, largest[led_nlcp] / largest[ticked_spring]);
    hash.add(std::vector<double>(largest.begin(), largest.end()));
  }
  const auto& curve = plot.series[nlcp].points;
  print_row("haptic-stability.ratio", "1", to_virtual, hash);
  print_row("haptic-stability.ratio-lead", "1", led_to_virtual, hash);
  print_row("haptic-stability.ratio-ticked", "1", to_ticked, hash);
  print_row("haptic-stability.ratio-ticked-lead", "1", led_to_ticked, hash);
  print_row("haptic-stability.limp-hand", "N/m", curve.front().second, hash);
  print_row("haptic-stability.stiff-hand", "N/m", curve.back().second, hash);
  if (!file.empty()) write_plot(plot, file);
  return 0;
}

}  // namespace
}  // namespace souple::bench

int main(int count, char** words) { return souple::bench::run(count > 1 ? words[1] : ""); }
