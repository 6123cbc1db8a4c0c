// SPDX-License-Identifier: GPL-3.0-or-later
// The force of a tick against that of a whole step of the world with the tool at the pose of the tick,
// from the state that the problem was made from: over rates of the physics and speeds of the hand.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "tests/bench/haptic_scene.hpp"
#include "tests/bench/line_plot.hpp"
#include "tests/bench/row.hpp"

namespace {

using namespace souple;
using namespace souple::bench;

constexpr double tick_s = 0.001;

Vec3 force_on_tool(const World& world, const Tool& tool) {
  Vec3 sum = Vec3::Zero();
  for (const ContactRecord& c : world.contacts())
    for (const BodyId jaw : tool.bodies()) {
      if (c.body_a == jaw) sum += as_vec3(c.force_n);
      if (c.body_b == jaw) sum -= as_vec3(c.force_n);
    }
  return sum;
}

struct Errors {
  std::vector<double> lawful, sent;  ///< relative, the force at least a twentieth of the largest
  double largest_step = 0;           ///< of the force sent, over the largest force
  /// Of the true force where one problem takes over from another, the hand where it is, over the
  /// largest.
  std::vector<double> jumps;
  ResultHash hash;
};

struct Sampled {
  Vec3 lawful, sent, truth;
};

Vec3 true_force(GripScene& reference, const std::vector<std::byte>& state, const DeviceSample& hand) {
  if (auto status = reference.world.restore(state); !status) exit_with(status.issue());
  const Tool& tool = reference.channel.tool();
  if (auto status = tool.move(reference.world, hand.pose, hand.opening_rad); !status)
    exit_with(status.issue());
  value_or_exit(reference.world.step());
  return force_on_tool(reference.world, tool);
}

Errors measure(const std::shared_ptr<const SoftBodyAsset>& liver, double h, double speed,
               double seconds) {
  GripSettings settings;
  settings.time_step_s = h;
  settings.look_ahead_m = 0.002;
  settings.haptics.contact_capacity = 1024;
  settings.haptics.tick_budget_s = 0.0008;
  GripScene scene = GripScene::make(liver, settings), reference = GripScene::make(liver, settings);
  scene.grip();
  std::vector<Sampled> samples;
  std::vector<double> jumps;
  std::vector<std::byte> last_state;
  double time = 0, largest = 0, step = 0;
  Vec3 last = as_vec3(scene.tick(tick_s, probing_hand(0, 0)).force_n);
  const int ticks = int(std::lround(h / tick_s)), every = std::max(1, ticks / 4);
  while (time < seconds) {
    const std::vector<std::byte> state = scene.world.snapshot();
    if (!last_state.empty()) {
      const DeviceSample hand = probing_hand(time, speed);
      jumps.push_back(
          (true_force(reference, state, hand) - true_force(reference, last_state, hand)).norm());
    }
    scene.physics_step();
    for (int k = 0; k < ticks; ++k) {
      time += tick_s;
      const DeviceSample hand = probing_hand(time, speed);
      const Vec3 sent = as_vec3(scene.tick(tick_s, hand).force_n);
      step = std::max(step, (sent - last).norm());
      last = sent;
      largest = std::max(largest, sent.norm());
      if (k % every != every / 2) continue;
      samples.push_back(
          {as_vec3(scene.channel.lawful_wrench().force_n), sent, true_force(reference, state, hand)});
    }
    last_state = state;
  }
  Errors errors;
  for (const double jump : jumps) errors.jumps.push_back(jump / largest);
  for (const Sampled& s : samples) {
    const double size = std::max(s.truth.norm(), 0.05 * largest);
    errors.lawful.push_back((s.lawful - s.truth).norm() / size);
    errors.sent.push_back((s.sent - s.truth).norm() / size);
  }
  errors.largest_step = step / largest;
  errors.hash.add(errors.lawful);
  return errors;
}

void print_target(const Errors& e) {
  const auto row = [&](const char* what, double value) {
    print_row(std::string("haptic_error.") + what, "%", 100 * value, e.hash);
  };
  row("median", median(e.lawful));
  row("p99", quantile(e.lawful, 0.99));
  row("sent_median", median(e.sent));
  row("sent_p99", quantile(e.sent, 0.99));
  row("largest_step", e.largest_step);
  row("truth_jump", median(e.jumps));
  row("truth_jump_p99", quantile(e.jumps, 0.99));
}

}  // namespace

// With a name of a file: the curves too, as SVG.
int main(int count, char** arguments) {
  const double target_rate = 50, target_speed = 0.2;
  Plot plot{"Error of the force at a tick (median and p99 of the laws, median of what is sent)",
            "rate of the physics, Hz",
            "relative error",
            false,
            {}};
  for (const double speed : {0.05, 0.2}) {
    PlotSeries middle{std::to_string(speed).substr(0, 4) + " m/s, median", {}, true, true};
    PlotSeries high{std::to_string(speed).substr(0, 4) + " m/s, p99", {}, true, true};
    PlotSeries sent{std::to_string(speed).substr(0, 4) + " m/s, sent", {}, true, true};
    for (const double rate : {25.0, 50.0, 100.0, 200.0}) {
      const bool is_target = rate == target_rate && speed == target_speed;
      if (count < 2 && !is_target) continue;
      const Errors e = measure(held_liver(1300, 1 / rate), 1 / rate, speed, 3);
      middle.points.emplace_back(rate, median(e.lawful));
      high.points.emplace_back(rate, quantile(e.lawful, 0.99));
      sent.points.emplace_back(rate, median(e.sent));
      if (is_target) print_target(e);
    }
    for (auto* series : {&middle, &high, &sent}) plot.series.push_back(*series);
  }
  if (count > 1) write_plot(plot, arguments[1]);
  return 0;
}
