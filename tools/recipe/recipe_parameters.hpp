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

/// Options of compliances, as text.
struct ComplianceOverrides {
  std::optional<std::string> time_step_s{};  ///< of the one dynamic compliance; with several refused
  std::optional<std::string> tolerance{};    ///< of all; 0: dense
  std::optional<std::string> scalar{};       ///< of all: they become dense
};

/// Issues as above.
Status override_compliances(Recipe& recipe, const ComplianceOverrides& options);

// The same ranges and words in recipes and on the command line.
inline constexpr NumberRange time_step_range{1e-7, 10};
inline constexpr NumberRange tolerance_range{0, 0.5};
std::span<const std::string> scalar_type_names();     ///< in the order of ScalarType
std::span<const std::string> error_norm_names();      ///< in the order of ErrorNorm
std::span<const std::string> compliance_way_names();  ///< auto, dense, by-solves
std::string_view scalar_type_name(ScalarType type);

}  // namespace souple
