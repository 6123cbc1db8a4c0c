// SPDX-License-Identifier: GPL-3.0-or-later
// souple bake SURFACE -o ASSET: the whole pipeline.
#include "tools/recipe/bake.hpp"

#include <filesystem>
#include <string>

#include "tools/cli/command_line.hpp"
#include "tools/cli/json_output.hpp"
#include "tools/cli/signals.hpp"
#include "tools/cli/version.hpp"
#include "tools/commands/bake_json.hpp"
#include "tools/commands/compliance_options.hpp"
#include "tools/commands/compliance_stage.hpp"
#include "tools/commands/console_progress.hpp"
#include "tools/commands/mesh_json.hpp"
#include "tools/commands/recipe_options.hpp"
#include "tools/exchange/atomic_file.hpp"
#include "tools/exchange/numbers.hpp"
#include "tools/recipe/partial_bake.hpp"

namespace souple {
namespace {

struct BakeOptions {
  std::string surface_file;
  std::string asset_file;
  RecipeOptions keys;
  ComplianceOptions compliances;
  bool no_resume = false;

  void add_to(CLI::App& app) {
    app.add_option(
        "SURFACE", surface_file,
        "a surface (OBJ, OFF, PLY, STL, glTF, FBX, Collada, 3DS) or a tet mesh (gmsh, medit, "
        "VTK, VTU, TetGen, Vega)");
    app.add_option("-o,--output", asset_file, "the .souple file to write")->required();
    keys.add_to(app);
    compliances.add_to(app);
    app.add_flag("--no-resume", no_resume,
                 "start anew, whatever an interrupted bake left in OUTPUT.partial");
  }

  Result<Recipe> recipe() const {
    Result<Recipe> recipe = keys.recipe();
    if (!recipe) return recipe;
    if (auto status = compliances.apply(*recipe); !status) return status.issue();
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

/// The body, made or taken from what an interrupted bake of the same kept.
Result<BakeOutcome> body_of(const Recipe& recipe, const PartialBake& partial, bool resume,
                            const std::string& generator, ProgressSink& progress) {
  auto kept = resume ? partial.find() : make_issue(IssueCode::io_file_missing, "");
  if (!kept) {
    auto outcome = bake_body(recipe, generator, progress);
    if (outcome && resume && kept.issue().code != IssueCode::io_file_missing)
      outcome->report.notes.push_back("made anew, because " + partial.file().string() +
                                      " cannot be used: " + kept.issue().what);
    return outcome;
  }
  BakeOutcome outcome = outcome_of(std::move(*kept), recipe);
  outcome.report.notes.push_back("the mesh and " + std::to_string(outcome.asset.compliances.size()) +
                                 " compliances were taken from " + partial.file().string());
  return outcome;
}

/// Everything up to the asset in memory.
Result<BakeOutcome> make(const BakeOptions& given, const Recipe& recipe, Console& console,
                         ProgressSink& progress, bool json) {
  auto stage = given.compliances.stage();
  if (!stage) return stage.issue();
  const std::string generator = "souple " + std::string(program_version);
  const PartialBake partial(given.asset_file, recipe, generator, stage->memory_limit_bytes);
  auto outcome = body_of(recipe, partial, !given.no_resume, generator, progress);
  if (!outcome) return outcome;
  stage->keep = [&](Asset& unfinished) {
    const HeldSignals held;
    return partial.keep(unfinished);
  };
  const auto kept = [&] {
    std::error_code error;
    return std::filesystem::exists(partial.file(), error)
               ? "finished stages are kept in " + partial.file().string()
               : std::string();
  };
  const Status added =
      run_compliance_stage(*outcome, recipe, std::move(*stage), progress, console, json, kept);
  if (!added) return added.issue();
  if (auto status = write_held(*outcome, given.asset_file, progress); !status) return status.issue();
  partial.remove();
  return outcome;
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
  const auto outcome = make(given, *recipe, console, progress, line.common().json);
  if (!outcome) return outcome.issue();
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
