// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/commands/surface_stage.hpp"

#include "tools/recipe/stage_options.hpp"

namespace souple {

SurfaceStage::SurfaceStage(const std::string& verb, const std::string& summary,
                           std::vector<std::string_view> keys, const std::string& output_help,
                           Status (*check_output)(const std::filesystem::path& file))
    : line_(verb, summary), verb_(verb), check_output_(check_output) {
  line_.app()
      .add_option("SURFACE", surface_, "OBJ, OFF, PLY, STL, glTF, FBX, Collada or 3DS file")
      ->required();
  line_.app().add_option("-o,--output", output_, output_help)->required();
  keys.insert(keys.end(), {"unit", "size_m"});
  keys_.add_to(line_.app(), keys);
}

Result<ParseOutcome> SurfaceStage::parse(const Arguments& arguments) {
  const auto parsed = line_.parse(arguments);
  if (!parsed || *parsed == ParseOutcome::help_printed) return parsed;
  auto recipe = keys_.recipe();
  if (!recipe) return recipe.issue();
  recipe_ = std::move(*recipe);
  recipe_.surface.file = surface_;
  if (auto status = check_output_(output_); !status) return status.issue();
  return parsed;
}

Result<ImportedSurface> SurfaceStage::import() const {
  return import_surface(surface_, import_options(recipe_));
}

Result<ExitCode> SurfaceStage::print(Json document, const std::string& text) {
  Json whole = schema_header(verb_);
  whole["input"] = surface_;
  whole["output"] = output_;
  whole.update(document);
  const Status printed = line_.common().json    ? print_json(whole)
                         : line_.common().quiet ? Status{}
                                                : print_data(text);
  if (!printed) return printed.issue();
  return ExitCode::ok;
}

}  // namespace souple
