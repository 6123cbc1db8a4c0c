// SPDX-License-Identifier: GPL-3.0-or-later
// souple tetrahedralize SURFACE -o OUT: a closed surface filled with tets.
#include "tools/volume/tetrahedralize.hpp"

#include "tools/commands/mesh_json.hpp"
#include "tools/commands/surface_stage.hpp"
#include "tools/exchange/mesh_writer.hpp"
#include "tools/exchange/numbers.hpp"
#include "tools/recipe/parts.hpp"
#include "tools/recipe/stage_options.hpp"
#include "tools/surface/prepare.hpp"

namespace souple {
namespace {

std::string text_of(const std::string& output, const TetrahedralizeReport& r) {
  std::string text = output + ": " + std::to_string(r.node_count) + " nodes, " +
                     std::to_string(r.tet_count) + " tets, smallest dihedral angle " +
                     rounded_text(r.quality.min_dihedral_deg, 3) + " deg, worst aspect " +
                     rounded_text(r.quality.worst_aspect, 3) + "\n  sharp edges " +
                     (r.features.kept ? "kept: " : "not kept: ") + r.features.reason + "\n";
  for (const std::string& note : r.notes) text += "  " + note + "\n";
  return text;
}

}  // namespace

Result<ExitCode> run_tetrahedralize(const Arguments& arguments) {
  SurfaceStage stage(
      "tetrahedralize", "Fills a closed surface with tets. Coordinates are written in metres.",
      {"tets", "edge_length_m", "max_error_m", "mesher", "features", "interior_coarsening"},
      "the tet mesh to write, " + tet_extensions(), check_tets_output);
  const auto parsed = stage.parse(arguments);
  if (!parsed) return parsed.issue();
  if (*parsed == ParseOutcome::help_printed) return ExitCode::ok;
  Recipe recipe = stage.recipe();
  recipe.mesh.levels = 1;
  if (auto status = check_recipe(recipe); !status) return status.issue();
  auto imported = stage.import();
  if (!imported) return imported.issue();
  const auto oriented = orient_closed_surface(imported->mesh);
  if (!oriented) return oriented.issue();
  const auto parts = read_local_sizes(recipe, oriented->mesh, imported->report.scale);
  if (!parts) return parts.issue();
  const auto volume = tetrahedralize(oriented->mesh, mesher_options(recipe, parts->local_sizes, 0));
  if (!volume) return volume.issue();
  if (auto status = write_tets(volume->mesh, {}, stage.output()); !status) return status.issue();
  return stage.print({{"import", import_json(imported->report)},
                      {"tetrahedralize", tetrahedralize_json(volume->report)}},
                     text_of(stage.output(), volume->report));
}

}  // namespace souple
