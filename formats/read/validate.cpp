// SPDX-License-Identifier: MIT
#include "formats/read/validate.hpp"

#include <algorithm>
#include <exception>

#include "formats/core/limits.hpp"
#include "formats/read/asset_reader.hpp"
#include "formats/read/content_hash.hpp"
#include "formats/read/internal/checks.hpp"

namespace souple {
namespace {

/// What ties a level to the coarser one, nullptr for level 0; places only where both meshes are sound.
void check_level_above(const MeshLevel* coarse, const MeshLevel& level, bool meshes_ok,
                       const std::string& where, IssueList& issues) {
  const std::size_t before = issues.count();
  const checks::MeshCounts counts =
      coarse == nullptr ? checks::MeshCounts{}
                        : checks::MeshCounts{coarse->mesh.nodes.size(), coarse->mesh.tets.size()};
  checks::check_level_ties(level, counts, where, issues);
  if (coarse == nullptr || !meshes_ok || issues.count() != before) return;
  checks::check_parents(*coarse, level, where, issues);
  checks::check_level_places(*coarse, level, where, issues);
}

/// False if the finest level cannot be pointed at.
bool check_levels(const Asset& asset, IssueList& issues) {
  if (asset.levels.empty() || asset.levels.size() > limits::levels) {
    issues.add(make_issue(
        IssueCode::asset_mesh_inconsistent,
        std::to_string(asset.levels.size()) + " levels, not 1 to " + std::to_string(limits::levels),
        "mesh/levels"));
    return false;
  }
  bool coarse_ok = false;
  for (std::size_t l = 0; l < asset.levels.size(); ++l) {
    const MeshLevel& level = asset.levels[l];
    const std::string where = "mesh/levels/" + std::to_string(l);
    const std::size_t before = issues.count();
    checks::check_level_mesh(level, where, issues);
    const bool mesh_ok = issues.count() == before;
    if (mesh_ok) checks::check_level_shape(level, where, issues);
    check_level_above(l == 0 ? nullptr : &asset.levels[l - 1], level, mesh_ok && (l == 0 || coarse_ok),
                      where, issues);
    coarse_ok = mesh_ok;
  }
  return coarse_ok;
}

void check_multigrid(const Asset& asset, IssueList& issues) {
  if (asset.multigrid.empty()) return;
  if (asset.multigrid.size() + 1 != asset.levels.size())
    return issues.add(IssueCode::asset_multigrid_invalid, "multigrid", [&] {
      return std::to_string(asset.multigrid.size()) + " transitions between " +
             std::to_string(asset.levels.size()) + " levels";
    });
  for (std::size_t l = 1; l < asset.levels.size(); ++l)
    checks::check_transition(asset.multigrid[l - 1], asset.levels[l].mesh.nodes.size(),
                             asset.levels[l - 1].mesh.nodes.size(), "multigrid/" + std::to_string(l),
                             issues);
}

void check_visual(const Asset& asset, bool finest_ok, IssueList& issues) {
  const TetMesh& finest = asset.levels.back().mesh;
  const std::size_t before = issues.count();
  checks::check_visual(asset.visual, finest.tets.size(), "mesh/visual", issues);
  if (finest_ok && issues.count() == before)
    checks::check_visual_places(asset.visual, finest, "mesh/visual", issues);
}

void check_content(const Asset& asset, IssueList& issues) {
  checks::check_names(asset, issues);
  const bool finest_ok = check_levels(asset, issues);
  if (asset.levels.empty()) return;
  check_multigrid(asset, issues);
  check_visual(asset, finest_ok, issues);
  const TetMesh& finest = asset.levels.back().mesh;
  checks::check_material(asset.material, finest.tets.size(), "material", issues);
  for (const FixedSet& set : asset.fixed_sets)
    checks::check_fixed_set(set, finest.nodes.size(), "constraints/" + set.name, issues);
  for (const ComplianceVariant& variant : asset.compliances) {
    const std::string where = "compliance/" + variant.header.name;
    checks::check_compliance(variant, finest.nodes.size(), where, issues);
    checks::check_compliance_context(variant, asset, where, issues);
  }
}

/// Moves a part into the asset, or its issue into the list.
template <class Part>
void take(Result<Part> part, std::vector<Part>& parts, IssueList& issues) {
  if (part)
    parts.push_back(std::move(part).value());
  else
    issues.add(part.issue());
}

/// Every part on its own, so that one damaged group does not hide the state of the others.
Asset read_parts(AssetReader& reader, IssueList& issues) {
  Asset asset;
  for (std::size_t l = 0; l < reader.level_count(); ++l)
    take(reader.read_level(l), asset.levels, issues);
  for (std::size_t l = 1; reader.has_multigrid() && l < reader.level_count(); ++l)
    take(reader.read_transition(l), asset.multigrid, issues);
  if (reader.has_visual()) {
    if (Result<VisualMesh> visual = reader.read_visual(); visual)
      asset.visual = std::move(visual).value();
    else
      issues.add(visual.issue());
  }
  if (Result<Material> material = reader.read_material(); material)
    asset.material = std::move(material).value();
  else
    issues.add(material.issue());
  for (const std::string& name : reader.fixed_set_names())
    take(reader.read_fixed_set(name), asset.fixed_sets, issues);
  for (const std::string& name : reader.compliance_names())
    take(reader.read_compliance(name), asset.compliances, issues);
  if (Result<Provenance> provenance = reader.read_provenance(); provenance)
    asset.provenance = std::move(provenance).value();
  else
    issues.add(provenance.issue());
  if (const Result<SolverKind> solver = reader.read_default_solver(); solver)
    asset.default_solver = *solver;
  else
    issues.add(solver.issue());
  return asset;
}

ValidationReport validate_opened(Result<AssetReader> reader, const ValidationOptions& options) {
  IssueList issues(options);
  if (!reader) {
    issues.add(reader.issue());
    return issues.take();
  }
  const Asset asset = read_parts(*reader, issues);
  // A part that could not be read would make the rest look wrong.
  if (!issues.empty()) return issues.take();
  check_content(asset, issues);
  if (const std::string hash = content_hash(asset); hash != reader->content_hash())
    issues.add(make_issue(IssueCode::asset_hash_mismatch, "the content has the hash " + hash +
                                                              ", stored is " + reader->content_hash()));
  return issues.take();
}

/// Nothing but lack of memory throws below.
template <class Validation>
ValidationReport guarded(const Validation& validation) {
  try {
    return validation();
  } catch (const std::exception& error) {
    ValidationReport report;
    report.issues.push_back(make_issue(IssueCode::io_out_of_memory, error.what()));
    return report;
  }
}

}  // namespace

bool ValidationReport::valid() const {
  const auto is_error = [](const Issue& issue) { return issue.severity == Severity::error; };
  return suppressed_count == 0 && std::ranges::none_of(issues, is_error);
}

ValidationReport validate_asset_file(const std::filesystem::path& file,
                                     const ValidationOptions& options) {
  return guarded([&] { return validate_opened(AssetReader::open(file), options); });
}

ValidationReport validate_asset_memory(std::span<const std::byte> bytes,
                                       const ValidationOptions& options) {
  return guarded([&] { return validate_opened(AssetReader::open_memory(bytes), options); });
}

ValidationReport validate_asset_content(const Asset& asset, const ValidationOptions& options) {
  return guarded([&] {
    IssueList issues(options);
    check_content(asset, issues);
    return issues.take();
  });
}

}  // namespace souple
