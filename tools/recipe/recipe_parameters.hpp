// SPDX-License-Identifier: GPL-3.0-or-later
// One table of the scalar keys of a recipe: the parser, the writer and the command line share it.
#pragma once
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "formats/core/result.hpp"
#include "tools/exchange/numbers.hpp"
#include "tools/recipe/recipe.hpp"

namespace souple {

using ParameterTarget = std::variant<double*, std::int64_t*, std::string*>;

struct RecipeParameter {
  std::string_view table;   ///< "mesh"
  std::string_view key;     ///< "tets"
  std::string_view option;  ///< "--tets"
  std::string_view help;
  NumberRange range;                 ///< of numbers
  std::vector<std::string> choices;  ///< of texts
  ParameterTarget (*target)(Recipe&);
};

std::span<const RecipeParameter> recipe_parameters();

/// An option of the command line and its text.
using RecipeOverride = std::pair<const RecipeParameter*, std::string>;

/// Options win over the recipe: `--tets` over an edge length and the other way round.
/// Issues: usage_bad_value, usage_conflict.
Status override_recipe(Recipe& recipe, std::span<const RecipeOverride> options);

/// `--time-step-s`, of the one dynamic compliance of a recipe (with several the recipe itself has to
/// say), and `--scalar`, of all. Issues as above.
Status override_compliance(Recipe& recipe, const std::optional<std::string>& time_step_s,
                           const std::optional<std::string>& scalar);

// The same ranges and words in recipes and on the command line.
inline constexpr NumberRange time_step_range{1e-7, 10};
std::span<const std::string> scalar_type_names();  ///< in the order of ScalarType
std::string_view scalar_type_name(ScalarType type);

}  // namespace souple
