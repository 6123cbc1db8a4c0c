// SPDX-License-Identifier: GPL-3.0-or-later
// Three couplings on one recorded path: a ball comes down through the air, presses a soft block, slides
// on it by stick and slip, and leaves it. Physics at 50 Hz, the hand at 1 kHz.
// souple_bench_haptic_couplings [FILE.svg]
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>

#include "runtime/fem/linear_algebra.hpp"
#include "runtime/haptics/devices/recorded_path.hpp"
#include "tests/bench/haptic_rig.hpp"
#include "tests/bench/line_plot.hpp"
#include "tests/bench/row.hpp"
#include "tests/support/box_mesh.hpp"
#include "tests/support/dense_compliance.hpp"
#include "tests/support/scenes.hpp"

namespace souple::bench {
namespace {

using namespace test;

constexpr double time_step_s = 0.02, tick_s = 0.001, radius = 0.015, block_height = 0.04;
constexpr double stiffness_n_m = 1000;
// Of the path: down through the air, pressed, slid, up again and away.
constexpr double touch_s = 0.4, press_s = 0.8, slide_s = 2, end_s = 3;

const char* row_name(Coupling coupling) {
  if (coupling == Coupling::virtual_coupling) return "virtual";
  return coupling == Coupling::god_object ? "god-object" : "nlcp";
}

RecordedPath recorded_path() {
  const double touch = block_height + radius, pressed = touch - 0.006;
  const auto at = [](double time_s, double x, double z) {
    DeviceSample sample;
    sample.time_s = time_s;
    sample.pose.translation = {x, 0, z};
    return sample;
  };
  auto path = RecordedPath::create({at(0, -0.015, touch + 0.04), at(touch_s, -0.015, touch + 0.0015),
                                    at(press_s, -0.015, pressed), at(slide_s, 0.015, pressed),
                                    at(2.4, 0.015, touch + 0.01), at(end_s, -0.015, touch + 0.06)});
  return std::move(*path);
}

struct Felt {
  std::vector<Vec3> force;  ///< on the hand, at every tick
  double largest_free_n = 0, largest_n = 0, largest_step_n = 0;
};

World block_on_floor() {
  WorldSettings settings;
  settings.time_step_s = time_step_s;
  settings.friction = 0.5;
  World world = make_world(settings);
  add_soft(world,
           make_body(box_mesh({6, 4, 2}, {-0.06, -0.04, 0}, {0.12, 0.08, block_height}),
                     material_of(1e4, 0.4, 1000, 0.1, 0.01), time_step_s),
           {0, 0, 1e-5});
  add_plane(world);
  return world;
}

Felt feel(Coupling coupling) {
  const RecordedPath path = recorded_path();
  HapticRig rig =
      HapticRig::make(block_on_floor(), path.at(0).pose.translation, radius, stiffness_n_m, tick_s);
  Felt felt;
  Vec3 last = Vec3::Zero();
  for (int k = 0; k < int(end_s / tick_s); ++k) {
    const DeviceSample hand = path.at(k * tick_s);
    const Vec3 force = as_vec3(rig.tick(coupling, hand).force_n);
    if (k % int(time_step_s / tick_s + 0.5) == 0) rig.physics_step();
    felt.force.push_back(force);
    // The block is not yet there, or away.
    const bool is_free = hand.time_s < touch_s - 0.05 || hand.time_s > 2.6;
    if (is_free) felt.largest_free_n = std::max(felt.largest_free_n, force.norm());
    felt.largest_n = std::max(felt.largest_n, force.norm());
    if (k > 0) felt.largest_step_n = std::max(felt.largest_step_n, (force - last).norm());
    last = force;
  }
  return felt;
}

void add_series(Plot& plot, Coupling coupling, const Felt& felt) {
  PlotSeries up{std::string(coupling_name(coupling)) + ", up", {}, true, false};
  PlotSeries along{std::string(coupling_name(coupling)) + ", along", {}, true, false};
  for (std::size_t k = 0; k < felt.force.size(); k += 2) {
    up.points.emplace_back(double(k) * tick_s, felt.force[k].z());
    along.points.emplace_back(double(k) * tick_s, felt.force[k].x());
  }
  plot.series.push_back(std::move(up));
  plot.series.push_back(std::move(along));
}

int run(const std::string& file) {
  Plot plot{"One path, three couplings: free, pressed, slid, free",
            "time, s",
            "force on the hand, N",
            false,
            {}};
  plot.y_logarithmic = false;
  for (const Coupling coupling :
       {Coupling::virtual_coupling, Coupling::god_object, Coupling::contact_problem}) {
    const Felt felt = feel(coupling);
    ResultHash hash;
    for (const Vec3& force : felt.force) hash.add(std::vector<double>{force.x(), force.y(), force.z()});
    const std::string row = std::string("haptic-couplings.") + row_name(coupling);
    print_row(row + ".free", "N", felt.largest_free_n, hash);
    print_row(row + ".step", "1", felt.largest_step_n / felt.largest_n, hash);
    std::printf("%s: largest force %.3g N\n", coupling_name(coupling), felt.largest_n);
    add_series(plot, coupling, felt);
  }
  if (!file.empty()) write_plot(plot, file);
  return 0;
}

}  // namespace
}  // namespace souple::bench

int main(int count, char** words) { return souple::bench::run(count > 1 ? words[1] : ""); }
