// SPDX-License-Identifier: GPL-3.0-or-later
// souple precompute HIERARCHY -o ASSET: the compliances of a recipe for an asset whose mesh stands.
#include <array>

#include "formats/read/asset_reader.hpp"
#include "formats/read/validate.hpp"
#include "tools/cli/command_line.hpp"
#include "tools/cli/json_output.hpp"
#include "tools/cli/version.hpp"
#include "tools/commands/asset_json.hpp"
#include "tools/commands/bake_json.hpp"
#include "tools/commands/compliance_options.hpp"
#include "tools/commands/compliance_stage.hpp"
#include "tools/commands/console_progress.hpp"
#include "tools/commands/recipe_options.hpp"
#include "tools/exchange/atomic_file.hpp"
#include "tools/exchange/numbers.hpp"
#include "tools/recipe/asset_recipe.hpp"

namespace souple {
namespace {

struct PrecomputeOptions {
  std::string input, output;
  RecipeOptions keys;
  ComplianceOptions compliances;

  void add_to(CLI::App& app) {
    static constexpr std::array<std::string_view, 5> used{
        "young_pa", "poisson", "density", "rayleigh_mass_per_s", "rayleigh_stiffness_s"};
    app.add_option("HIERARCHY", input, "a .souple file, of `souple hierarchy` or any other")
        ->required();
    app.add_option("-o,--output", output, "the .souple file to write")->required();
    keys.add_to(app, used);
    compliances.add_to(app);
  }
};

/// The first thing wrong with the file, or all of it.
Result<Asset> read_sound_asset(const std::string& file) {
  const ValidationReport report = validate_asset_file(file);
  for (const Issue& issue : report.issues)
    if (issue.severity == Severity::error) return issue;
  auto reader = AssetReader::open(file);
  if (!reader) return reader.issue();
  return read_asset(*reader);
}

/// The report of a bake without what belongs to the making of a mesh.
Json precompute_json(const BakeOutcome& outcome, const PrecomputeOptions& given) {
  Json document = bake_json(outcome, given.output);
  document["schema"] = "souple.precompute";
  for (const char* key : {"import", "import_tets", "repair", "decimate", "coarse_mesh", "levels",
                          "visual", "regions", "finest_quality", "box_m"})
    document.erase(key);
  document["input"] = given.input;
  return document;
}

std::string summary_text(const BakeOutcome& outcome, const std::string& file) {
  std::string text = file + ": " + bytes_text(outcome.report.asset_bytes) + "\n";
  for (const auto& variant : outcome.asset.compliances) text += compliance_text(variant.header) + "\n";
  return text;
}

/// The body of the asset with the recipe's compliances, written.
Result<BakeOutcome> make(const PrecomputeOptions& given, Console& console, bool json) {
  auto asset = read_sound_asset(given.input);
  if (!asset) return asset.issue();
  auto recipe = given.keys.recipe(recipe_of(*asset));
  if (!recipe) return recipe.issue();
  if (auto status = given.compliances.apply(*recipe); !status) return status.issue();
  if (auto status = apply_recipe(*recipe, *asset); !status) return status.issue();
  auto stage = given.compliances.stage();
  if (!stage) return stage.issue();
  asset->provenance.generator = "souple " + std::string(program_version);
  console.detail("effective recipe:\n" + asset->provenance.recipe);
  ConsoleProgress progress(console);
  BakeOutcome outcome = outcome_of(std::move(*asset), *recipe);
  if (auto status = run_compliance_stage(outcome, *recipe, std::move(*stage), progress, console, json);
      !status)
    return status.issue();
  if (auto status = write_held(outcome, given.output, progress); !status) return status.issue();
  return outcome;
}

}  // namespace

Result<ExitCode> run_precompute(const Arguments& arguments) {
  PrecomputeOptions given;
  CommandLine line(
      "precompute",
      "An asset gets the compliances of a recipe. Its mesh stays; [material] of the recipe "
      "replaces the asset's key by key, [[fixed]] joins or replaces its sets by their "
      "names, [surface] and [mesh] mean nothing, and compliances it had are dropped.");
  given.add_to(line.app());
  const auto parsed = line.parse(arguments);
  if (!parsed) return parsed.issue();
  if (*parsed == ParseOutcome::help_printed) return ExitCode::ok;
  if (auto status = check_output_file(given.output); !status) return status.issue();
  Console console(line.common().verbosity());
  const auto outcome = make(given, console, line.common().json);
  console.end_progress();
  if (!outcome) return outcome.issue();
  for (const std::string& note : outcome->report.notes) console.say("note: " + note);
  const Status printed = line.common().json    ? print_json(precompute_json(*outcome, given))
                         : line.common().quiet ? Status{}
                                               : print_data(summary_text(*outcome, given.output));
  if (!printed) return printed.issue();
  return ExitCode::ok;
}

}  // namespace souple
