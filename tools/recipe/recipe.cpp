// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/recipe/recipe.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "formats/core/limits.hpp"
#include "formats/core/names.hpp"
#include "tools/exchange/strict_toml.hpp"
#include "tools/recipe/recipe_parameters.hpp"

namespace souple {
namespace {

constexpr std::int64_t coarsest_tets = 15;
constexpr NumberRange coordinate_range{-1e9, 1e9};
constexpr NumberRange length_range{0, 1e9, true};

void parse_scalars(TomlTable& root, Recipe& recipe) {
  for (const RecipeParameter& parameter : recipe_parameters()) {
    TomlTable table = root.table(parameter.table);
    const ParameterTarget target = parameter.target(recipe);
    if (auto* const* number = std::get_if<double*>(&target)) {
      **number = table.number(parameter.key, parameter.range).value_or(**number);
    } else if (auto* const* integer = std::get_if<std::int64_t*>(&target)) {
      const auto min = static_cast<std::int64_t>(parameter.range.min);
      const auto max = static_cast<std::int64_t>(parameter.range.max);
      **integer = table.integer(parameter.key, min, max).value_or(**integer);
    } else {
      auto& text = *std::get<std::string*>(target);
      text = table.choice(parameter.key, parameter.choices).value_or(text);
    }
  }
  TomlTable surface = root.table("surface");
  if (const auto file = surface.text("file")) recipe.surface.file = *file;
  TomlTable mesh = root.table("mesh");
  if (mesh.has("tets") && recipe.mesh.edge_length_m > 0)
    mesh.refuse(IssueCode::usage_conflict, "a count of tets and an edge length were given", "tets");
}

BoxSelection parse_box(TomlTable box) {
  box.require("min", "the lower corner [x, y, z] in metres");
  box.require("max", "the upper corner [x, y, z] in metres");
  const BoxSelection selection{box.point("min", coordinate_range).value_or(Point{}),
                               box.point("max", coordinate_range).value_or(Point{})};
  for (std::size_t axis = 0; axis < 3; ++axis)
    if (selection.min[axis] > selection.max[axis])
      box.refuse(IssueCode::config_bad_value, "min is above max on axis " + std::to_string(axis),
                 "min");
  return selection;
}

SphereSelection parse_sphere(TomlTable sphere) {
  sphere.require("centre", "[x, y, z] in metres");
  sphere.require("radius_m", "in metres");
  return {sphere.point("centre", coordinate_range).value_or(Point{}),
          sphere.number("radius_m", length_range).value_or(1)};
}

PlaneSelection parse_plane(TomlTable plane) {
  plane.require("point", "a point of the plane, [x, y, z] in metres");
  plane.require("normal", "[x, y, z]; nodes on the other side are selected");
  PlaneSelection selection;
  selection.point = plane.point("point", coordinate_range).value_or(Point{});
  selection.normal = plane.point("normal", coordinate_range).value_or(Point{0, 0, 1});
  selection.distance_m = plane.number("distance_m", coordinate_range).value_or(0);
  const auto& n = selection.normal;
  if (std::hypot(n[0], n[1], n[2]) < 1e-9)
    plane.refuse(IssueCode::config_bad_value, "the normal has no direction", "normal");
  return selection;
}

NearestSelection parse_nearest(TomlTable nearest) {
  nearest.require("point", "[x, y, z] in metres");
  return {nearest.point("point", coordinate_range).value_or(Point{}),
          nearest.integer("count", 1, 1'000'000'000).value_or(1)};
}

FixedRequest parse_fixed(TomlTable& entry) {
  entry.require("name", "what scenes call the set");
  FixedRequest request;
  request.name = entry.plain_name("name").value_or("");
  static constexpr std::array<std::string_view, 4> kinds{"box", "sphere", "plane", "nearest"};
  const auto count = std::ranges::count_if(kinds, [&](auto kind) { return entry.has(kind); });
  if (count != 1)
    entry.refuse(IssueCode::config_bad_value,
                 "exactly one of box, sphere, plane, nearest has to select the nodes; there are " +
                     std::to_string(count),
                 "name");
  else if (entry.has("box"))
    request.selection = parse_box(entry.table("box"));
  else if (entry.has("sphere"))
    request.selection = parse_sphere(entry.table("sphere"));
  else if (entry.has("plane"))
    request.selection = parse_plane(entry.table("plane"));
  else
    request.selection = parse_nearest(entry.table("nearest"));
  return request;
}

ComplianceRequest parse_compliance(TomlTable& entry) {
  static const std::array<std::string, 2> kinds{"dynamic", "static"};
  ComplianceRequest request;
  request.name = entry.plain_name("name").value_or(request.name);
  request.fixed = entry.plain_name("fixed").value_or("");
  if (entry.choice("kind", kinds).value_or("dynamic") == "static") {
    request.kind = ComplianceKind::static_equilibrium;
    request.time_step_s = 0;
    if (entry.has("time_step_s"))
      entry.refuse(IssueCode::usage_conflict, "a static compliance has no time step", "time_step_s");
  } else {
    request.time_step_s = entry.number("time_step_s", time_step_range).value_or(request.time_step_s);
  }
  if (entry.choice("scalar", scalar_type_names()).value_or("float32") == "float64")
    request.scalar = ScalarType::float64;
  return request;
}

Issue wrong(IssueCode code, const std::string& what, const std::string& where,
            const std::string& mend = {}) {
  return make_issue(code, what, where, mend);
}

template <class Entry>
Status check_unique_names(const std::vector<Entry>& entries, const std::string& table) {
  for (std::size_t i = 0; i < entries.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      if (entries[i].name == entries[j].name)
        return wrong(IssueCode::config_bad_value, "two entries are called \"" + entries[i].name + "\"",
                     table, "Give every entry a name of its own.");
  return {};
}

Status check_compliance(const Recipe& recipe, const ComplianceRequest& request) {
  const std::string where = "[[compliance]] " + request.name;
  if (!request.fixed.empty() &&
      std::ranges::find(recipe.fixed, request.fixed, &FixedRequest::name) == recipe.fixed.end())
    return wrong(IssueCode::config_bad_value, "there is no fixed set called \"" + request.fixed + "\"",
                 where, "Add a [[fixed]] entry of that name, or correct the name.");
  if (request.kind == ComplianceKind::static_equilibrium && request.fixed.empty())
    return wrong(IssueCode::compliance_singular, "a static compliance needs a fixed set", where);
  return {};
}

Status check_resolution(const MeshSettings& mesh) {
  if (mesh.edge_length_m > 0) return {};
  const std::int64_t levels = chosen_levels(mesh);
  const std::int64_t refinement = std::int64_t{1} << (3 * (levels - 1));
  if (mesh.tets / refinement >= coarsest_tets) return {};
  return wrong(
      IssueCode::recipe_too_few_tets,
      std::to_string(mesh.tets) + " tets on " + std::to_string(levels) + " levels leave " +
          std::to_string(mesh.tets / refinement) + " for the coarsest; at least " +
          std::to_string(coarsest_tets) + " are needed",
      "[mesh] tets, levels",
      "Ask for at least " + std::to_string(coarsest_tets * refinement) + " tets, or for fewer levels.");
}

Result<Recipe> parse_recipe_table(TomlTable& root) {
  Recipe recipe;
  parse_scalars(root, recipe);
  if (root.table("material").has("region"))
    root.table("material")
        .refuse(IssueCode::unsupported_feature, "materials by region are not supported", "region",
                "Give one material in [material].");
  auto fixed = root.tables("fixed");
  auto compliances = root.tables("compliance");
  if (fixed.size() > limits::parts || compliances.size() > limits::parts)
    root.refuse(IssueCode::config_bad_value, "more than " + std::to_string(limits::parts) + " entries",
                fixed.size() > limits::parts ? "fixed" : "compliance");
  else
    for (TomlTable& entry : fixed) recipe.fixed.push_back(parse_fixed(entry));
  if (!compliances.empty()) recipe.compliances.clear();
  for (TomlTable& entry : compliances) recipe.compliances.push_back(parse_compliance(entry));
  if (auto status = root.finish(); !status) return status.issue();
  return recipe;
}

}  // namespace

std::int64_t chosen_levels(const MeshSettings& mesh) {
  constexpr std::int64_t shape_holding_tets = 1000;
  if (mesh.levels > 0) return mesh.levels;
  return mesh.edge_length_m > 0 || mesh.tets >= 8 * shape_holding_tets ? 2 : 1;
}

Result<Recipe> parse_recipe(std::string_view text, const std::string& name) {
  auto root = TomlTable::parse(text, name);
  if (!root) return root.issue();
  return parse_recipe_table(*root);
}

Result<Recipe> read_recipe(const std::filesystem::path& file) {
  auto root = TomlTable::parse_file(file);
  if (!root) return root.issue();
  auto recipe = parse_recipe_table(*root);
  if (recipe && recipe->surface.file.is_relative() && !recipe->surface.file.empty())
    recipe->surface.file = file.parent_path() / recipe->surface.file;
  return recipe;
}

Status check_recipe(const Recipe& recipe) {
  if (recipe.surface.file.empty())
    return wrong(IssueCode::usage_missing_argument, "no surface was named", "[surface] file",
                 "Name a surface file on the command line or in the recipe.");
  if (!is_valid_text(recipe.surface.file.filename().string()))
    return wrong(IssueCode::usage_bad_value, "the name of the surface file is not UTF-8",
                 "[surface] file", "Rename the file: the asset records its name.");
  if (recipe.mesh.hierarchy != "nested")
    return wrong(IssueCode::unsupported_feature,
                 "a hierarchy of kind \"" + recipe.mesh.hierarchy + "\" is not supported",
                 "[mesh] hierarchy", "Use hierarchy = \"nested\".");
  if (auto status = check_resolution(recipe.mesh); !status) return status;
  if (auto status = check_unique_names(recipe.fixed, "[[fixed]]"); !status) return status;
  if (auto status = check_unique_names(recipe.compliances, "[[compliance]]"); !status) return status;
  for (const ComplianceRequest& request : recipe.compliances)
    if (auto status = check_compliance(recipe, request); !status) return status;
  const std::size_t text_bytes = canonical_recipe_text(recipe).size();
  if (text_bytes <= limits::text_bytes) return {};
  return wrong(IssueCode::config_bad_value,
               "the recipe takes " + std::to_string(text_bytes) + " bytes as text; an asset holds " +
                   std::to_string(limits::text_bytes),
               "", "Use fewer entries or shorter names.");
}

}  // namespace souple
