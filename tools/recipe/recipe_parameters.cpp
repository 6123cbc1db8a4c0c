// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/recipe/recipe_parameters.hpp"

#include <algorithm>
#include <array>

#include "tools/exchange/nearest_name.hpp"

namespace souple {
namespace {

// Room for every real body between a cell and a building; keeps products of parameters finite.
constexpr double longest_m = 1e5;

std::vector<RecipeParameter> make_table() {
  return {
      {"surface",
       "unit",
       "--unit",
       "unit of the numbers in the surface file",
       {},
       {"m", "cm", "mm", "um", "km", "in", "ft"},
       [](Recipe& r) { return ParameterTarget(&r.surface.unit); }},
      {"surface",
       "size_m",
       "--size-m",
       "scale so that the longest side has this length; 0: keep",
       {0, longest_m},
       {},
       [](Recipe& r) { return ParameterTarget(&r.surface.size_m); }},
      {"surface",
       "repair",
       "--repair",
       "what may be done to the input: auto (mend, else wrap), mend, wrap, off",
       {},
       {"auto", "mend", "wrap", "off"},
       [](Recipe& r) { return ParameterTarget(&r.surface.repair); }},
      {"mesh",
       "tets",
       "--tets",
       "about so many tetrahedra on the finest level; 0: 10000, or a given tet mesh as it is",
       {0, 5e6},
       {},
       [](Recipe& r) { return ParameterTarget(&r.mesh.tets); }},
      {"mesh",
       "edge_length_m",
       "--edge-length-m",
       "edge length of the finest level, instead of a count",
       {0, longest_m},
       {},
       [](Recipe& r) { return ParameterTarget(&r.mesh.edge_length_m); }},
      {"mesh",
       "max_error_m",
       "--max-error-m",
       "keep the finest boundary within this distance of the surface; 0: in proportion to the edge",
       {0, longest_m},
       {},
       [](Recipe& r) { return ParameterTarget(&r.mesh.max_error_m); }},
      {"mesh",
       "levels",
       "--levels",
       "levels of the hierarchy, each 8 times finer; without it 2, or 1 below 8000 tets",
       {1, 6},
       {},
       [](Recipe& r) { return ParameterTarget(&r.mesh.levels); }},
      {"mesh",
       "hierarchy",
       "--hierarchy",
       "nested: each level splits the coarser one; embedded: independent meshes",
       {},
       {"nested", "embedded"},
       [](Recipe& r) { return ParameterTarget(&r.mesh.hierarchy); }},
      {"mesh",
       "diagonal",
       "--diagonal",
       "inner diagonal of a split tet: quality, shortest, fixed",
       {},
       {"quality", "shortest", "fixed"},
       [](Recipe& r) { return ParameterTarget(&r.mesh.diagonal); }},
      {"mesh",
       "fit",
       "--fit",
       "how finer boundaries move to the surface: projection, least_squares, nearest_three, none",
       {},
       {"projection", "least_squares", "nearest_three", "none"},
       [](Recipe& r) { return ParameterTarget(&r.mesh.fit); }},
      {"mesh",
       "mesher",
       "--mesher",
       "auto (Delaunay, else lattice), delaunay, lattice",
       {},
       {"auto", "delaunay", "lattice"},
       [](Recipe& r) { return ParameterTarget(&r.mesh.mesher); }},
      {"mesh",
       "features",
       "--features",
       "sharp edges: auto (kept on machine parts), keep, ignore",
       {},
       {"auto", "keep", "ignore"},
       [](Recipe& r) { return ParameterTarget(&r.mesh.features); }},
      {"mesh",
       "interior_coarsening",
       "--interior-coarsening",
       "edge length deep inside over that at the surface",
       {1, 16},
       {},
       [](Recipe& r) { return ParameterTarget(&r.mesh.interior_coarsening); }},
      {"mesh",
       "visual",
       "--visual",
       "surface stored for display, bound to the tets: original, none",
       {},
       {"original", "none"},
       [](Recipe& r) { return ParameterTarget(&r.mesh.visual); }},
      {"material",
       "young_pa",
       "--young-pa",
       "Young's modulus",
       {0, 1e15, true},
       {},
       [](Recipe& r) { return ParameterTarget(&r.material.young_pa); }},
      {"material",
       "poisson",
       "--poisson",
       "Poisson's ratio",
       {-1, 0.5, true, true},
       {},
       [](Recipe& r) { return ParameterTarget(&r.material.poisson); }},
      {"material",
       "density",
       "--density-kg-m3",
       "density in kg/m^3",
       {0, 1e6, true},
       {},
       [](Recipe& r) { return ParameterTarget(&r.material.density_kg_m3); }},
      {"material",
       "rayleigh_mass_per_s",
       "--rayleigh-mass-per-s",
       "alpha of B = alpha M + beta K",
       {0, 1e6},
       {},
       [](Recipe& r) { return ParameterTarget(&r.material.rayleigh_mass_per_s); }},
      {"material",
       "rayleigh_stiffness_s",
       "--rayleigh-stiffness-s",
       "beta of the same",
       {0, 1e6},
       {},
       [](Recipe& r) { return ParameterTarget(&r.material.rayleigh_stiffness_s); }},
  };
}

Issue bad_value(std::string_view option, const std::string& text, const std::string& wanted) {
  return make_issue(IssueCode::usage_bad_value,
                    "\"" + text + "\" cannot be used: " + wanted + " is wanted", std::string(option),
                    "Give " + wanted + ".");
}

Status set_text(std::string& target, std::string_view option, const std::string& text,
                std::span<const std::string> choices) {
  if (std::ranges::find(choices, text) == choices.end())
    return bad_value(option, text, "one of " + join_names(choices));
  target = text;
  return {};
}

Status set_number(double& target, std::string_view option, const std::string& text,
                  const NumberRange& range) {
  const auto value = parse_number(text);
  if (!value || !range.contains(*value)) return bad_value(option, text, "a number in " + range.text());
  target = *value;
  return {};
}

Status set_integer(std::int64_t& target, std::string_view option, const std::string& text,
                   const NumberRange& range) {
  const auto value = parse_integer(text);
  if (!value || !range.contains(static_cast<double>(*value)))
    return bad_value(option, text, "a whole number in " + range.text());
  target = *value;
  return {};
}

Status set_parameter(Recipe& recipe, const RecipeParameter& parameter, const std::string& text) {
  const ParameterTarget target = parameter.target(recipe);
  if (auto* const* number = std::get_if<double*>(&target))
    return set_number(**number, parameter.option, text, parameter.range);
  if (auto* const* integer = std::get_if<std::int64_t*>(&target))
    return set_integer(**integer, parameter.option, text, parameter.range);
  return set_text(*std::get<std::string*>(target), parameter.option, text, parameter.choices);
}

/// The compliance that --time-step-s and --scalar mean.
Result<ComplianceRequest*> only_dynamic(Recipe& recipe, std::string_view option) {
  ComplianceRequest* only = nullptr;
  for (ComplianceRequest& request : recipe.compliances) {
    if (request.kind != ComplianceKind::dynamic_step) continue;
    if (only != nullptr)
      return make_issue(IssueCode::usage_conflict, "the recipe has several dynamic compliances",
                        std::string(option), "Set it in their [[compliance]] entries.");
    only = &request;
  }
  if (only == nullptr)
    return make_issue(IssueCode::usage_conflict, "the recipe has no dynamic compliance",
                      std::string(option), "Add a [[compliance]] entry with kind = \"dynamic\".");
  return only;
}

}  // namespace

std::span<const RecipeParameter> recipe_parameters() {
  static const std::vector<RecipeParameter> table = make_table();
  return table;
}

std::span<const std::string> scalar_type_names() {
  static const std::array<std::string, 2> names{"float32", "float64"};
  return names;
}

std::span<const std::string> error_norm_names() {
  static const std::array<std::string, 3> names{"scaled-spectral", "frobenius", "worst-column"};
  return names;
}

std::span<const std::string> compliance_way_names() {
  static const std::array<std::string, 3> names{"auto", "dense", "by-solves"};
  return names;
}

std::string_view scalar_type_name(ScalarType type) {
  return scalar_type_names()[static_cast<std::size_t>(type)];
}

Status override_recipe(Recipe& recipe, std::span<const RecipeOverride> options) {
  const auto given = [&](std::string_view key) {
    return std::ranges::any_of(options, [&](const auto& o) { return o.first->key == key; });
  };
  if (given("tets") && given("edge_length_m"))
    return make_issue(IssueCode::usage_conflict, "a count of tets and an edge length were given",
                      "--tets, --edge-length-m");
  if (given("tets")) recipe.mesh.edge_length_m = 0;
  if (given("edge_length_m")) recipe.mesh.tets = 0;
  for (const auto& [parameter, text] : options)
    if (auto status = set_parameter(recipe, *parameter, text); !status) return status;
  return {};
}

Status override_compliances(Recipe& recipe, const ComplianceOverrides& options) {
  if (options.time_step_s) {
    const auto request = only_dynamic(recipe, "--time-step-s");
    if (!request) return request.issue();
    if (auto status =
            set_number((*request)->time_step_s, "--time-step-s", *options.time_step_s, time_step_range);
        !status)
      return status;
  }
  double tolerance = 0;
  if (options.tolerance) {
    if (auto status = set_number(tolerance, "--tolerance", *options.tolerance, tolerance_range);
        !status)
      return status;
    for (ComplianceRequest& request : recipe.compliances) request.tolerance = tolerance;
  }
  if (!options.scalar) return {};
  if (tolerance > 0)
    return make_issue(IssueCode::usage_conflict,
                      "a tolerance asks for the compressed form, a scalar type for the dense one",
                      "--tolerance, --scalar", "Leave one of them out.");
  std::string name;
  if (auto status = set_text(name, "--scalar", *options.scalar, scalar_type_names()); !status)
    return status;
  for (ComplianceRequest& request : recipe.compliances) {
    request.scalar = name == "float64" ? ScalarType::float64 : ScalarType::float32;
    request.tolerance = 0;
  }
  return {};
}

}  // namespace souple
