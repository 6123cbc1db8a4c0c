// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/exchange/numbers.hpp"
#include "tools/recipe/recipe.hpp"
#include "tools/recipe/recipe_parameters.hpp"

namespace souple {
namespace {

/// A basic string of TOML.
std::string toml_text(std::string_view text) {
  static constexpr std::string_view hex = "0123456789ABCDEF";
  std::string result = "\"";
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (c == '"' || c == '\\') {
      result += '\\';
      result += c;
    } else if (byte < 32 || byte == 127) {
      result += std::string("\\u00") + hex[byte >> 4] + hex[byte & 15];
    } else {
      result += c;
    }
  }
  return result + "\"";
}

std::string point_text(const Point& p) {
  return "[" + exact_text(p[0]) + ", " + exact_text(p[1]) + ", " + exact_text(p[2]) + "]";
}

std::string value_text(const ParameterTarget& target) {
  if (auto* const* number = std::get_if<double*>(&target)) return exact_text(**number);
  if (auto* const* integer = std::get_if<std::int64_t*>(&target)) return std::to_string(**integer);
  return toml_text(*std::get<std::string*>(target));
}

/// What every kind of selection looks like in a recipe.
struct SelectionText {
  std::string operator()(const FileSelection& s) const {
    return "surface = " + toml_text(s.file.filename().string());
  }
  std::string operator()(const GroupSelection& s) const { return "group = " + toml_text(s.name); }
  std::string operator()(const BoxSelection& s) const {
    return "box = { min = " + point_text(s.min) + ", max = " + point_text(s.max) + " }";
  }
  std::string operator()(const SphereSelection& s) const {
    return "sphere = { centre = " + point_text(s.centre) + ", radius_m = " + exact_text(s.radius_m) +
           " }";
  }
  std::string operator()(const PlaneSelection& s) const {
    return "plane = { point = " + point_text(s.point) + ", normal = " + point_text(s.normal) +
           ", distance_m = " + exact_text(s.distance_m) + " }";
  }
  std::string operator()(const NearestSelection& s) const {
    return "nearest = { point = " + point_text(s.point) + ", count = " + std::to_string(s.count) + " }";
  }
};

std::string scalars_text(Recipe recipe) {
  const std::int64_t tets = chosen_tets(recipe), levels = chosen_levels(recipe);
  recipe.mesh.tets = tets;
  recipe.mesh.levels = levels;
  std::string text, table;
  for (const RecipeParameter& parameter : recipe_parameters()) {
    const bool by_edge = recipe.mesh.edge_length_m > 0;
    if (parameter.key == (by_edge ? "tets" : "edge_length_m")) continue;
    if (parameter.table != table) {
      table = parameter.table;
      text += (text.empty() ? "[" : "\n[") + table + "]\n";
      if (table == "surface")
        text += "file = " + toml_text(recipe.surface.file.filename().string()) + "\n";
    }
    text += std::string(parameter.key) + " = " + value_text(parameter.target(recipe)) + "\n";
  }
  return text;
}

std::string refine_text(const RefineRequest& request) {
  std::string text = "\n[[mesh.refine]]\nedge_length_m = " + exact_text(request.edge_length_m) + "\n";
  if (request.distance_m > 0) text += "distance_m = " + exact_text(request.distance_m) + "\n";
  return text + std::visit(SelectionText{}, request.where) + "\n";
}

std::string region_text(const RegionRequest& request) {
  return "\n[[material.region]]\nname = " + toml_text(request.name) +
         "\nyoung_pa = " + exact_text(request.young_pa) + "\npoisson = " + exact_text(request.poisson) +
         "\ndensity = " + exact_text(request.density_kg_m3) + "\n" +
         std::visit(SelectionText{}, request.where) + "\n";
}

std::string compliance_text(const ComplianceRequest& request) {
  std::string text = "\n[[compliance]]\nname = " + toml_text(request.name) + "\n";
  if (request.kind == ComplianceKind::static_equilibrium)
    text += "kind = \"static\"\n";
  else
    text += "kind = \"dynamic\"\ntime_step_s = " + exact_text(request.time_step_s) +
            "\nintegrator = " + toml_text(request.integrator) + "\n";
  if (!request.fixed.empty()) text += "fixed = " + toml_text(request.fixed) + "\n";
  text += "tolerance = " + exact_text(request.tolerance) + "\n";
  if (request.tolerance > 0)
    text += "error_norm = " + toml_text(request.error_norm) + "\n";
  else
    text += "scalar = " + toml_text(scalar_type_name(request.scalar)) + "\n";
  if (request.nodes) text += "nodes = { " + node_selection_text(*request.nodes) + " }\n";
  text += "coarsening = " + std::to_string(request.coarsening) + "\n";
  return text + "way = " + toml_text(request.way) + "\n";
}

}  // namespace

std::string node_selection_text(const NodeSelection& selection) {
  return std::visit(SelectionText{}, selection);
}

std::string canonical_recipe_text(const Recipe& recipe) {
  std::string text = scalars_text(recipe);
  for (const RefineRequest& request : recipe.refine) text += refine_text(request);
  for (const RegionRequest& request : recipe.regions) text += region_text(request);
  for (const FixedRequest& request : recipe.fixed)
    text += "\n[[fixed]]\nname = " + toml_text(request.name) + "\n" +
            node_selection_text(request.selection) + "\n";
  for (const ComplianceRequest& request : recipe.compliances) text += compliance_text(request);
  return text;
}

}  // namespace souple
