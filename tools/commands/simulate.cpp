// SPDX-License-Identifier: GPL-3.0-or-later
// souple simulate SCENE --steps N -o FOLDER: runs a scene without a window.
#include <cmath>

#include "tools/cli/command_line.hpp"
#include "tools/cli/json_output.hpp"
#include "tools/cli/signals.hpp"
#include "tools/commands/contact_dump.hpp"
#include "tools/commands/probe_json.hpp"
#include "tools/commands/simulation_json.hpp"
#include "tools/exchange/atomic_file.hpp"
#include "tools/exchange/numbers.hpp"
#include "tools/recipe/rigid_surface.hpp"
#include "tools/scene/job_pool.hpp"
#include "tools/scene/simulation.hpp"

namespace souple {
namespace {

constexpr std::int64_t most_threads = 256;

struct SimulateOptions {
  std::string scene_file;
  std::string steps;
  std::string folder;
  std::string threads = "1";
  std::vector<std::string> dumps;

  void add_to(CLI::App& app) {
    app.add_option("SCENE", scene_file, "the scene, TOML")->required();
    app.add_option("--steps", steps, "how many steps to run")->required();
    app.add_option("-o,--output", folder, "folder for frames, scene.pvd and report.json")->required();
    app.add_option("--threads", threads,
                   "threads that step the bodies (1); the result does not depend on them");
    app.add_option(
        "--dump-contact", dumps,
        "STEP=FILE.hdf5: write the contact problem of that step in FCLIB's local layout; may "
        "be given for several steps");
  }
};

std::string microseconds(double seconds) { return rounded_text(1e6 * seconds, 3) + " us"; }

std::string summary_text(const SimulationReport& r) {
  std::string text = std::to_string(r.steps_done) + " of " + std::to_string(r.steps_asked) +
                     " steps, " + rounded_text(r.simulated_s, 6) + " s of simulated time, " +
                     std::to_string(r.frame_count) + " frames\n";
  text += rounded_text(r.steps_per_s, 4) + " steps/s; median per step:";
  for (const PhaseStatistics& phase : r.phases)
    text += " " + phase.phase + " " + microseconds(phase.median_s);
  text += "\ncontacts: at most " + std::to_string(r.largest_contact_count) + ", last step " +
          std::to_string(r.last.contact_count) + " (" + std::to_string(r.last.active_count) +
          " carrying force)\n";
  text += "penetration: worst " + rounded_text(r.penetration_m.value, 3) + " m at vertices, " +
          rounded_text(r.surface_depth_m.value, 3) + " m of the surface; last step " +
          rounded_text(r.last.worst_penetration_m, 3) + " and " +
          rounded_text(r.last.worst_surface_depth_m, 3) + " m\n";
  text += "laws: worst cone violation " + rounded_text(r.cone_violation.value, 3) +
          ", contact residual " + rounded_text(r.contact_residual.value, 3) + "\n";
  text += "last step: kinetic energy " + rounded_text(r.last.kinetic_energy_j, 3) +
          " J, elastic energy " + rounded_text(r.last.elastic_energy_j, 3) + " J\n";
  for (const ProbeReport& probe : r.probes) text += probe_line(probe);
  return text + "state " + r.state_hash + "\n";
}

Result<TriangleMesh> load_rigid_mesh(const RigidMeshFile& mesh) {
  return read_rigid_surface(mesh.file, mesh.scale, mesh.size_m);
}

Result<std::vector<ContactDump>> parse_dumps(const std::vector<std::string>& texts,
                                             std::int64_t step_count) {
  std::vector<ContactDump> dumps;
  for (const std::string& text : texts) {
    auto dump = parse_contact_dump(text, step_count);
    if (!dump) return dump.issue();
    dumps.push_back(std::move(*dump));
  }
  return dumps;
}

Status write_dumps(const World& world, const std::vector<ContactDump>& dumps, std::int64_t step) {
  for (const ContactDump& dump : dumps)
    if (dump.step == step)
      if (auto status = write_contact_dump(world, dump); !status) return status;
  return {};
}

/// Runs with SIGINT answered between steps, so that the report of an interrupted run is whole.
SimulationReport run(const Scene& scene, SceneWorld& built, SimulationOptions options, Console& console,
                     const InterruptFlag& interrupt) {
  options.interrupted = [&] { return interrupt.raised(); };
  options.progress = [&](std::int64_t done) {
    console.progress("simulate", static_cast<double>(done) / static_cast<double>(options.step_count));
  };
  SimulationReport report = run_simulation(scene, built, options);
  console.end_progress();
  return report;
}

/// A summary on stdout, or the whole report with --json; both also say what ended the run early.
Status present(const CommandLine& line, const SimulationReport& report, const Json& document) {
  if (line.common().json) return print_json(document);
  if (line.common().quiet) return {};
  return print_data(summary_text(report));
}

}  // namespace

Result<ExitCode> run_simulate(const Arguments& arguments) {
  SimulateOptions given;
  CommandLine line("simulate", "Runs a scene without a window; writes frames and a report.");
  given.add_to(line.app());
  const auto parsed = line.parse(arguments);
  if (!parsed) return parsed.issue();
  if (*parsed == ParseOutcome::help_printed) return ExitCode::ok;
  const auto steps = integer_option("--steps", given.steps, 1, step_count_limit);
  if (!steps) return steps.issue();
  const auto threads = integer_option("--threads", given.threads, 1, most_threads);
  if (!threads) return threads.issue();
  const auto dumps = parse_dumps(given.dumps, *steps);
  if (!dumps) return dumps.issue();
  Console console(line.common().verbosity());

  const auto scene = read_scene(given.scene_file);
  if (!scene) return scene.issue();
  auto built = build_world(*scene, load_rigid_mesh);
  if (!built) return built.issue();
  if (auto status = make_output_folder(given.folder); !status) return status.issue();
  console.detail("loaded " + std::to_string(built->assets.size()) + " assets, " +
                 std::to_string(built->bodies.size()) + " bodies");

  JobPool pool(static_cast<unsigned>(*threads));
  built->world.run_jobs_with(pool.runner());
  const InterruptFlag interrupt;
  SimulationOptions options{*steps, given.folder, {}, {}};
  options.after_step = [&](std::int64_t step) { return write_dumps(built->world, *dumps, step); };
  const SimulationReport report = run(*scene, *built, options, console, interrupt);
  const Json document = simulation_json(*scene, *built, report, given.scene_file);
  const Status written =
      write_file_atomically(std::filesystem::path(given.folder) / "report.json", json_text(document));
  const Status printed = present(line, report, document);
  interrupt.pass_on();
  // The failure of the run is already in the document that --json prints.
  if (report.failure) {
    console.issue(*report.failure);
    return exit_code_of(report.failure->code);
  }
  if (!written) return written.issue();
  if (!printed) return printed.issue();
  console.say("frames, scene.pvd and report.json are in " + given.folder);
  return ExitCode::ok;
}

}  // namespace souple
