// SPDX-License-Identifier: GPL-3.0-or-later
// souple hierarchy TETS… -o ASSET: levels from given tet meshes; an asset without compliances.
#include "tools/recipe/bake.hpp"

#include "tools/cli/command_line.hpp"
#include "tools/cli/signals.hpp"
#include "tools/cli/version.hpp"
#include "tools/commands/bake_json.hpp"
#include "tools/commands/console_progress.hpp"
#include "tools/commands/mesh_json.hpp"
#include "tools/commands/recipe_options.hpp"
#include "tools/exchange/atomic_file.hpp"

namespace souple {
namespace {

struct HierarchyOptions {
  std::vector<std::string> meshes;
  std::string surface, output;
  RecipeOptions keys;

  void add_to(CLI::App& app) {
    static constexpr std::array<std::string_view, 7> used{"unit",     "size_m", "repair", "levels",
                                                          "diagonal", "fit",    "visual"};
    app.add_option("TETS", meshes,
                   "one tet mesh to refine, or several of one body, coarsest first (gmsh, medit, VTK, "
                   "VTU, TetGen, Vega)")
        ->required();
    app.add_option("--surface", surface,
                   "the surface that finer levels approach; without it the boundary of the tets stays");
    app.add_option("-o,--output", output, "the .souple file to write")->required();
    keys.add_to(app, used);
  }

  Result<Recipe> recipe() const {
    auto recipe = keys.recipe();
    if (!recipe) return recipe;
    recipe->surface.file = surface;
    if (meshes.size() > 1 && recipe->mesh.levels > 0)
      return make_issue(IssueCode::usage_conflict, "several meshes are the levels", "--levels",
                        "Leave it out, or give one mesh to refine.");
    if (meshes.size() == 1 && recipe->mesh.levels == 0) recipe->mesh.levels = 2;
    if (meshes.size() > 1) recipe->mesh.hierarchy = "embedded";
    recipe->compliances.clear();
    return recipe;
  }
};

}  // namespace

Result<ExitCode> run_hierarchy(const Arguments& arguments) {
  HierarchyOptions given;
  CommandLine line("hierarchy",
                   "Tet meshes become the levels of an asset without compliances: one mesh is refined "
                   "(nested), several are embedded in one another.");
  given.add_to(line.app());
  const auto parsed = line.parse(arguments);
  if (!parsed) return parsed.issue();
  if (*parsed == ParseOutcome::help_printed) return ExitCode::ok;
  const auto recipe = given.recipe();
  if (!recipe) return recipe.issue();
  if (auto status = check_output_file(given.output); !status) return status.issue();
  Console console(line.common().verbosity());
  ConsoleProgress progress(console);
  auto outcome = bake_hierarchy({given.meshes.begin(), given.meshes.end()}, *recipe,
                                "souple " + std::string(program_version), progress);
  if (!outcome) return outcome.issue();
  {
    const HeldSignals held;
    if (auto status = write_baked_asset(*outcome, given.output, progress); !status)
      return status.issue();
  }
  console.end_progress();
  const Status printed =
      line.common().json ? print_json(bake_json(*outcome, given.output))
      : line.common().quiet
          ? Status{}
          : print_data(given.output + "\n" + levels_text(outcome->report.mesh.levels));
  if (!printed) return printed.issue();
  return ExitCode::ok;
}

}  // namespace souple
