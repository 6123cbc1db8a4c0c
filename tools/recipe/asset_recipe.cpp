// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/recipe/asset_recipe.hpp"

#include <algorithm>

#include "formats/core/limits.hpp"
#include "tools/recipe/node_selection.hpp"
#include "tools/recipe/parts.hpp"

namespace souple {
namespace {

bool is_of_the_mesh(const RegionRequest& request) {
  return !std::holds_alternative<BoxSelection>(request.where) &&
         !std::holds_alternative<SphereSelection>(request.where);
}

/// With regions in the recipe the tets are assigned anew; without, they keep theirs.
Status apply_material(const Recipe& recipe, Asset& asset) {
  Material& material = asset.material;
  const MaterialSettings& m = recipe.material;
  material.rayleigh_mass_per_s = m.rayleigh_mass_per_s;
  material.rayleigh_stiffness_s = m.rayleigh_stiffness_s;
  if (recipe.regions.empty()) {
    MaterialRegion& standard = material.regions.front();
    standard = {standard.name, m.young_pa, m.poisson, m.density_kg_m3};
    return {};
  }
  const auto unknown = std::ranges::find_if(recipe.regions, is_of_the_mesh);
  if (unknown != recipe.regions.end())
    return make_issue(IssueCode::recipe_not_for_asset,
                      "the region is selected by a file or a group, which the asset no longer knows",
                      "[[material.region]] " + unknown->name);
  auto assigned = assign_regions(recipe, asset.levels.back().mesh, {}, 1);
  if (!assigned) return assigned.issue();
  material.regions = std::move(assigned->regions);
  material.tet_region = std::move(assigned->tet_region);
  return {};
}

Status apply_fixed_sets(const Recipe& recipe, Asset& asset) {
  for (const FixedRequest& request : recipe.fixed) {
    auto set = select_nodes(request, asset.levels.back().mesh.nodes);
    if (!set) return set.issue();
    const auto same = std::ranges::find(asset.fixed_sets, request.name, &FixedSet::name);
    if (same != asset.fixed_sets.end())
      *same = std::move(*set);
    else
      asset.fixed_sets.push_back(std::move(*set));
  }
  if (asset.fixed_sets.size() <= limits::parts) return {};
  return make_issue(IssueCode::config_bad_value,
                    "more than " + std::to_string(limits::parts) + " fixed sets", "[[fixed]]");
}

/// The requests that the asset's other sets and regions came from stay in the recipe.
void add_old_requests(const Recipe& old, Recipe& recipe) {
  for (const FixedRequest& request : old.fixed)
    if (std::ranges::find(recipe.fixed, request.name, &FixedRequest::name) == recipe.fixed.end())
      recipe.fixed.push_back(request);
  if (recipe.regions.empty()) recipe.regions = old.regions;
}

Result<Recipe> stored_recipe(const Asset& asset) {
  return parse_recipe(asset.provenance.recipe, "the asset's recipe");
}

}  // namespace

Recipe recipe_of(const Asset& asset) {
  const auto stored = stored_recipe(asset);
  Recipe recipe = stored ? *stored : Recipe{};
  recipe.regions.clear();
  recipe.fixed.clear();
  recipe.compliances = {ComplianceRequest{}};
  const MaterialRegion& standard = asset.material.regions.front();
  recipe.material = {standard.young_pa, standard.poisson, standard.density_kg_m3,
                     asset.material.rayleigh_mass_per_s, asset.material.rayleigh_stiffness_s};
  recipe.mesh.levels = static_cast<std::int64_t>(asset.levels.size());
  return recipe;
}

Status apply_recipe(Recipe& recipe, Asset& asset) {
  const Recipe own = recipe_of(asset);
  recipe.surface = own.surface;
  recipe.mesh = own.mesh;
  recipe.refine = own.refine;
  if (auto status = apply_material(recipe, asset); !status) return status;
  if (auto status = apply_fixed_sets(recipe, asset); !status) return status;
  if (const auto stored = stored_recipe(asset)) add_old_requests(*stored, recipe);
  asset.compliances.clear();
  asset.provenance.recipe = canonical_recipe_text(recipe);
  if (asset.provenance.recipe.size() <= limits::text_bytes) return {};
  return make_issue(IssueCode::config_bad_value,
                    "the recipe takes " + std::to_string(asset.provenance.recipe.size()) +
                        " bytes as text; an asset holds " + std::to_string(limits::text_bytes));
}

}  // namespace souple
