// SPDX-License-Identifier: GPL-3.0-or-later
// souple inspect ASSET: what it holds and what each part costs. Reads headers and the small parts
// (material, fixed sets, ranks), never nodes, tets or compliance blocks.
#include "formats/read/asset_reader.hpp"

#include <algorithm>

#include "tools/cli/command_line.hpp"
#include "tools/cli/json_output.hpp"
#include "tools/commands/asset_json.hpp"
#include "tools/commands/compliance_storage.hpp"
#include "tools/exchange/numbers.hpp"

namespace souple {
namespace {

struct Contents {
  std::string file;
  int version_major = 0, version_minor = 0;
  std::string content_hash;
  Provenance provenance;
  SolverKind default_solver = SolverKind::automatic;
  std::vector<LevelSizes> levels;
  VisualSizes visual;
  Material material;
  std::vector<std::pair<std::string, std::size_t>> fixed_sets;  ///< name and node count
  std::vector<ComplianceSummary> compliances;
  std::vector<GroupCost> costs;
  std::uint64_t bytes_read = 0;
};

/// Moves the value out, or keeps the issue.
template <class T>
bool take(Result<T> result, T& value, Status& status) {
  if (result)
    value = std::move(result).value();
  else
    status = result.issue();
  return result.ok();
}

Status read_lists(AssetReader& reader, Contents& contents) {
  Status status;
  for (std::size_t l = 0; l < reader.level_count(); ++l)
    if (!take(reader.read_level_sizes(l), contents.levels.emplace_back(), status)) return status;
  for (const std::string& name : reader.fixed_set_names()) {
    const auto set = reader.read_fixed_set(name);
    if (!set) return set.issue();
    contents.fixed_sets.emplace_back(name, set->nodes.size());
  }
  for (const std::string& name : reader.compliance_names())
    if (!take(reader.read_compliance_summary(name), contents.compliances.emplace_back(), status))
      return status;
  return {};
}

Result<Contents> read_contents(const std::string& file) {
  auto reader = AssetReader::open(file);
  if (!reader) return reader.issue();
  Contents contents;
  contents.file = file;
  contents.version_major = reader->version_major();
  contents.version_minor = reader->version_minor();
  contents.content_hash = reader->content_hash();
  Status status = read_lists(*reader, contents);
  if (!status || !take(reader->read_visual_sizes(), contents.visual, status) ||
      !take(reader->read_provenance(), contents.provenance, status) ||
      !take(reader->read_default_solver(), contents.default_solver, status) ||
      !take(reader->read_material(), contents.material, status) ||
      !take(reader->group_costs(), contents.costs, status))
    return status.issue();
  contents.bytes_read = reader->bytes_read();
  return contents;
}

/// Of the variant's group; every group is listed.
GroupCost cost_of(const Contents& c, const ComplianceSummary& summary) {
  const auto found = std::ranges::find(c.costs, "compliance/" + summary.header.name, &GroupCost::path);
  return found == c.costs.end() ? GroupCost{} : *found;
}

Json contents_json(const Contents& c) {
  Json document = schema_header("inspect");
  document["file"] = c.file;
  document["format_version"] = {c.version_major, c.version_minor};
  document["content_hash"] = c.content_hash;
  document["provenance"] = {{"generator", c.provenance.generator},
                            {"input_name", c.provenance.input_name},
                            {"input_hash", c.provenance.input_hash},
                            {"recipe", c.provenance.recipe}};
  document["default_solver"] = std::string(solver_name(c.default_solver));
  document["levels"] = Json::array();
  for (const LevelSizes& level : c.levels)
    document["levels"].push_back({{"node_count", level.node_count},
                                  {"tet_count", level.tet_count},
                                  {"boundary_triangle_count", level.boundary_triangle_count},
                                  {"has_parents", level.has_parents},
                                  {"has_embedding", level.has_embedding},
                                  {"rigid_motion_error",
                                   {{"parents", level.rigid_motion_error.parents},
                                    {"embedding", level.rigid_motion_error.embedding}}}});
  document["visual"] = {{"vertex_count", c.visual.vertex_count},
                        {"triangle_count", c.visual.triangle_count}};
  document["material"] = material_json(c.material);
  document["fixed_sets"] = Json::array();
  for (const auto& [name, count] : c.fixed_sets)
    document["fixed_sets"].push_back({{"name", name}, {"node_count", count}});
  document["compliances"] = Json::array();
  for (const ComplianceSummary& summary : c.compliances) {
    Json compliance = compliance_json(summary.header);
    compliance["surface_node_count"] = summary.surface_node_count;
    compliance["storage"] = compliance_storage_json(summary, cost_of(c, summary));
    document["compliances"].push_back(std::move(compliance));
  }
  document["groups"] = group_costs_json(c.costs);
  document["bytes_read"] = c.bytes_read;
  return document;
}

/// How the level hangs on the coarser one, and how well that carries rotations.
std::string tie_text(const LevelSizes& level) {
  const auto error = [](double value) {
    return value < 0 ? std::string() : " (rotations to " + rounded_text(value, 2) + ")";
  };
  std::string text;
  if (level.has_parents) text += ", nested" + error(level.rigid_motion_error.parents);
  if (level.has_embedding) text += ", embedded" + error(level.rigid_motion_error.embedding);
  return text;
}

std::string levels_text(const Contents& c) {
  std::string text;
  for (std::size_t l = 0; l < c.levels.size(); ++l)
    text += "level " + std::to_string(l) + ": " + std::to_string(c.levels[l].node_count) + " nodes, " +
            std::to_string(c.levels[l].tet_count) + " tets, " +
            std::to_string(c.levels[l].boundary_triangle_count) + " boundary triangles" +
            tie_text(c.levels[l]) + "\n";
  if (c.visual.vertex_count > 0)
    text += "visual surface: " + std::to_string(c.visual.vertex_count) + " vertices, " +
            std::to_string(c.visual.triangle_count) + " triangles\n";
  return text;
}

std::string material_text(const Material& material) {
  std::string text;
  for (const MaterialRegion& region : material.regions)
    text += "material" + (region.name.empty() ? "" : " " + region.name) + ": E " +
            rounded_text(region.young_pa) + " Pa, nu " + rounded_text(region.poisson) + ", density " +
            rounded_text(region.density_kg_m3) + " kg/m^3\n";
  return text + "damping: alpha " + rounded_text(material.rayleigh_mass_per_s) + " 1/s, beta " +
         rounded_text(material.rayleigh_stiffness_s) + " s\n";
}

std::string contents_text(const Contents& c, bool verbose) {
  std::string text = c.file + ": souple asset " + std::to_string(c.version_major) + "." +
                     std::to_string(c.version_minor) + ", made by " + c.provenance.generator +
                     " from " + c.provenance.input_name + "\n";
  text += levels_text(c) + material_text(c.material);
  text += "default solver: " + std::string(solver_name(c.default_solver)) + "\n";
  for (const auto& [name, count] : c.fixed_sets)
    text += "fixed set " + name + ": " + std::to_string(count) + " nodes\n";
  for (const ComplianceSummary& summary : c.compliances)
    text +=
        compliance_text(summary.header) + "\n" + compliance_storage_text(summary, cost_of(c, summary));
  text += "\n" + group_costs_text(c.costs);
  text += "content " + c.content_hash + ", input " + c.provenance.input_hash + "\n";
  return verbose ? text + "\nrecipe:\n" + c.provenance.recipe : text;
}

}  // namespace

Result<ExitCode> run_inspect(const Arguments& arguments) {
  std::string file;
  CommandLine line("inspect", "What is in an asset and what each part costs. Reads headers only.");
  line.app().add_option("ASSET", file, "the .souple file")->required();
  const auto parsed = line.parse(arguments);
  if (!parsed) return parsed.issue();
  if (*parsed == ParseOutcome::help_printed) return ExitCode::ok;
  const auto contents = read_contents(file);
  if (!contents) return contents.issue();
  const Status printed = line.common().json
                             ? print_json(contents_json(*contents))
                             : print_data(contents_text(*contents, line.common().verbose));
  if (!printed) return printed.issue();
  return ExitCode::ok;
}

}  // namespace souple
