// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/scene/simulation.hpp"

#define XXH_INLINE_ALL
#include <xxhash.h>

#include <algorithm>
#include <array>

#include "runtime/world/soft_body_asset.hpp"
#include "tools/scene/frame_writer.hpp"

namespace souple {
namespace {

constexpr std::int64_t sample_limit = 2000;

/// Member of PhaseTimes behind every name in the report.
constexpr std::array<std::pair<const char*, double PhaseTimes::*>, 6> phase_members{{
    {"free_motion", &PhaseTimes::free_motion_s},
    {"collision", &PhaseTimes::collision_s},
    {"compliance", &PhaseTimes::compliance_s},
    {"contact_solve", &PhaseTimes::contact_solve_s},
    {"correction", &PhaseTimes::correction_s},
    {"total", &PhaseTimes::total_s},
}};

double quantile(std::vector<double>& values, double q) {
  if (values.empty()) return 0;
  const auto at =
      values.begin() + static_cast<std::ptrdiff_t>(q * static_cast<double>(values.size() - 1) + 0.5);
  std::ranges::nth_element(values, at);
  return *at;
}

std::vector<PhaseStatistics> phase_statistics(const std::vector<PhaseTimes>& times) {
  std::vector<PhaseStatistics> all;
  std::vector<double> values(times.size());
  for (const auto& [name, member] : phase_members) {
    PhaseStatistics s;
    s.phase = name;
    for (std::size_t i = 0; i < times.size(); ++i) {
      values[i] = times[i].*member;
      s.sum_s += values[i];
    }
    s.median_s = quantile(values, 0.5);
    s.p95_s = quantile(values, 0.95);
    all.push_back(s);
  }
  return all;
}

/// Feeds the state of all bodies, in their order, to the hash.
std::string hash_state(const SceneWorld& built) {
  XXH3_state_t* state = XXH3_createState();
  if (state == nullptr) return {};
  XXH3_128bits_reset(state);
  for (const BodyId body : built.bodies) {
    if (built.world.is_soft(body)) {
      for (const auto points : {built.world.positions(body), built.world.velocities(body)})
        XXH3_128bits_update(state, points.data(), points.size_bytes());
    } else {
      const Pose pose = built.world.rigid_pose(body);
      XXH3_128bits_update(state, pose.rotation.data(), sizeof pose.rotation);
      XXH3_128bits_update(state, pose.translation.data(), sizeof pose.translation);
      for (const Point& rate :
           {built.world.rigid_velocity(body), built.world.rigid_angular_velocity(body)})
        XXH3_128bits_update(state, rate.data(), sizeof rate);
    }
  }
  XXH128_canonical_t canonical;
  XXH128_canonicalFromHash(&canonical, XXH3_128bits_digest(state));
  XXH3_freeState(state);
  std::string hex;
  for (const unsigned char byte : canonical.digest) {
    hex += "0123456789abcdef"[byte >> 4];
    hex += "0123456789abcdef"[byte & 15];
  }
  return hex;
}

Point summed_contact_force(const SceneWorld& built) {
  Point sum{};
  for (const ContactRecord& contact : built.world.contacts()) {
    // Between two soft bodies the force is internal.
    if (built.world.is_soft(contact.body_a) == built.world.is_soft(contact.body_b)) continue;
    const double sign = built.world.is_soft(contact.body_a) ? 1 : -1;
    for (std::size_t axis = 0; axis < 3; ++axis) sum[axis] += sign * contact.force_n[axis];
  }
  return sum;
}

EventCounts count_events(const World& world) {
  EventCounts counts;
  for (const ContactEvent& event : world.contact_events()) {
    if (event.kind == ContactEventKind::begin) ++counts.begin;
    if (event.kind == ContactEventKind::persist) ++counts.persist;
    if (event.kind == ContactEventKind::end) ++counts.end;
  }
  return counts;
}

double soft_mass(const SceneWorld& built) {
  double mass = 0;
  for (const BodyId body : built.bodies)
    if (built.world.is_soft(body)) mass += built.world.asset(body).model().total_mass();
  return mass;
}

class Collector {
 public:
  explicit Collector(std::int64_t step_count) {
    report.steps_asked = step_count;
    report.sample_stride = (step_count + sample_limit - 1) / sample_limit;
    times_.reserve(static_cast<std::size_t>(step_count));
  }

  void add(const StepReport& step, const World& world) {
    const double time_s = world.time_s();
    const std::int64_t number = ++report.steps_done;
    times_.push_back(step.times);
    contact_sum_ += static_cast<double>(step.contact_count);
    report.largest_contact_count = std::max(report.largest_contact_count, step.contact_count);
    report.penetration_m.meet(step.worst_penetration_m, number);
    report.surface_depth_m.meet(step.worst_surface_depth_m, number);
    report.cone_violation.meet(step.cone_violation, number);
    report.contact_residual.meet(step.contact_residual, number);
    report.free_motion_residual.meet(step.free_motion_residual, number);
    report.joint_error_m.meet(step.worst_joint_error_m, number);
    report.contact_sweeps.meet(step.contact_sweeps, number);
    report.unconverged_count.meet(step.unconverged_count, number);
    report.last = step;
    report.last_events = count_events(world);
    report.events.begin += report.last_events.begin;
    report.events.persist += report.last_events.persist;
    report.events.end += report.last_events.end;
    report.simulated_s = time_s;
    if (number % report.sample_stride == 0)
      report.samples.push_back({number, time_s, step, report.last_events});
  }

  void finish(const SceneWorld& built) {
    report.phases = phase_statistics(times_);
    const double total_s = report.phases.back().sum_s;
    if (total_s > 0) report.steps_per_s = static_cast<double>(report.steps_done) / total_s;
    if (report.steps_done > 0)
      report.mean_contact_count = contact_sum_ / static_cast<double>(report.steps_done);
    report.contact_force_n = summed_contact_force(built);
    report.soft_mass_kg = soft_mass(built);
    report.state_hash = hash_state(built);
  }

  SimulationReport report;

 private:
  std::vector<PhaseTimes> times_;
  double contact_sum_ = 0;
};

Status step_once(const Scene& scene, SceneWorld& built, const SimulationOptions& options,
                 FrameWriter& frames, Collector& collector, std::vector<ProbeRun>& probes) {
  if (auto status = drive_grabs(scene, built); !status) return status;
  for (ProbeRun& probe : probes)
    if (auto status = probe.begin_step(built.world); !status) return status;
  const auto step = built.world.step();
  if (!step) return step.issue();
  for (ProbeRun& probe : probes)
    if (auto status = probe.end_step(built.world); !status) return status;
  collector.add(*step, built.world);
  if (options.after_step)
    if (auto status = options.after_step(collector.report.steps_done); !status) return status;
  if (collector.report.steps_done % scene.output.frames_every != 0) return {};
  return frames.write_frame();
}

Status make_probes(const Scene& scene, const SceneWorld& built, std::vector<ProbeRun>& probes) {
  for (std::size_t k = 0; k < scene.probes.size(); ++k) {
    auto probe = ProbeRun::create(scene.probes[k], built.tools[k]);
    if (!probe) return probe.issue();
    probes.push_back(std::move(*probe));
  }
  return {};
}

}  // namespace

void Worst::meet(double candidate, std::int64_t at_step) {
  if (!(candidate > value)) return;
  value = candidate;
  step = at_step;
}

SimulationReport run_simulation(const Scene& scene, SceneWorld& built,
                                const SimulationOptions& options) {
  Collector collector(options.step_count);
  SimulationReport& report = collector.report;
  FrameWriter frames(scene, built, options.folder);
  Status status = frames.prepare();
  if (status) status = frames.write_frame();
  std::vector<ProbeRun> probes;
  if (status) status = make_probes(scene, built, probes);
  while (status && report.steps_done < options.step_count) {
    if (options.interrupted && options.interrupted()) {
      report.interrupted = true;
      break;
    }
    status = step_once(scene, built, options, frames, collector, probes);
    if (options.progress) options.progress(report.steps_done);
  }
  const Status listed = frames.finish();
  if (!status)
    report.failure = status.issue();
  else if (!listed)
    report.failure = listed.issue();
  report.frame_count = frames.frame_count();
  for (const ProbeRun& probe : probes) report.probes.push_back(probe.report());
  collector.finish(built);
  return report;
}

}  // namespace souple
