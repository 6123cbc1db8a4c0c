// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>

#include "formats/core/asset.hpp"
#include "formats/core/result.hpp"
#include "tools/recipe/recipe.hpp"

namespace souple {

/// The recipe that an asset was made by, as far as its provenance tells, with the asset's own material;
/// without regions, fixed sets and compliances: what a recipe for `precompute` is read on top of.
Recipe recipe_of(const Asset& asset);

/// What a recipe says of a body whose mesh stands: the material becomes the recipe's, its fixed sets
/// join the asset's or replace those of their name, and all compliances go. Its [surface] and [mesh]
/// mean nothing here. `recipe` was read on top of recipe_of(asset); afterwards it is the effective one
/// and in the provenance. Issues: recipe_not_for_asset, fixed_set_invalid, config_bad_value.
Status apply_recipe(Recipe& recipe, Asset& asset);

}  // namespace souple
