// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>

#include "formats/core/limits.hpp"
#include "formats/core/names.hpp"
#include "formats/read/internal/checks.hpp"

namespace souple::checks {
namespace {

void check_text(const std::string& text, const char* what, IssueList& issues) {
  if (text.size() > limits::text_bytes)
    issues.add(IssueCode::asset_limit_exceeded, what, [&] {
      return std::to_string(text.size()) + " bytes, at most " + std::to_string(limits::text_bytes);
    });
  else if (!is_valid_text(text))
    issues.add(IssueCode::asset_bad_name, what, [] { return "not valid UTF-8, or it holds a NUL"; });
}

void check_name_list(std::vector<std::string> names, std::size_t limit, const char* what,
                     IssueList& issues) {
  if (names.size() > limit)
    issues.add(IssueCode::asset_limit_exceeded, what, [&] {
      return std::to_string(names.size()) + " parts, at most " + std::to_string(limit);
    });
  for (const std::string& name : names)
    if (!is_valid_name(name))
      issues.add(IssueCode::asset_bad_name, what, [] { return "a name is not allowed"; });
  std::ranges::sort(names);
  const auto twice = std::ranges::adjacent_find(names);
  if (twice != names.end())
    issues.add(IssueCode::asset_bad_name, what, [&] { return "the name " + *twice + " stands twice"; });
}

void check_region(const MaterialRegion& region, const std::string& where, IssueList& issues) {
  const auto positive = [](double x) { return std::isfinite(x) && x > 0; };
  const auto refuse = [&](const char* name, double value) {
    issues.add(IssueCode::material_out_of_range, where,
               [&] { return region.name + ": " + name + " is " + std::to_string(value); });
  };
  if (!positive(region.young_pa)) refuse("Young's modulus", region.young_pa);
  if (!(region.poisson > -1 && region.poisson < 0.5)) refuse("Poisson's ratio", region.poisson);
  if (!positive(region.density_kg_m3)) refuse("density", region.density_kg_m3);
}

void check_tet_regions(const Material& material, std::size_t tet_count, const std::string& where,
                       IssueList& issues) {
  if (material.tet_region.empty()) return;
  if (material.tet_region.size() != tet_count)
    issues.add(IssueCode::asset_index_out_of_range, where, [&] {
      return std::to_string(material.tet_region.size()) + " regions for " + std::to_string(tet_count) +
             " tets";
    });
  for (std::size_t t = 0; t < material.tet_region.size(); ++t) {
    const Index region = material.tet_region[t];
    if (region < 0 || static_cast<std::size_t>(region) >= material.regions.size())
      issues.add(IssueCode::asset_index_out_of_range, where, [&] {
        return "tet " + std::to_string(t) + " lies in region " + std::to_string(region) + " of " +
               std::to_string(material.regions.size());
      });
  }
}

}  // namespace

void check_material(const Material& material, std::size_t tet_count, const std::string& where,
                    IssueList& issues) {
  if (material.regions.empty() || material.regions.size() > limits::regions)
    issues.add(IssueCode::material_out_of_range, where, [&] {
      return std::to_string(material.regions.size()) + " regions, not 1 to " +
             std::to_string(limits::regions);
    });
  for (const MaterialRegion& region : material.regions) check_region(region, where, issues);
  for (const double rayleigh : {material.rayleigh_mass_per_s, material.rayleigh_stiffness_s})
    if (!(std::isfinite(rayleigh) && rayleigh >= 0))
      issues.add(IssueCode::material_out_of_range, where,
                 [&] { return "a Rayleigh factor is " + std::to_string(rayleigh); });
  check_tet_regions(material, tet_count, where, issues);
}

void check_fixed_set(const FixedSet& set, std::size_t node_count, const std::string& where,
                     IssueList& issues) {
  const auto refuse = [&](const char* what) {
    issues.add(IssueCode::fixed_set_invalid, where, [&] { return std::string(what); });
  };
  if (set.nodes.empty()) return refuse("the set is empty");
  // Strictly ascending: sorted and unique at once.
  if (std::ranges::adjacent_find(set.nodes, std::ranges::greater_equal{}) != set.nodes.end())
    return refuse("the nodes are not sorted and unique");
  if (set.nodes.front() < 0 || static_cast<std::size_t>(set.nodes.back()) >= node_count)
    return refuse("a node lies outside the mesh");
  if (set.nodes.size() == node_count) refuse("the set holds every node");
}

void check_names(const Asset& asset, IssueList& issues) {
  std::vector<std::string> fixed_sets, regions, variants;
  for (const FixedSet& set : asset.fixed_sets) fixed_sets.push_back(set.name);
  for (const MaterialRegion& region : asset.material.regions) regions.push_back(region.name);
  for (const ComplianceVariant& variant : asset.compliances) variants.push_back(variant.header.name);
  check_name_list(std::move(fixed_sets), limits::parts, "constraints", issues);
  check_name_list(std::move(regions), limits::regions, "material", issues);
  check_name_list(std::move(variants), limits::parts, "compliance", issues);
  check_text(asset.provenance.generator, "generator", issues);
  check_text(asset.provenance.recipe, "recipe", issues);
  check_text(asset.provenance.input_name, "input name", issues);
  check_text(asset.provenance.input_hash, "input hash", issues);
}

}  // namespace souple::checks
