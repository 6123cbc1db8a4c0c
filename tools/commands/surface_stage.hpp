// SPDX-License-Identifier: GPL-3.0-or-later
// What the verbs of single stages share: a mesh file in, a mesh file out, keys of a recipe between.
#pragma once
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "tools/cli/command_line.hpp"
#include "tools/cli/json_output.hpp"
#include "tools/commands/recipe_options.hpp"
#include "tools/surface/import_surface.hpp"

namespace souple {

class SurfaceStage {
 public:
  SurfaceStage(const std::string& verb, const std::string& summary, std::vector<std::string_view> keys,
               const std::string& output_help,
               Status (*check_output)(const std::filesystem::path& file));

  CommandLine& line() { return line_; }
  /// Parses, reads the recipe and checks that `output` could be written.
  Result<ParseOutcome> parse(const Arguments& arguments);
  const Recipe& recipe() const { return recipe_; }
  const std::string& output() const { return output_; }
  Result<ImportedSurface> import() const;
  /// The report on stdout: JSON or text, nothing with --quiet.
  Result<ExitCode> print(Json document, const std::string& text);

 private:
  CommandLine line_;
  std::string verb_, surface_, output_;
  Status (*check_output_)(const std::filesystem::path& file);
  RecipeOptions keys_;
  Recipe recipe_;
};

}  // namespace souple
