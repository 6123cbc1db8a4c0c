// SPDX-License-Identifier: GPL-3.0-or-later
// souple decimate SURFACE -o OUT: a surface of fewer triangles.
#include "tools/surface/decimate.hpp"

#include "tools/commands/mesh_json.hpp"
#include "tools/commands/surface_stage.hpp"
#include "tools/exchange/mesh_writer.hpp"
#include "tools/exchange/numbers.hpp"
#include "tools/surface/prepare.hpp"

namespace souple {
namespace {

Result<DecimateOptions> options_of(const std::string& faces, const Recipe& recipe) {
  DecimateOptions options;
  options.max_error_m = recipe.mesh.max_error_m;
  if (!faces.empty()) {
    const auto count = integer_option("--faces", faces, 4, 1'000'000'000);
    if (!count) return count.issue();
    options.target_face_count = static_cast<std::size_t>(*count);
  }
  if (options.target_face_count == 0 && !(options.max_error_m > 0))
    return make_issue(IssueCode::usage_missing_argument, "how far to go was not said",
                      "--faces, --max-error-m", "Give a count of faces, a largest error, or both.");
  return options;
}

std::string text_of(const std::string& output, const DecimateReport& r) {
  std::string text = output + ": " + std::to_string(r.face_count_before) + " -> " +
                     std::to_string(r.face_count_after) + " faces, volume " +
                     rounded_text(100 * (r.volume_after_m3 / r.volume_before_m3 - 1), 2) +
                     " %, moved " + rounded_text(r.hausdorff_m, 3) + " m at most\n";
  for (const std::string& note : r.notes) text += "  " + note + "\n";
  return text;
}

}  // namespace

Result<ExitCode> run_decimate(const Arguments& arguments) {
  SurfaceStage stage("decimate",
                     "Fewer triangles, the same volume; closed and manifold as the input must be. "
                     "Coordinates are written in metres.",
                     {"max_error_m"}, "the surface to write, " + surface_extensions(),
                     check_surface_output);
  std::string faces;
  stage.line().app().add_option("--faces", faces, "so many faces at most");
  const auto parsed = stage.parse(arguments);
  if (!parsed) return parsed.issue();
  if (*parsed == ParseOutcome::help_printed) return ExitCode::ok;
  const auto options = options_of(faces, stage.recipe());
  if (!options) return options.issue();
  auto imported = stage.import();
  if (!imported) return imported.issue();
  const auto oriented = orient_closed_surface(imported->mesh);
  if (!oriented) return oriented.issue();
  const auto decimated = decimate_surface(oriented->mesh, *options);
  if (!decimated) return decimated.issue();
  if (auto status = write_surface(decimated->mesh, stage.output()); !status) return status.issue();
  return stage.print(
      {{"import", import_json(imported->report)}, {"decimate", decimate_json(decimated->report)}},
      text_of(stage.output(), decimated->report));
}

}  // namespace souple
