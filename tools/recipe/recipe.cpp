// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/recipe/recipe.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "formats/core/limits.hpp"
#include "formats/core/names.hpp"
#include "runtime/world/integrator.hpp"
#include "tools/exchange/nearest_name.hpp"
#include "tools/exchange/strict_toml.hpp"
#include "tools/exchange/tet_file.hpp"
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
  if (recipe.mesh.tets > 0 && recipe.mesh.edge_length_m > 0)
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

/// Whether exactly one of `kinds` is there; refuses otherwise, at `key`.
bool has_one_of(TomlTable& entry, std::span<const std::string> kinds, std::string_view key) {
  const auto count = std::ranges::count_if(kinds, [&](const auto& kind) { return entry.has(kind); });
  if (count == 1) return true;
  entry.refuse(IssueCode::config_bad_value,
               "exactly one of " + join_names(kinds) + " has to select a part; there are " +
                   std::to_string(count),
               key);
  return false;
}

/// Where a part of the body is: the alternatives of `Part` whose words are in `kinds`, which holds
/// "box" and "sphere" at least.
template <class Part>
Part parse_part(TomlTable& entry, std::span<const std::string> kinds, std::string_view key) {
  if (!has_one_of(entry, kinds, key)) return {};
  if (entry.has("box")) return parse_box(entry.table("box"));
  if (entry.has("sphere")) return parse_sphere(entry.table("sphere"));
  if constexpr (std::is_constructible_v<Part, GroupSelection>)
    if (entry.has("group")) return GroupSelection{entry.text("group").value_or("")};
  return FileSelection{entry.text("surface").value_or("")};
}

RefineRequest parse_refine(TomlTable& entry) {
  entry.require("edge_length_m", "the edge length there");
  RefineRequest request;
  request.edge_length_m = entry.number("edge_length_m", {0, 1e5, true}).value_or(1);
  static const std::array<std::string, 3> kinds{"box", "sphere", "surface"};
  request.where = parse_part<decltype(request.where)>(entry, kinds, "edge_length_m");
  request.distance_m = entry.number("distance_m", {0, 1e5}).value_or(0);
  if (std::holds_alternative<FileSelection>(request.where) && !(request.distance_m > 0))
    entry.refuse(IssueCode::config_missing_key, "a patch of surface needs a distance_m above 0",
                 "surface");
  return request;
}

RegionRequest parse_region(TomlTable& entry, const MaterialSettings& standard) {
  entry.require("name", "what reports call the region");
  RegionRequest request;
  request.name = entry.plain_name("name").value_or("");
  request.young_pa = entry.number("young_pa", {0, 1e15, true}).value_or(standard.young_pa);
  request.poisson = entry.number("poisson", {-1, 0.5, true, true}).value_or(standard.poisson);
  request.density_kg_m3 = entry.number("density", {0, 1e6, true}).value_or(standard.density_kg_m3);
  static const std::array<std::string, 4> kinds{"box", "sphere", "surface", "group"};
  request.where = parse_part<decltype(request.where)>(entry, kinds, "name");
  return request;
}

/// Nodes of the mesh; `key` is where a message points if not exactly one selection is there.
NodeSelection parse_node_selection(TomlTable& entry, std::string_view key) {
  static const std::array<std::string, 4> kinds{"box", "sphere", "plane", "nearest"};
  if (!has_one_of(entry, kinds, key)) return {};
  if (entry.has("box")) return parse_box(entry.table("box"));
  if (entry.has("sphere")) return parse_sphere(entry.table("sphere"));
  if (entry.has("plane")) return parse_plane(entry.table("plane"));
  return parse_nearest(entry.table("nearest"));
}

FixedRequest parse_fixed(TomlTable& entry) {
  entry.require("name", "what scenes call the set");
  FixedRequest request;
  request.name = entry.plain_name("name").value_or("");
  request.selection = parse_node_selection(entry, "name");
  return request;
}

/// How a compliance is stored. `scalar` belongs to the dense form: alone it asks for it, and beside a
/// tolerance it contradicts it. What only the compressed form has contradicts the dense one.
void parse_storage(TomlTable& entry, ComplianceRequest& request) {
  const bool scalar = entry.has("scalar");
  if (entry.choice("scalar", scalar_type_names()).value_or("float32") == "float64")
    request.scalar = ScalarType::float64;
  if (scalar) request.tolerance = 0;
  request.tolerance = entry.number("tolerance", tolerance_range).value_or(request.tolerance);
  if (scalar && request.tolerance > 0)
    entry.refuse(IssueCode::usage_conflict,
                 "a tolerance asks for the compressed form, scalar for dense", "scalar",
                 "Leave one of them out, or set tolerance = 0.");
  if (entry.has("error_norm") && request.tolerance == 0)
    entry.refuse(IssueCode::usage_conflict, "the dense form has no error that a norm bounds",
                 "error_norm", "Leave it out, or give a tolerance above 0.");
  request.error_norm = entry.choice("error_norm", error_norm_names()).value_or(request.error_norm);
  request.way = entry.choice("way", compliance_way_names()).value_or(request.way);
}

ComplianceRequest parse_compliance(TomlTable& entry) {
  static const std::array<std::string, 2> kinds{"dynamic", "static"};
  static const std::array<std::string, 2> integrators{"implicit_euler", "bdf2"};
  ComplianceRequest request;
  request.name = entry.plain_name("name").value_or(request.name);
  request.fixed = entry.plain_name("fixed").value_or("");
  if (entry.choice("kind", kinds).value_or("dynamic") == "static") {
    request.kind = ComplianceKind::static_equilibrium;
    request.time_step_s = 0;
    for (const char* key : {"time_step_s", "integrator"})
      if (entry.has(key))
        entry.refuse(IssueCode::usage_conflict, "a static compliance has no time step", key);
  } else {
    request.time_step_s = entry.number("time_step_s", time_step_range).value_or(request.time_step_s);
    request.integrator = entry.choice("integrator", integrators).value_or(request.integrator);
  }
  parse_storage(entry, request);
  if (entry.has("nodes")) {
    TomlTable nodes = entry.table("nodes");
    request.nodes = parse_node_selection(nodes, "");
  }
  request.coarsening = entry.integer("coarsening", 0, 1).value_or(0);
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

Status check_compliance(const ComplianceRequest& request, const std::vector<std::string>& fixed_sets) {
  const std::string where = "[[compliance]] " + request.name;
  if (!request.fixed.empty() && std::ranges::find(fixed_sets, request.fixed) == fixed_sets.end())
    return wrong(IssueCode::config_bad_value, "there is no fixed set called \"" + request.fixed + "\"",
                 where, "Add a [[fixed]] entry of that name, or correct the name.");
  if (request.kind == ComplianceKind::static_equilibrium && request.fixed.empty())
    return wrong(IssueCode::compliance_singular, "a static compliance needs a fixed set", where);
  if (request.tolerance == 0 && request.way == "by-solves")
    return wrong(IssueCode::usage_conflict, "by solves there is no dense form, which tolerance 0 means",
                 where, "Give a tolerance above 0, or another way.");
  return {};
}

std::string selection_text(const ComplianceRequest& request) {
  return request.nodes ? node_selection_text(*request.nodes) : "";
}

/// Whether a scene could not tell the two apart: a compliance serves the ratio a_M : a_K of its system,
/// and within one recipe that is its kind and the time step of implicit Euler (a_M / a_K falls as it
/// grows).
bool serve_the_same(const ComplianceRequest& a, const ComplianceRequest& b) {
  constexpr double same_step = 1e-9;
  return a.kind == b.kind && a.fixed == b.fixed && a.coarsening == b.coarsening &&
         std::abs(euler_step(a) - euler_step(b)) <= same_step * euler_step(a) &&
         a.tolerance == b.tolerance &&
         (a.tolerance > 0 ? a.error_norm == b.error_norm : a.scalar == b.scalar) &&
         selection_text(a) == selection_text(b);
}

Status check_distinct(const std::vector<ComplianceRequest>& requests) {
  for (std::size_t i = 0; i < requests.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      if (serve_the_same(requests[i], requests[j]))
        return wrong(IssueCode::recipe_same_compliance,
                     "\"" + requests[j].name + "\" and \"" + requests[i].name +
                         "\" are one compliance: same system, same nodes, same exactness",
                     "[[compliance]] " + requests[i].name);
  return {};
}

Status check_resolution(const Recipe& recipe) {
  const std::int64_t tets = chosen_tets(recipe);
  if (tets == 0) return {};
  const std::int64_t levels = chosen_levels(recipe);
  const std::int64_t refinement = std::int64_t{1} << (3 * (levels - 1));
  if (tets / refinement >= coarsest_tets) return {};
  return wrong(
      IssueCode::recipe_too_few_tets,
      std::to_string(tets) + " tets on " + std::to_string(levels) + " levels leave " +
          std::to_string(tets / refinement) + " for the coarsest; at least " +
          std::to_string(coarsest_tets) + " are needed",
      "[mesh] tets, levels",
      "Ask for at least " + std::to_string(coarsest_tets * refinement) + " tets, or for fewer levels.");
}

Status check_groups(const Recipe& recipe) {
  if (keeps_given_tets(recipe)) return {};
  for (const RegionRequest& request : recipe.regions)
    if (std::holds_alternative<GroupSelection>(request.where))
      return wrong(IssueCode::usage_conflict, "a group is a label of a given tet mesh",
                   "[[material.region]] " + request.name,
                   "Select by box, sphere or surface where the mesh is made anew.");
  return {};
}

/// What only the mesher does cannot be asked of tets that are taken as they are.
Status check_given_tets(const Recipe& recipe) {
  const MeshSettings standard;
  const MeshSettings& mesh = recipe.mesh;
  std::string key;
  if (mesh.mesher != standard.mesher) key = "mesher";
  if (mesh.features != standard.features) key = "features";
  if (mesh.interior_coarsening != standard.interior_coarsening) key = "interior_coarsening";
  if (mesh.hierarchy != standard.hierarchy) key = "hierarchy";
  if (!recipe.refine.empty()) key = "refine";
  if (key.empty()) return {};
  return wrong(IssueCode::usage_conflict, "the tet mesh is taken as it is, without a mesher",
               "[mesh] " + key, "Leave it out, or give tets (--tets) to mesh the boundary anew.");
}

/// The entries of one array of tables, each parsed; too many are refused.
template <class Entry, class Parse>
void parse_entries(TomlTable owner, std::string_view key, std::vector<Entry>& entries,
                   const Parse& parse) {
  auto tables = owner.tables(key);
  if (tables.empty()) return;
  entries.clear();
  if (tables.size() > limits::parts)
    return owner.refuse(IssueCode::config_bad_value,
                        "more than " + std::to_string(limits::parts) + " entries", key);
  for (TomlTable& table : tables) entries.push_back(parse(table));
}

Result<Recipe> parse_recipe_table(TomlTable& root, Recipe recipe) {
  parse_scalars(root, recipe);
  parse_entries(root.table("mesh"), "refine", recipe.refine, parse_refine);
  parse_entries(root.table("material"), "region", recipe.regions,
                [&](TomlTable& entry) { return parse_region(entry, recipe.material); });
  parse_entries(root, "fixed", recipe.fixed, parse_fixed);
  parse_entries(root, "compliance", recipe.compliances, parse_compliance);
  if (auto status = root.finish(); !status) return status.issue();
  return recipe;
}

}  // namespace

bool keeps_given_tets(const Recipe& recipe) {
  return is_tet_file_name(recipe.surface.file) && recipe.mesh.tets == 0 &&
         recipe.mesh.edge_length_m == 0 && recipe.mesh.max_error_m == 0;
}

std::int64_t chosen_tets(const Recipe& recipe) {
  if (recipe.mesh.edge_length_m > 0 || keeps_given_tets(recipe)) return 0;
  if (recipe.mesh.max_error_m > 0 && recipe.mesh.tets == 0) return 0;
  return recipe.mesh.tets > 0 ? recipe.mesh.tets : default_tets;
}

std::int64_t chosen_levels(const Recipe& recipe) {
  constexpr std::int64_t shape_holding_tets = 1000;
  if (recipe.mesh.levels > 0) return recipe.mesh.levels;
  if (keeps_given_tets(recipe)) return 1;
  const std::int64_t tets = chosen_tets(recipe);
  return tets == 0 || tets >= 8 * shape_holding_tets ? 2 : 1;
}

double euler_step(const ComplianceRequest& request) {
  return request.integrator == "bdf2" ? euler_step_of_bdf2(request.time_step_s) : request.time_step_s;
}

Result<Recipe> parse_recipe(std::string_view text, const std::string& name) {
  auto root = TomlTable::parse(text, name);
  if (!root) return root.issue();
  return parse_recipe_table(*root, {});
}

Result<Recipe> read_recipe(const std::filesystem::path& file, const Recipe& base) {
  auto root = TomlTable::parse_file(file);
  if (!root) return root.issue();
  auto recipe = parse_recipe_table(*root, base);
  if (!recipe) return recipe;
  const auto resolve = [&](std::filesystem::path& name) {
    if (name.is_relative() && !name.empty()) name = file.parent_path() / name;
  };
  const auto resolve_part = [&](auto& request) {
    if (auto* surface = std::get_if<FileSelection>(&request.where)) resolve(surface->file);
  };
  resolve(recipe->surface.file);
  std::ranges::for_each(recipe->refine, resolve_part);
  std::ranges::for_each(recipe->regions, resolve_part);
  return recipe;
}

Status check_compliances(const std::vector<ComplianceRequest>& compliances, std::int64_t level_count,
                         const std::vector<std::string>& fixed_sets) {
  if (auto status = check_unique_names(compliances, "[[compliance]]"); !status) return status;
  for (const ComplianceRequest& request : compliances) {
    if (auto status = check_compliance(request, fixed_sets); !status) return status;
    if (request.coarsening >= level_count)
      return wrong(IssueCode::recipe_needs_coarser_level,
                   "coarsening " + std::to_string(request.coarsening) + " on a body of one level",
                   "[[compliance]] " + request.name);
  }
  return check_distinct(compliances);
}

Status check_recipe(const Recipe& recipe) {
  if (recipe.surface.file.empty())
    return wrong(IssueCode::usage_missing_argument, "no surface was named", "[surface] file",
                 "Name a surface file on the command line or in the recipe.");
  if (!is_valid_text(recipe.surface.file.filename().string()))
    return wrong(IssueCode::usage_bad_value, "the name of the surface file is not UTF-8",
                 "[surface] file", "Rename the file: the asset records its name.");
  if (recipe.mesh.tets > 0 && recipe.mesh.max_error_m > 0)
    return wrong(IssueCode::usage_conflict, "a count of tets and a largest error were given",
                 "[mesh] tets, max_error_m", "Leave one of them out.");
  if (keeps_given_tets(recipe))
    if (auto status = check_given_tets(recipe); !status) return status;
  if (auto status = check_resolution(recipe); !status) return status;
  if (auto status = check_groups(recipe); !status) return status;
  if (auto status = check_unique_names(recipe.regions, "[[material.region]]"); !status) return status;
  if (auto status = check_unique_names(recipe.fixed, "[[fixed]]"); !status) return status;
  std::vector<std::string> fixed_sets;
  for (const FixedRequest& request : recipe.fixed) fixed_sets.push_back(request.name);
  if (auto status = check_compliances(recipe.compliances, chosen_levels(recipe), fixed_sets); !status)
    return status;
  const std::size_t text_bytes = canonical_recipe_text(recipe).size();
  if (text_bytes <= limits::text_bytes) return {};
  return wrong(IssueCode::config_bad_value,
               "the recipe takes " + std::to_string(text_bytes) + " bytes as text; an asset holds " +
                   std::to_string(limits::text_bytes),
               "", "Use fewer entries or shorter names.");
}

}  // namespace souple
