// SPDX-License-Identifier: GPL-3.0-or-later
// souple repair SURFACE [-o OUT]: what is wrong with a surface, and a solid made of it.
#include "tools/surface/repair.hpp"

#include "tools/cli/command_line.hpp"
#include "tools/commands/mesh_json.hpp"
#include "tools/commands/recipe_options.hpp"
#include "tools/exchange/mesh_writer.hpp"
#include "tools/recipe/stage_options.hpp"

namespace souple {
namespace {

struct RepairOptionsGiven {
  std::string surface, output;
  RecipeOptions keys;

  void add_to(CLI::App& app) {
    static constexpr std::array<std::string_view, 4> used{"unit", "size_m", "repair", "max_error_m"};
    app.add_option("SURFACE", surface, "OBJ, OFF, PLY, STL, glTF, FBX, Collada or 3DS file")
        ->required();
    app.add_option("-o,--output", output,
                   "the solid to write, " + surface_extensions() + "; without it the triage is all");
    keys.add_to(app, used);
  }
};

struct Outcome {
  ImportReport import;
  SurfaceTriage triage;
  std::optional<RepairReport> repair;
};

Result<Outcome> carry_out(const RepairOptionsGiven& given, const Recipe& recipe) {
  auto imported = import_surface(given.surface, import_options(recipe));
  if (!imported) return imported.issue();
  Outcome outcome;
  outcome.import = imported->report;
  if (given.output.empty()) {
    auto triage = triage_surface(imported->mesh);
    if (!triage) return triage.issue();
    outcome.triage = std::move(*triage);
    return outcome;
  }
  auto repaired = repair_surface(imported->mesh, repair_options(recipe));
  if (!repaired) return repaired.issue();
  if (auto status = write_surface(repaired->mesh, given.output); !status) return status.issue();
  outcome.triage = repaired->report.before;
  outcome.repair = std::move(repaired->report);
  return outcome;
}

Json outcome_json(const RepairOptionsGiven& given, const Outcome& outcome) {
  Json document = schema_header("repair");
  document["input"] = given.surface;
  document["output"] = given.output.empty() ? Json() : Json(given.output);
  document["import"] = import_json(outcome.import);
  document["triage"] = triage_json(outcome.triage);
  document["repair"] = outcome.repair ? repair_json(*outcome.repair) : Json();
  return document;
}

}  // namespace

Result<ExitCode> run_repair(const Arguments& arguments) {
  RepairOptionsGiven given;
  CommandLine line("repair",
                   "Looks what is wrong with a surface and makes a closed, oriented, manifold solid of "
                   "it. Coordinates are written in metres.");
  given.add_to(line.app());
  const auto parsed = line.parse(arguments);
  if (!parsed) return parsed.issue();
  if (*parsed == ParseOutcome::help_printed) return ExitCode::ok;
  const auto recipe = given.keys.recipe();
  if (!recipe) return recipe.issue();
  if (!given.output.empty())
    if (auto status = check_surface_output(given.output); !status) return status.issue();
  const auto outcome = carry_out(given, *recipe);
  if (!outcome) return outcome.issue();
  std::string text = given.surface + ": " + triage_text(outcome->triage);
  if (outcome->repair) text += given.output + ":\n" + repair_text(*outcome->repair);
  const Status printed = line.common().json    ? print_json(outcome_json(given, *outcome))
                         : line.common().quiet ? Status{}
                                               : print_data(text);
  if (!printed) return printed.issue();
  return ExitCode::ok;
}

}  // namespace souple
