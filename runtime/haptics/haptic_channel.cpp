// SPDX-License-Identifier: MIT
#include "runtime/haptics/haptic_channel.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "runtime/haptics/pose_lead.hpp"
#include "runtime/haptics/sample_guard.hpp"
#include "runtime/haptics/tick_counters.hpp"
#include "runtime/haptics/tool_solver.hpp"
#include "runtime/haptics/triple_buffer.hpp"
#include "runtime/haptics/wrench_shaper.hpp"

namespace souple {
namespace {

Status refuse(const std::string& what, const std::string& where) {
  return make_issue(IssueCode::world_parameter_invalid, what, where);
}

Status check(const HapticSettings& s) {
  if (s.contact_capacity < 1 || s.contact_capacity > 4096)
    return refuse("a channel has room for 1 to 4096 contacts", "contact_capacity");
  if (!(s.tick_budget_s > 0) || !(s.residual_goal >= 0 && s.residual_goal <= 1) || s.max_sweeps < 1 ||
      s.max_sweeps > 1000000)
    return refuse("a tick needs a budget, a residual goal in [0, 1] and a sweep or more", "tick");
  for (const double time : {s.dead_after_s, s.fade_s, s.recover_after_s})
    if (!(time > 0 && time <= 3600)) return refuse("a time is outside (0, 3600] s", "haptics");
  if (!(s.hand_over_s >= 0 && s.hand_over_s <= 3600))
    return refuse("a time is outside [0, 3600] s", "hand_over_s");
  if (!(s.hand_over_share >= 0 && s.hand_over_share <= 1))
    return refuse("a share is outside [0, 1]", "hand_over_share");
  if (!(s.lead_s >= 0 && s.lead_s <= 0.02)) return refuse("a lead is outside [0, 0.02] s", "lead_s");
  if (!(s.credible_speed_m_s > 0) || !(s.credible_turn_rad_s > 0) || !(s.reach_m > 0))
    return refuse("a speed or the reach is not above zero", "haptics");
  const DeviceLimits& d = s.limits;
  if (!(d.rate_hz >= 1 && d.rate_hz <= 1e6))
    return refuse("the rate of a device is outside [1, 1e6] Hz", "rate_hz");
  for (const double most : {d.force_n, d.torque_nm, d.opening_nm, d.force_slew_n_s, d.torque_slew_nm_s})
    if (!(most >= 0)) return refuse("a limit of the device is negative", "limits");
  return {};
}

double distance(const Point& a, const Point& b) { return (as_vec3(a) - as_vec3(b)).norm(); }

}  // namespace

namespace {

struct BelievedSample {
  DeviceSample sample;
  std::uint64_t recoveries = 0;  ///< so often the device has been believed again somewhere else
};

}  // namespace

struct HapticChannel::State {
  State(Tool t, const HapticSettings& s)
      : tool(std::move(t)),
        settings(s),
        guard(s),
        lead(s.lead_s),
        shaper(s),
        tick_s(1 / s.limits.rate_hz) {
    problems.for_each_slot([&](PreparedProblem& slot) { slot.reserve(s.contact_capacity); });
    solver.reserve(s.contact_capacity);
  }

  Tool tool;
  HapticSettings settings;
  TripleBuffer<PreparedProblem> problems;  ///< physics to ticks
  TripleBuffer<BelievedSample> samples;    ///< ticks to physics
  TickCounters counters;

  // Of the physics thread.
  std::uint64_t sequence = 0;
  bool has_sample = false;
  BelievedSample newest;
  std::uint64_t placed = 0;  ///< recoveries that the tool has followed

  // Of the haptic thread.
  SampleGuard guard;
  PoseLead lead;
  ToolSolver solver;
  WrenchShaper shaper;
  double tick_s;
  double now_s = 0;      ///< sum of the ticks
  double held_s = 0;     ///< of them, since the last good sample
  double arrived_s = 0;  ///< the newest publication
  double period_s = 0;   ///< between the last two
  Wrench lawful, sent;
  double last_residual = 0;
  ToolSolver::Clock::duration closing{};  ///< what a tick takes after its solve, of late

  double take_sample(const DeviceSample* sample);
  void count(SampleGuard::Verdict verdict);
  bool take_problem();
  void solve(ToolSolver::Clock::time_point deadline);
  Wrench wrench(const RigidPlacement& handle, const JawPoses& poses) const;
  Wrench tick(const DeviceSample* sample);
  void count_step(const Wrench& next, bool handed_over);
};

Result<HapticChannel> HapticChannel::create(Tool tool, const HapticSettings& settings) {
  if (auto status = check(settings); !status) return status.issue();
  return HapticChannel(std::make_unique<State>(std::move(tool), settings));
}

HapticChannel::HapticChannel(std::unique_ptr<State> state) : state_(std::move(state)) {}
HapticChannel::HapticChannel(HapticChannel&&) noexcept = default;
HapticChannel& HapticChannel::operator=(HapticChannel&&) noexcept = default;
HapticChannel::~HapticChannel() = default;

const Tool& HapticChannel::tool() const { return state_->tool; }
const HapticSettings& HapticChannel::settings() const { return state_->settings; }
HapticTelemetry HapticChannel::telemetry() const { return state_->counters.read(); }
void HapticChannel::set_limits(const DeviceLimits& limits) {
  DeviceLimits safe = limits;
  for (double DeviceLimits::*limit :
       {&DeviceLimits::force_n, &DeviceLimits::torque_nm, &DeviceLimits::opening_nm,
        &DeviceLimits::force_slew_n_s, &DeviceLimits::torque_slew_nm_s})
    if (!(safe.*limit >= 0)) safe.*limit = 0;
  state_->shaper.set_limits(safe);
}

Wrench HapticChannel::lawful_wrench() const { return state_->lawful; }
double HapticChannel::residual() const { return state_->last_residual; }

bool HapticChannel::newest_sample(DeviceSample& sample) {
  State& s = *state_;
  if (s.samples.take()) {
    s.newest = s.samples.front();
    s.has_sample = true;
  }
  if (s.has_sample) sample = s.newest.sample;
  return s.has_sample;
}

Status HapticChannel::begin_step(World& world) {
  DeviceSample sample;
  if (!newest_sample(sample)) return {};
  State& s = *state_;
  if (s.placed != s.newest.recoveries)
    if (auto status = s.tool.place(world, sample.pose, sample.opening_rad); !status) return status;
  s.placed = s.newest.recoveries;
  return s.tool.move(world, sample.pose, sample.opening_rad);
}

Status HapticChannel::publish(const World& world) {
  State& s = *state_;
  PreparedProblem& slot = s.problems.back();
  if (auto status = world.tool_problem(s.tool.bodies(), slot.problem); !status) return status;
  slot.prepare();
  slot.problem.sequence = ++s.sequence;
  slot.recoveries = s.placed;
  s.problems.publish();
  s.counters.publications.add(1);
  return {};
}

Wrench HapticChannel::tick(const DeviceSample& sample) { return state_->tick(&sample); }
Wrench HapticChannel::tick() { return state_->tick(nullptr); }

void HapticChannel::State::count(SampleGuard::Verdict verdict) {
  using Verdict = SampleGuard::Verdict;
  if (verdict == Verdict::not_finite) counters.refused_not_finite.add(1);
  if (verdict == Verdict::jump) counters.refused_jumps.add(1);
  if (verdict == Verdict::clock) counters.refused_clock.add(1);
  if (verdict == Verdict::recovered) counters.recoveries.add(1);
}

// How much later it is than at the last tick. Time that passed without a good sample has been counted
// tick by tick, and is not counted again when the device goes on.
double HapticChannel::State::take_sample(const DeviceSample* sample) {
  using Verdict = SampleGuard::Verdict;
  const bool had_sample = guard.has_sample();
  const double before = had_sample ? guard.sample().time_s : 0;
  const Verdict verdict = sample ? guard.look_at(*sample) : Verdict::good;
  if (!sample) counters.missing_samples.add(1);
  count(verdict);
  if (verdict == Verdict::recovered) {
    shaper.begin_anew(settings.fade_s);
    lead.restart();
  }
  const bool believed = sample && (verdict == Verdict::good || verdict == Verdict::recovered);
  if (!believed) {
    held_s += tick_s;
    return tick_s;
  }
  lead.add(guard.sample());
  samples.back() = {guard.sample(), counters.recoveries.get()};
  samples.publish();
  const double passed = had_sample && verdict == Verdict::good
                            ? std::max(0.0, guard.sample().time_s - before - held_s)
                            : tick_s;
  held_s = 0;
  return passed;
}

// Whether a new problem was taken up.
bool HapticChannel::State::take_problem() {
  if (!problems.take()) return false;
  const PreparedProblem& slot = problems.front();
  solver.begin(slot);
  period_s = counters.hand_overs.get() > 0 ? now_s - arrived_s : 0;
  counters.longest_silence_s.raise_to(period_s);
  arrived_s = now_s;
  counters.hand_overs.add(1);
  counters.contacts.set(slot.problem.contacts.size());
  counters.contacts_left_out.set(slot.problem.left_out);
  const double fade = settings.hand_over_s > 0 ? settings.hand_over_s : period_s;
  shaper.hand_over(std::clamp(fade, tick_s, settings.dead_after_s));
  return true;
}

void HapticChannel::State::solve(ToolSolver::Clock::time_point deadline) {
  const TickSolve result = solver.solve(settings.residual_goal, settings.max_sweeps, deadline);
  last_residual = result.residual;
  counters.sweeps.add(std::uint64_t(result.sweeps));
  counters.sweeps_per_tick.add(result.sweeps);
  counters.residual.add(result.residual);
  if (result.residual > settings.residual_goal) counters.unconverged_ticks.add(1);
}

// What the contacts do to the hand: H^T f, by the points where the tool is now.
Wrench HapticChannel::State::wrench(const RigidPlacement& handle, const JawPoses& poses) const {
  Vec3 force = Vec3::Zero(), torque = Vec3::Zero();
  double opening = 0;
  const ToolProblem& problem = solver.problem()->problem;
  for (std::size_t i = 0; i < problem.contacts.size(); ++i) {
    const float* f = solver.force().data() + 3 * i;
    if (f[0] == 0 && f[1] == 0 && f[2] == 0) continue;
    const ToolContact& c = problem.contacts[i];
    for (const auto& [touch, sign] : {std::pair(&c.a, 1.0), std::pair(&c.b, -1.0)}) {
      if (touch->jaw < 0) continue;
      const auto jaw = std::size_t(touch->jaw);
      const Vec3 push = sign * (c.frame * Vec3(f[0], f[1], f[2]));
      const Vec3 point = poses[jaw].rotation * touch->local + poses[jaw].translation;
      force += push;
      torque += (point - handle.translation).cross(push);
      opening += tool.hinge_turn(jaw, handle).dot((point - tool.hinge_point(jaw, handle)).cross(push));
    }
  }
  return {as_point(force), as_point(torque), opening};
}

void HapticChannel::State::count_step(const Wrench& next, bool handed_over) {
  const double step = distance(next.force_n, sent.force_n);
  counters.largest_force_n.raise_to(as_vec3(next.force_n).norm());
  counters.largest_step_n.raise_to(step);
  if (!handed_over) return;
  counters.largest_hand_over_step_n.raise_to(step);
  counters.hand_over_step_n.add(step);
}

Wrench HapticChannel::State::tick(const DeviceSample* sample) {
  const auto start = ToolSolver::Clock::now();
  const bool bounded = settings.tick_budget_s < 1e6;
  const auto budget =
      std::chrono::nanoseconds(bounded ? std::int64_t(settings.tick_budget_s * 1e9) : 0);
  const auto deadline = bounded ? start + budget : ToolSolver::Clock::time_point::max();
  auto solved = start;
  const double passed = take_sample(sample);
  now_s += passed;
  const bool handed_over = take_problem();
  lawful = {};
  last_residual = 0;
  // A problem from before the device was somewhere else says nothing.
  const bool speaks = solver.problem() && solver.problem()->recoveries == counters.recoveries.get();
  if (guard.has_sample() && speaks && !solver.empty()) {
    const DeviceSample hand = lead.ahead();
    const RigidPlacement handle = placement(hand.pose);
    JawPoses poses;
    for (std::size_t jaw = 0; jaw < tool.jaw_count(); ++jaw)
      poses[jaw] = tool.jaw_pose(jaw, handle, hand.opening_rad);
    if (!solver.move_to(poses, settings.reach_m)) counters.clamped_ticks.add(1);
    // Kept: for what follows the solver as long as it lately took, and a fiftieth for what the last
    // look at the clock does not see.
    solve(bounded ? deadline - std::min(closing, budget / 4) - budget / 50 : deadline);
    solved = ToolSolver::Clock::now();
    lawful = wrench(handle, poses);
  } else {
    counters.idle_ticks.add(1);
  }
  const bool alive = now_s - arrived_s <= settings.dead_after_s;
  if (!alive) counters.dead_ticks.add(1);
  const Wrench next = shaper.shape(lawful, passed, alive);
  if (shaper.was_limited()) counters.limited_ticks.add(1);
  count_step(next, handed_over);
  sent = next;
  const std::size_t active = solver.problem() ? solver.active_count() : 0;
  counters.active_contacts.set(active);
  counters.active_sum.add(active);
  counters.contact_sum.add(counters.contacts.get());
  const auto end = ToolSolver::Clock::now();
  const auto took = end - start;
  if (solved != start) closing = (7 * closing + (end - solved)) / 8;
  counters.tick_time_s.add(std::chrono::duration<double>(took).count());
  if (bounded && took > budget) counters.deadline_misses.add(1);
  counters.ticks.add(1);
  return sent;
}

}  // namespace souple
