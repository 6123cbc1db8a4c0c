// SPDX-License-Identifier: GPL-3.0-or-later
// souple bake SURFACE -o ASSET: the whole pipeline.
#include "tools/recipe/bake.hpp"

#include <optional>

#include "tools/cli/command_line.hpp"
#include "tools/cli/json_output.hpp"
#include "tools/cli/signals.hpp"
#include "tools/cli/version.hpp"
#include "tools/commands/bake_json.hpp"
#include "tools/commands/console_progress.hpp"
#include "tools/commands/mesh_json.hpp"
#include "tools/commands/recipe_options.hpp"
#include "tools/exchange/atomic_file.hpp"
#include "tools/exchange/numbers.hpp"
#include "tools/recipe/recipe_parameters.hpp"

namespace souple {
namespace {

struct BakeOptions {
  std::string surface_file;
  std::string asset_file;
  RecipeOptions keys;
  std::optional<std::string> time_step_s;
  std::optional<std::string> scalar;

  void add_to(CLI::App& app) {
    app.add_option(
        "SURFACE", surface_file,
        "a surface (OBJ, OFF, PLY, STL, glTF, FBX, Collada, 3DS) or a tet mesh (gmsh, medit, "
        "VTK, VTU, TetGen, Vega)");
    app.add_option("-o,--output", asset_file, "the .souple file to write")->required();
    keys.add_to(app);
    app.add_option("--time-step-s", time_step_s, "time step of the dynamic compliance");
    app.add_option("--scalar", scalar, "of stored compliances: float32 or float64");
  }

  Result<Recipe> recipe() const {
    Result<Recipe> recipe = keys.recipe();
    if (!recipe) return recipe;
    if (auto status = override_compliance(*recipe, time_step_s, scalar); !status) return status.issue();
    if (!surface_file.empty()) recipe->surface.file = surface_file;
    if (auto status = check_recipe(*recipe); !status) return status.issue();
    return recipe;
  }
};

std::string summary_text(const BakeReport& r, const std::string& file) {
  std::string text;
  const LevelReport& finest = r.mesh.levels.back();
  if (r.mesh.repair) text += triage_text(r.mesh.repair->before) + repair_text(*r.mesh.repair);
  text += file + ": " + std::to_string(finest.node_count) + " nodes, " +
          std::to_string(finest.tet_count) + " tets on " + std::to_string(r.mesh.levels.size()) +
          " levels, smallest dihedral angle " + rounded_text(r.finest_quality.min_dihedral_deg, 3) +
          " deg\n";
  text += "longest side " + rounded_text(r.longest_side_m) + " m, rho g L / E " +
          rounded_text(r.sag_ratio, 2) + ", c_p h / L " + rounded_text(r.wave_ratio, 2) + "\n";
  double total = 0;
  for (const StageTime& stage : r.stages) total += stage.wall_s;
  text += bytes_text(r.asset_bytes) + " in " + rounded_text(total, 3) + " s:";
  for (const StageTime& stage : r.stages)
    text += " " + stage.name + " " + rounded_text(stage.wall_s, 2) + " s";
  return text + "; peak memory " + bytes_text(r.peak_memory_bytes) + "\n";
}

/// Held signals: an interrupt waits until the temporary file was renamed or removed.
Status write(BakeOutcome& outcome, const std::string& file, ProgressSink& progress) {
  const HeldSignals held;
  return write_baked_asset(outcome, file, progress);
}

}  // namespace

Result<ExitCode> run_bake(const Arguments& arguments) {
  BakeOptions given;
  CommandLine line("bake", "A surface becomes an asset: mesh, hierarchy and compliances.");
  given.add_to(line.app());
  const auto parsed = line.parse(arguments);
  if (!parsed) return parsed.issue();
  if (*parsed == ParseOutcome::help_printed) return ExitCode::ok;
  Console console(line.common().verbosity());
  const auto recipe = given.recipe();
  if (!recipe) return recipe.issue();
  // Before minutes of work, not after them.
  if (auto status = check_output_file(given.asset_file); !status) return status.issue();
  console.detail("effective recipe:\n" + canonical_recipe_text(*recipe));

  ConsoleProgress progress(console);
  auto outcome = bake_asset(*recipe, "souple " + std::string(program_version), progress);
  if (!outcome) return outcome.issue();
  if (auto status = write(*outcome, given.asset_file, progress); !status) return status.issue();
  console.end_progress();
  for (const std::string& note : outcome->report.notes) console.say("note: " + note);
  const Status printed = line.common().json ? print_json(bake_json(*outcome, given.asset_file))
                         : line.common().quiet
                             ? Status{}
                             : print_data(summary_text(outcome->report, given.asset_file));
  if (!printed) return printed.issue();
  return ExitCode::ok;
}

}  // namespace souple
