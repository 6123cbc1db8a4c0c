// SPDX-License-Identifier: GPL-3.0-or-later
// Forces for a hand at 4 kHz while a liver is gripped with toothed forceps.
//   haptic_tick simulated NAME TETS TEETH STEP_S BUDGET_S   CPU times on one thread, by a simulated
//   clock haptic_tick wall NAME TETS TEETH STEP_S SECONDS          two threads against the wall clock
//   haptic_tick ticks COUNT                                  nothing but ticks, for tick_syscalls.sh
#include <atomic>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <thread>

#include "tests/bench/haptic_scene.hpp"
#include "tests/bench/row.hpp"

namespace {

using namespace souple;
using namespace souple::bench;

constexpr double speed = 0.2, tick_rate = 4000;

struct Case {
  std::string name;
  std::int64_t tets = 1300;
  GripSettings grip;
};

Case make_case(char** arguments, double budget_s) {
  Case c{std::string("haptics.") + arguments[0], std::atoll(arguments[1]), {}};
  c.grip.teeth = std::atoi(arguments[2]);
  c.grip.time_step_s = std::atof(arguments[3]);
  c.grip.look_ahead_m = 0.002;
  c.grip.haptics.limits.rate_hz = tick_rate;
  c.grip.haptics.contact_capacity = 1024;
  c.grip.haptics.tick_budget_s = budget_s;
  return c;
}

GripScene gripped(const Case& c) {
  GripScene scene = GripScene::make(held_liver(c.tets, c.grip.time_step_s), c.grip);
  scene.grip();
  return scene;
}

double count_share(const std::vector<double>& values, double most) {
  double count = 0;
  for (const double v : values) count += v <= most;
  return values.empty() ? 0 : 100 * count / double(values.size());
}

struct Measured {
  std::vector<double> ticks, residuals, steps, publications, contacts, active;
  double largest_force = 0, largest_step = 0;
  ResultHash hash;
};

// One period of the physics and the ticks in it.
void run_period(GripScene& scene, int ticks, double& time, Vec3& last, Measured& m) {
  const double begin = thread_seconds();
  if (auto status = scene.channel.begin_step(scene.world); !status) exit_with(status.issue());
  value_or_exit(scene.world.step());
  const double stepped = thread_seconds();
  if (auto status = scene.channel.publish(scene.world); !status) exit_with(status.issue());
  m.publications.push_back(thread_seconds() - stepped);
  m.steps.push_back(thread_seconds() - begin);
  for (int k = 0; k < ticks; ++k) {
    time += 1 / tick_rate;
    const DeviceSample hand = probing_hand(time, speed);
    const double before = thread_seconds();
    const Wrench wrench = scene.tick(1 / tick_rate, hand);
    m.ticks.push_back(thread_seconds() - before);
    m.residuals.push_back(scene.channel.residual());
    const Vec3 force = as_vec3(wrench.force_n);
    m.largest_force = std::max(m.largest_force, force.norm());
    m.largest_step = std::max(m.largest_step, (force - last).norm());
    last = force;
    m.hash.add(std::span<const double>(wrench.force_n));
  }
  const HapticTelemetry told = scene.channel.telemetry();
  m.contacts.push_back(double(told.contacts));
  m.active.push_back(double(told.active_contacts));
}

void print(const Case& c, const Measured& m, double budget_s, std::uint64_t left_out) {
  double late = 0, mean_step = 0;
  for (const double t : m.ticks) late += t > budget_s;
  for (const double t : m.steps) mean_step += t / double(m.steps.size());
  const auto row = [&](const char* what, const char* unit, double value) {
    print_row(c.name + "." + what, unit, value, m.hash);
  };
  row("tick_median", "us", 1e6 * median(m.ticks));
  row("tick_p999", "us", 1e6 * quantile(m.ticks, 0.999));
  row("tick_largest", "us", 1e6 * quantile(m.ticks, 1));
  row("late_ticks", "1", late);
  row("residual_share", "%", count_share(m.residuals, 1e-3));
  row("physics_rate", "Hz", 1 / mean_step);
  row("physics_p99", "ms", 1e3 * quantile(m.steps, 0.99));
  row("publish", "ms", 1e3 * median(m.publications));
  row("contacts", "1", median(m.contacts));
  double active = 0, contacts = 0;
  for (std::size_t k = 0; k < m.active.size(); ++k) active += m.active[k], contacts += m.contacts[k];
  row("active_share", "%", 100 * active / contacts);
  row("left_out", "1", double(left_out));
  row("largest_step", "%", 100 * m.largest_step / m.largest_force);
  row("largest_force", "N", m.largest_force);
}

int simulate(char** arguments) {
  const double budget = std::atof(arguments[4]);
  const Case c = make_case(arguments, budget);
  GripScene scene = gripped(c);
  Measured m;
  double time = 0;
  Vec3 last = as_vec3(scene.tick(1 / tick_rate, probing_hand(0, 0)).force_n);
  const int ticks = int(std::lround(c.grip.time_step_s * tick_rate));
  const auto telemetry = [&] { return scene.channel.telemetry(); };
  while (time < 4) run_period(scene, ticks, time, last, m);
  print(c, m, budget, telemetry().contacts_left_out);
  return 0;
}

// The haptic thread spins from tick to tick, as one that owns its core; what it is late by is told.
int run_on_the_wall(char** arguments) {
  using Clock = std::chrono::steady_clock;
  const double seconds = std::atof(arguments[4]);
  const Case c = make_case(arguments, 200e-6);
  GripScene scene = gripped(c);
  std::atomic<bool> done{false};
  std::vector<double> ticks;
  ticks.reserve(std::size_t(seconds * tick_rate) + 16);
  double physics_cpu = 0;
  std::uint64_t steps = 0;
  std::thread physics([&] {
    const auto start = Clock::now();
    const double cpu = thread_seconds();
    for (steps = 0; !done; ++steps) {
      scene.physics_step();
      std::this_thread::sleep_until(
          start + std::chrono::duration<double>(c.grip.time_step_s * double(steps + 1)));
    }
    physics_cpu = thread_seconds() - cpu;
  });
  const auto start = Clock::now();
  const auto count = std::size_t(seconds * tick_rate);
  for (std::size_t k = 0; k < count; ++k) {
    const auto due = start + std::chrono::duration<double>(double(k) / tick_rate);
    while (Clock::now() < due) {
    }
    const double before = thread_seconds();
    scene.tick(1 / tick_rate, probing_hand(double(k) / tick_rate, speed));
    ticks.push_back(thread_seconds() - before);
  }
  const double wall = std::chrono::duration<double>(Clock::now() - start).count();
  done = true;
  physics.join();
  ResultHash hash;
  const HapticTelemetry told = scene.channel.telemetry();
  const auto row = [&](const char* what, const char* unit, double value) {
    print_row(c.name + "." + what, unit, value, hash);
  };
  row("tick_rate", "Hz", double(count) / wall);
  row("physics_rate", "Hz", double(steps) / wall);
  row("physics_rate_possible", "Hz", double(steps) / physics_cpu);
  row("tick_median", "us", 1e6 * median(ticks));
  row("tick_p999", "us", 1e6 * quantile(ticks, 0.999));
  row("tick_p999_wall", "us", 1e6 * told.tick_time_s.quantile(0.999));
  row("residual_p99", "1", told.residual.quantile(0.99));
  row("late_ticks_wall", "%", 100 * double(told.deadline_misses) / double(told.ticks));
  row("seconds", "s", wall);
  return 0;
}

// The scene is made, and what follows is ticks alone, marked by a call that a trace shows.
int tick_only(char** arguments) {
  char name[] = "ticks", tets[] = "1300", teeth[] = "10", step[] = "0.005";
  char* c[] = {name, tets, teeth, step};
  GripScene scene = gripped(make_case(c, 0.0008));
  std::vector<DeviceSample> hands;
  const int count = std::atoi(arguments[0]);
  for (int k = 0; k < count; ++k) hands.push_back(probing_hand(k / tick_rate, speed));
  double sum = 0;
  std::fflush(stdout);
  for (const DeviceSample& hand : hands) sum += scene.tick(1 / tick_rate, hand).force_n[0];
  return std::isfinite(sum) ? 0 : 1;
}

}  // namespace

int main(int count, char** arguments) {
  if (count == 7 && std::strcmp(arguments[1], "simulated") == 0) return simulate(arguments + 2);
  if (count == 7 && std::strcmp(arguments[1], "wall") == 0) return run_on_the_wall(arguments + 2);
  if (count == 3 && std::strcmp(arguments[1], "ticks") == 0) return tick_only(arguments + 2);
  std::fputs("haptic_tick simulated|wall NAME TETS TEETH STEP_S BUDGET_S|SECONDS, or ticks COUNT\n",
             stderr);
  return 2;
}
