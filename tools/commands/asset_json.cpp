// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/commands/asset_json.hpp"

#include <array>

#include "tools/exchange/numbers.hpp"
#include "tools/recipe/recipe_parameters.hpp"

namespace souple {
namespace {

std::string_view kind_name(ComplianceKind kind) {
  return kind == ComplianceKind::dynamic_step ? "dynamic" : "static";
}

std::string_view representation_name(ComplianceRepresentation representation) {
  switch (representation) {
    case ComplianceRepresentation::dense_tiled:
      return "dense-tiled";
    case ComplianceRepresentation::hierarchical:
      return "hierarchical";
  }
  return "unknown";
}

std::string_view norm_name(ErrorNorm norm) {
  switch (norm) {
    case ErrorNorm::scaled_spectral:
      return "scaled-spectral";
    case ErrorNorm::frobenius:
      return "frobenius";
    case ErrorNorm::worst_column:
      return "worst-column";
  }
  return "unknown";
}

/// Which systems share it: mass over stiffness factor, 1/s2; 0 if static.
double key_of(const ComplianceHeader& header) {
  return header.stiffness_factor > 0 ? header.mass_factor / header.stiffness_factor : 0;
}

std::string padded(std::string text, std::size_t width) {
  if (text.size() < width) text.resize(width, ' ');
  return text;
}

}  // namespace

Json material_json(const Material& material) {
  Json regions = Json::array();
  for (const MaterialRegion& region : material.regions)
    regions.push_back({{"name", region.name},
                       {"young_pa", region.young_pa},
                       {"poisson", region.poisson},
                       {"density_kg_m3", region.density_kg_m3}});
  return {{"regions", regions},
          {"rayleigh_mass_per_s", material.rayleigh_mass_per_s},
          {"rayleigh_stiffness_s", material.rayleigh_stiffness_s}};
}

Json compliance_json(const ComplianceHeader& header) {
  return {{"name", header.name},
          {"kind", kind_name(header.kind)},
          {"time_step_s", header.time_step_s},
          {"fixed_set", header.fixed_set},
          {"mass_factor", header.mass_factor},
          {"stiffness_factor", header.stiffness_factor},
          {"key_per_s2", key_of(header)},
          {"node_count", header.node_count},
          {"representation", representation_name(header.representation)},
          {"scalar", scalar_type_name(header.scalar)},
          {"coarsening", header.coarsening},
          {"tolerance_asked", header.tolerance_asked},
          {"error_norm", norm_name(header.error_norm)},
          {"shift", header.shift},
          {"error",
           {{"solve_residual", header.error.solve_residual},
            {"scaled_spectral", header.error.scaled_spectral},
            {"frobenius", header.error.frobenius},
            {"worst_column", header.error.worst_column}}}};
}

Json group_costs_json(const std::vector<GroupCost>& costs) {
  Json groups = Json::array();
  for (const GroupCost& cost : costs)
    groups.push_back(
        {{"path", cost.path}, {"stored_bytes", cost.stored_bytes}, {"raw_bytes", cost.raw_bytes}});
  return groups;
}

std::string compliance_text(const ComplianceHeader& header) {
  std::string text = "compliance " + header.name + ": " + std::string(kind_name(header.kind));
  if (header.kind == ComplianceKind::dynamic_step)
    text += ", time step " + rounded_text(header.time_step_s, 9) + " s";
  text += header.fixed_set.empty() ? ", nothing fixed" : ", fixed " + header.fixed_set;
  text += ", key " + rounded_text(key_of(header), 6) + " 1/s^2, " + std::to_string(header.node_count) +
          (header.coarsening > 0 ? " nodes of the level below, " : " nodes, ") +
          std::string(representation_name(header.representation)) + " " +
          std::string(scalar_type_name(header.scalar));
  text += header.tolerance_asked > 0 ? "; asked " + rounded_text(header.tolerance_asked, 2) + " " +
                                           std::string(norm_name(header.error_norm)) + ", measured "
                                     : "; error ";
  text += "scaled-spectral " + rounded_text(header.error.scaled_spectral, 2) + ", frobenius " +
          rounded_text(header.error.frobenius, 2) + ", worst-column " +
          rounded_text(header.error.worst_column, 2);
  if (header.shift > 0) text += ", shift " + rounded_text(header.shift, 2);
  return text + ", residual " + rounded_text(header.error.solve_residual, 2);
}

std::string group_costs_text(const std::vector<GroupCost>& costs) {
  std::string text = padded("group", 32) + padded("stored", 12) + "decoded\n";
  std::uint64_t stored = 0, raw = 0;
  for (const GroupCost& cost : costs) {
    text += padded(cost.path, 31) + " " + padded(bytes_text(cost.stored_bytes), 12) +
            bytes_text(cost.raw_bytes) + "\n";
    stored += cost.stored_bytes;
    raw += cost.raw_bytes;
  }
  return text + padded("all", 32) + padded(bytes_text(stored), 12) + bytes_text(raw) + "\n";
}

std::string bytes_text(std::uint64_t bytes) {
  static constexpr std::array<const char*, 5> units{"B", "kB", "MB", "GB", "TB"};
  double value = static_cast<double>(bytes);
  std::size_t unit = 0;
  while (value >= 1000 && unit + 1 < units.size()) {
    value /= 1000;
    ++unit;
  }
  return rounded_text(value, 3) + " " + units[unit];
}

}  // namespace souple
