// SPDX-License-Identifier: GPL-3.0-or-later
// Options of the command line that are keys of a recipe.
#pragma once
#include <CLI/CLI.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "formats/core/result.hpp"
#include "tools/recipe/recipe.hpp"

namespace souple {

class RecipeOptions {
 public:
  /// Options for the keys named ("tets", "size_m"), or for all of them if none is; and --recipe.
  void add_to(CLI::App& app, std::span<const std::string_view> keys = {});
  /// The recipe's file, if one was given, on top of `base` and under the options. Not yet checked as a
  /// whole.
  Result<Recipe> recipe(const Recipe& base = {}) const;

 private:
  std::string recipe_file_;
  std::vector<std::optional<std::string>> values_;  ///< by the index of recipe_parameters()
};

}  // namespace souple
