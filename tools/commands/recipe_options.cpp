// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/commands/recipe_options.hpp"

#include <algorithm>

#include "tools/recipe/recipe_parameters.hpp"

namespace souple {

void RecipeOptions::add_to(CLI::App& app, std::span<const std::string_view> keys) {
  app.add_option("--recipe", recipe_file_, "TOML file; options win over its keys");
  values_.resize(recipe_parameters().size());
  for (std::size_t i = 0; i < values_.size(); ++i) {
    const RecipeParameter& parameter = recipe_parameters()[i];
    if (!keys.empty() && std::ranges::find(keys, parameter.key) == keys.end()) continue;
    app.add_option(std::string(parameter.option), values_[i], std::string(parameter.help));
  }
}

Result<Recipe> RecipeOptions::recipe(const Recipe& base) const {
  Result<Recipe> recipe = base;
  if (!recipe_file_.empty()) recipe = read_recipe(recipe_file_, base);
  if (!recipe) return recipe;
  std::vector<RecipeOverride> overrides;
  for (std::size_t i = 0; i < values_.size(); ++i)
    if (values_[i]) overrides.emplace_back(&recipe_parameters()[i], *values_[i]);
  if (auto status = override_recipe(*recipe, overrides); !status) return status.issue();
  return recipe;
}

}  // namespace souple
