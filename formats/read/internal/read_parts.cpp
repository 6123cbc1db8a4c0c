// SPDX-License-Identifier: MIT
#include "formats/read/internal/read_parts.hpp"

#include <algorithm>
#include <span>
#include <utility>

#include "formats/core/limits.hpp"
#include "formats/core/names.hpp"
#include "formats/read/internal/checks.hpp"
#include "formats/read/internal/take.hpp"
#include "formats/storage/layout.hpp"

namespace souple::storage {
namespace {

Result<std::vector<std::string>> read_region_names(const GroupReader& material) {
  const Result<DatasetReader> dataset = material.dataset(layout::region_names);
  if (!dataset) return dataset.issue();
  const auto damaged = [&](const char* what) {
    return make_issue(IssueCode::asset_corrupt, what, material.where() + "/" + layout::region_names);
  };
  if (!dataset->is_text() || dataset->rows() > limits::regions)
    return damaged("not a list of at most 256 texts of fixed length");
  const Result<std::vector<char>> bytes = dataset->read_all<char>(limits::regions);
  if (!bytes) return bytes.issue();
  std::vector<std::string> names;
  for (std::size_t r = 0; r < dataset->rows(); ++r) {
    std::string name(bytes->data() + r * dataset->scalar_bytes(), dataset->scalar_bytes());
    name.resize(name.find_last_not_of('\0') + 1);
    if (!is_valid_name(name)) return damaged("the name of a region is not allowed");
    names.push_back(std::move(name));
  }
  return names;
}

Result<std::vector<Embedding>> read_embedding(const GroupReader& group) {
  Status status;
  std::vector<Index> tets;
  std::vector<std::array<double, 4>> weights;
  const bool read =
      take(read_rows<Index>(group, layout::embedding_tets, limits::nodes), tets, status) &&
      take(read_rows<std::array<double, 4>>(group, layout::embedding_weights, limits::nodes), weights,
           status);
  if (!read) return status.issue();
  if (tets.size() != weights.size())
    return make_issue(IssueCode::asset_corrupt, "the columns of the embedding differ in length",
                      group.where());
  std::vector<Embedding> rows(tets.size());
  for (std::size_t r = 0; r < rows.size(); ++r) rows[r] = {tets[r], weights[r]};
  return rows;
}

}  // namespace

Result<MeshCounts> read_level_counts(const GroupReader& level) {
  const Result<DatasetReader> nodes = level.dataset(layout::nodes);
  if (!nodes) return nodes.issue();
  const Result<DatasetReader> tets = level.dataset(layout::tets);
  if (!tets) return tets.issue();
  return MeshCounts{nodes->rows(), tets->rows()};
}

Result<MeshLevel> read_level_mesh(const GroupReader& group) {
  MeshLevel level;
  Status status;
  const bool read =
      take(read_rows<Point>(group, layout::nodes, limits::nodes), level.mesh.nodes, status) &&
      take(read_rows<Tet>(group, layout::tets, limits::tets), level.mesh.tets, status) &&
      take(read_rows<Triangle>(group, layout::boundary, limits::triangles), level.boundary, status);
  if (!read) return status.issue();
  IssueList issues = first_issue_only();
  checks::check_level_mesh(level, group.where(), issues);
  return checked(std::move(level), issues);
}

Result<LevelTies> read_level_ties(const GroupReader& group) {
  LevelTies ties;
  Status status;
  const bool read =
      take(group.has(layout::parents), ties.parents, status) &&
      take(group.has(layout::embedding_tets), ties.embedding, status) &&
      take(group.real_or(layout::parents_error, -1), ties.rigid_motion_error.parents, status) &&
      take(group.real_or(layout::embedding_error, -1), ties.rigid_motion_error.embedding, status);
  if (!read) return status.issue();
  return ties;
}

Result<MeshLevel> read_level(const GroupReader& group, const MeshCounts& coarse) {
  Result<MeshLevel> read = read_level_mesh(group);
  if (!read || coarse.nodes == 0) return read;
  MeshLevel& level = *read;
  Status status;
  LevelTies ties;
  if (!take(read_level_ties(group), ties, status)) return status.issue();
  level.rigid_motion_error = ties.rigid_motion_error;
  if (ties.parents && !take(read_rows<std::array<Index, 2>>(group, layout::parents, limits::nodes),
                            level.parents, status))
    return status.issue();
  if (ties.embedding && !take(read_embedding(group), level.embedding, status)) return status.issue();
  IssueList issues = first_issue_only();
  checks::check_level_ties(level, coarse, group.where(), issues);
  return checked(std::move(level), issues);
}

Result<LevelTransition> read_transition(const GroupReader& group, const MeshCounts& fine,
                                        const MeshCounts& coarse) {
  LevelTransition t;
  Status status;
  constexpr std::uint64_t most = limits::plan_rows;
  const bool read =
      take(read_rows<Index>(group, layout::row_begin, most), t.row_begin, status) &&
      take(read_rows<Index>(group, layout::column, most), t.column, status) &&
      take(read_rows<double>(group, layout::weight, most), t.weight, status) &&
      take(read_rows<Index>(group, layout::pattern_begin, most), t.pattern_begin, status) &&
      take(read_rows<Index>(group, layout::pattern_column, most), t.pattern_column, status) &&
      take(read_rows<std::array<Index, 4>>(group, layout::plan_pieces, most), t.pieces, status) &&
      take(read_rows<std::array<std::uint8_t, 4>>(group, layout::plan_slots, most), t.slots, status) &&
      take(read_rows<std::array<Index, 4>>(group, layout::plan_targets, most), t.targets, status);
  if (!read) return status.issue();
  IssueList issues = first_issue_only();
  checks::check_transition(t, fine.nodes, coarse.nodes, group.where(), issues);
  return checked(std::move(t), issues);
}

Result<VisualMesh> read_visual(const GroupReader& group, const MeshCounts& finest) {
  VisualMesh visual;
  Status status;
  const bool read =
      take(read_rows<Point>(group, layout::vertices, limits::nodes), visual.surface.vertices, status) &&
      take(read_rows<Triangle>(group, layout::triangles, limits::triangles), visual.surface.triangles,
           status) &&
      take(read_embedding(group), visual.embedding, status);
  if (!read) return status.issue();
  IssueList issues = first_issue_only();
  checks::check_visual(visual, finest.tets, group.where(), issues);
  return checked(std::move(visual), issues);
}

Result<Material> read_material(const GroupReader& group, const MeshCounts& finest) {
  Material material;
  Status status;
  std::vector<std::string> names;
  std::vector<double> young, poisson, density;
  const bool read = take(read_region_names(group), names, status) &&
                    take(read_rows<double>(group, layout::young, limits::regions), young, status) &&
                    take(read_rows<double>(group, layout::poisson, limits::regions), poisson, status) &&
                    take(read_rows<double>(group, layout::density, limits::regions), density, status) &&
                    take(group.real(layout::rayleigh_mass), material.rayleigh_mass_per_s, status) &&
                    take(group.real(layout::rayleigh_stiffness), material.rayleigh_stiffness_s, status);
  if (!read) return status.issue();
  if (young.size() != names.size() || poisson.size() != names.size() || density.size() != names.size())
    return make_issue(IssueCode::asset_corrupt, "the lists of regions differ in length", group.where());
  for (std::size_t r = 0; r < names.size(); ++r)
    material.regions.push_back({std::move(names[r]), young[r], poisson[r], density[r]});
  const Result<bool> has_tet_region = group.has(layout::tet_region);
  if (!has_tet_region) return has_tet_region.issue();
  if (*has_tet_region &&
      !take(read_rows<Index>(group, layout::tet_region, finest.tets), material.tet_region, status))
    return status.issue();
  IssueList issues = first_issue_only();
  checks::check_material(material, finest.tets, group.where(), issues);
  return checked(std::move(material), issues);
}

Result<FixedSet> read_fixed_set(const GroupReader& group, std::string name, const MeshCounts& finest) {
  FixedSet set{std::move(name), {}};
  Status status;
  if (!take(read_rows<Index>(group, layout::nodes, finest.nodes), set.nodes, status))
    return status.issue();
  IssueList issues = first_issue_only();
  checks::check_fixed_set(set, finest.nodes, group.where(), issues);
  return checked(std::move(set), issues);
}

}  // namespace souple::storage
