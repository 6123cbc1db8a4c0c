// SPDX-License-Identifier: GPL-3.0-or-later
// Steps a scene, writes its frames and collects what a report says about the run.
#pragma once
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "formats/core/result.hpp"
#include "runtime/world/step_report.hpp"
#include "tools/scene/probe_run.hpp"
#include "tools/scene/scene.hpp"
#include "tools/scene/scene_world.hpp"

namespace souple {

inline constexpr std::int64_t step_count_limit = 1'000'000;

struct SimulationOptions {
  std::int64_t step_count = 0;  ///< 1 .. step_count_limit
  std::filesystem::path folder;
  std::function<void(std::int64_t steps_done)> progress;  ///< may be empty
  std::function<bool()> interrupted;                      ///< may be empty; asked between steps
  /// May be empty. After every step, before its frame; an issue ends the run.
  std::function<Status(std::int64_t steps_done)> after_step{};
};

/// Distribution of one phase's wall time over the steps.
struct PhaseStatistics {
  std::string phase;
  double sum_s = 0, median_s = 0, p95_s = 0;
};

struct Worst {
  double value = 0;
  std::int64_t step = 0;  ///< at which it was met, 1-based; 0: never above zero
  void meet(double candidate, std::int64_t at_step);
};

/// Pairs of bodies by what became of their touch in a step.
struct EventCounts {
  std::size_t begin = 0, persist = 0, end = 0;
};

/// Of every `stride`-th step.
struct SimulationSample {
  std::int64_t step = 0;
  double time_s = 0;
  StepReport report;
  EventCounts events;
};

struct SimulationReport {
  std::int64_t steps_asked = 0;
  std::int64_t steps_done = 0;
  bool interrupted = false;
  std::optional<Issue> failure;  ///< of the step after the last one done, or of writing
  std::size_t frame_count = 0;
  double simulated_s = 0;
  double steps_per_s = 0;  ///< steps over the sum of their times; writing and measuring left out
  std::vector<PhaseStatistics> phases;
  std::size_t largest_contact_count = 0;
  double mean_contact_count = 0;
  Worst penetration_m, surface_depth_m, cone_violation, contact_residual, free_motion_residual;
  Worst joint_error_m, contact_sweeps;
  Worst unconverged_count;  ///< solves of a step that missed their tolerance
  StepReport last;
  EventCounts last_events;
  EventCounts events;  ///< of all steps together
  std::int64_t sample_stride = 1;
  std::vector<SimulationSample> samples;  ///< at most about 2000
  Point contact_force_n{};                ///< sum over soft bodies of the last step's contact forces, N
  double soft_mass_kg = 0;
  std::vector<ProbeReport> probes;  ///< in the order of the scene
  std::string state_hash;  ///< XXH3 (128 bits) over all positions, velocities and poses
};

/// Runs to the end, to the first issue or until interrupted; the report tells which. What was written
/// before stays. Does not write the report.
SimulationReport run_simulation(const Scene& scene, SceneWorld& built,
                                const SimulationOptions& options);

}  // namespace souple
