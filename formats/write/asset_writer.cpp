// SPDX-License-Identifier: MIT
#include "formats/write/asset_writer.hpp"

#include <algorithm>
#include <exception>
#include <functional>

#include "formats/read/content_hash.hpp"
#include "formats/read/validate.hpp"
#include "formats/storage/byte_device.hpp"
#include "formats/storage/device_driver.hpp"
#include "formats/storage/layout.hpp"
#include "formats/write/internal/group_writer.hpp"
#include "formats/write/replace_file.hpp"

namespace souple {
namespace {

using storage::GroupWriter;

template <std::size_t N, class Enumeration>
std::string_view text_of(const std::array<std::string_view, N>& texts, Enumeration value) {
  return texts[static_cast<std::size_t>(value)];
}

void write_root(const GroupWriter& root, const Asset& asset) {
  root.text(layout::format, layout::format_name);
  root.integer(layout::version_major, asset_version_major);
  root.integer(layout::version_minor, asset_version_minor);
  root.text(layout::generator, asset.provenance.generator);
  root.text(layout::recipe, asset.provenance.recipe);
  root.text(layout::input_name, asset.provenance.input_name);
  root.text(layout::input_hash, asset.provenance.input_hash);
  root.text(layout::content_hash, content_hash(asset));
  if (asset.default_solver != SolverKind::automatic)
    root.text(layout::default_solver, solver_name(asset.default_solver));
}

void write_embedding(const GroupWriter& group, const std::vector<Embedding>& rows) {
  std::vector<Index> tets;
  std::vector<std::array<double, 4>> weights;
  tets.reserve(rows.size());
  weights.reserve(rows.size());
  for (const Embedding& row : rows) {
    tets.push_back(row.tet);
    weights.push_back(row.weights);
  }
  group.rows(layout::embedding_tets, tets);
  group.rows(layout::embedding_weights, weights);
}

void write_level(const GroupWriter& group, const MeshLevel& level) {
  group.rows(layout::nodes, level.mesh.nodes);
  group.rows(layout::tets, level.mesh.tets);
  group.rows(layout::boundary, level.boundary);
  if (!level.parents.empty()) group.rows(layout::parents, level.parents);
  if (!level.embedding.empty()) write_embedding(group, level.embedding);
  const RigidMotionError& error = level.rigid_motion_error;
  if (error.parents >= 0) group.real(layout::parents_error, error.parents);
  if (error.embedding >= 0) group.real(layout::embedding_error, error.embedding);
}

void write_mesh(const GroupWriter& root, const Asset& asset) {
  const GroupWriter mesh = root.group(layout::mesh);
  {
    const GroupWriter levels = mesh.group(layout::levels);
    for (std::size_t l = 0; l < asset.levels.size(); ++l)
      write_level(levels.group(std::to_string(l)), asset.levels[l]);
  }
  if (asset.visual.surface.vertices.empty()) return;
  const GroupWriter visual = mesh.group(layout::visual);
  visual.rows(layout::vertices, asset.visual.surface.vertices);
  visual.rows(layout::triangles, asset.visual.surface.triangles);
  write_embedding(visual, asset.visual.embedding);
}

void write_multigrid(const GroupWriter& root, const Asset& asset) {
  if (asset.multigrid.empty()) return;
  const GroupWriter parent = root.group(layout::multigrid);
  for (std::size_t l = 0; l < asset.multigrid.size(); ++l) {
    const LevelTransition& transition = asset.multigrid[l];
    const GroupWriter group = parent.group(std::to_string(l + 1));
    group.rows(layout::row_begin, transition.row_begin);
    group.rows(layout::column, transition.column);
    group.rows(layout::weight, transition.weight);
    group.rows(layout::pattern_begin, transition.pattern_begin);
    group.rows(layout::pattern_column, transition.pattern_column);
    group.rows(layout::plan_pieces, transition.pieces);
    group.rows(layout::plan_slots, transition.slots);
    group.rows(layout::plan_targets, transition.targets);
  }
}

void write_material(const GroupWriter& root, const Material& material) {
  const GroupWriter group = root.group(layout::material);
  group.real(layout::rayleigh_mass, material.rayleigh_mass_per_s);
  group.real(layout::rayleigh_stiffness, material.rayleigh_stiffness_s);
  std::vector<std::string> names;
  std::vector<double> young, poisson, density;
  for (const MaterialRegion& region : material.regions) {
    names.push_back(region.name);
    young.push_back(region.young_pa);
    poisson.push_back(region.poisson);
    density.push_back(region.density_kg_m3);
  }
  group.texts(layout::region_names, names);
  group.rows(layout::young, young);
  group.rows(layout::poisson, poisson);
  group.rows(layout::density, density);
  if (!material.tet_region.empty()) group.rows(layout::tet_region, material.tet_region);
}

void write_header(const GroupWriter& group, const ComplianceHeader& header) {
  group.text(layout::kind, text_of(layout::kinds, header.kind));
  group.real(layout::time_step, header.time_step_s);
  group.text(layout::fixed_set, header.fixed_set);
  group.real(layout::mass_factor, header.mass_factor);
  group.real(layout::stiffness_factor, header.stiffness_factor);
  group.real(layout::tolerance_asked, header.tolerance_asked);
  group.real(layout::solve_residual, header.error.solve_residual);
  group.real(layout::scaled_spectral, header.error.scaled_spectral);
  group.real(layout::frobenius, header.error.frobenius);
  group.real(layout::worst_column, header.error.worst_column);
  group.text(layout::representation, text_of(layout::representations, header.representation));
  group.text(layout::scalar, text_of(layout::scalars, header.scalar));
  group.integer(layout::node_count, header.node_count);
  group.integer(layout::tile_nodes, header.tile_nodes);
  group.integer(layout::block_count, header.block_count);
  group.integer(layout::block_scalars, header.block_scalars);
  group.text(layout::error_norm, text_of(layout::error_norms, header.error_norm));
  group.real(layout::shift, header.shift);
  group.integer(layout::coarsening, header.coarsening);
}

void write_prolongation(const GroupWriter& group, const std::vector<RowProlongation>& prolongation) {
  std::vector<std::array<Index, 4>> rows;
  std::vector<std::array<double, 4>> weights;
  for (const RowProlongation& row : prolongation) {
    rows.push_back(row.row);
    weights.push_back(row.weight);
  }
  group.rows_if_any(layout::prolongation_rows, rows);
  group.rows_if_any(layout::prolongation_weights, weights);
}

void write_hierarchy(const GroupWriter& group, const HierarchicalIndex& index) {
  group.integer(layout::depth, index.depth);
  group.rows_if_any(layout::order, index.order);
  group.rows_if_any(layout::scale, index.scale);
  group.rows_if_any(layout::leaf_step, index.leaf_step);
  group.rows_if_any(layout::leaf_planes, index.leaf_planes);
  group.rows_if_any(layout::rank, index.rank);
  group.rows_if_any(layout::step, index.step);
  group.rows_if_any(layout::singular, index.singular);
  group.rows_if_any(layout::planes, index.planes);
  group.rows_if_any(layout::record_begin, index.record_begin);
}

void write_tiles(const GroupWriter& group, const ComplianceVariant& variant) {
  const ComplianceHeader& header = variant.header;
  const hid_t scalar = header.scalar == ScalarType::float32 ? H5T_IEEE_F32LE : H5T_IEEE_F64LE;
  const storage::RowType row{scalar, layout::bytes_of(header.scalar),
                             static_cast<std::size_t>(header.block_scalars)};
  group.bulk(layout::payload, row, static_cast<std::uint64_t>(header.block_count), variant.payload);
}

void write_compliance(const GroupWriter& parent, const ComplianceVariant& variant) {
  const ComplianceHeader& header = variant.header;
  const GroupWriter group = parent.group(header.name);
  write_header(group, header);
  group.rows(layout::nodes, variant.nodes);
  write_prolongation(group, variant.prolongation);
  if (header.representation == ComplianceRepresentation::dense_tiled)
    return write_tiles(group, variant);
  write_hierarchy(group, variant.hierarchy);
  group.records(layout::payload, variant.payload);
}

/// Parts by name, so that their order in memory does not change the file.
template <class Part, class Name>
std::vector<const Part*> by_name(const std::vector<Part>& parts, const Name& name) {
  std::vector<const Part*> sorted;
  for (const Part& part : parts) sorted.push_back(&part);
  std::ranges::sort(sorted, {},
                    [&](const Part* part) -> const std::string& { return std::invoke(name, *part); });
  return sorted;
}

void write_groups(const GroupWriter& root, const Asset& asset) {
  write_root(root, asset);
  write_mesh(root, asset);
  write_multigrid(root, asset);
  write_material(root, asset.material);
  if (!asset.fixed_sets.empty()) {
    const GroupWriter parent = root.group(layout::constraints);
    for (const FixedSet* set : by_name(asset.fixed_sets, &FixedSet::name))
      parent.group(set->name).rows(layout::nodes, set->nodes);
  }
  if (!asset.compliances.empty()) {
    const GroupWriter parent = root.group(layout::compliance);
    const auto name = [](const ComplianceVariant& v) -> const std::string& { return v.header.name; };
    for (const ComplianceVariant* variant : by_name(asset.compliances, name))
      write_compliance(parent, *variant);
  }
}

Status check_before_writing(const Asset& asset, const WriteOptions& options) {
  if (options.zstd_level < 1 || options.zstd_level > 19)
    return make_issue(IssueCode::usage_bad_value,
                      "the zstd level is " + std::to_string(options.zstd_level) + ", not 1 to 19");
  const ValidationReport report = validate_asset_content(asset, {1});
  if (!report.valid()) return report.issues.front();
  return {};
}

/// The whole file in memory: what HDF5 does cannot fail half-way on a full disk.
Status build_file(const Asset& asset, const WriteOptions& options, storage::SegmentBuffer& buffer) {
  if (Status status = check_before_writing(asset, options); !status) return status;
  const storage::Hdf5Session session;
  storage::Handle file = storage::create_device(buffer);
  storage::WriteProgress progress{options.zstd_level};
  if (file)
    write_groups(GroupWriter(storage::Handle(H5Gopen2(file.get(), "/", H5P_DEFAULT)), progress), asset);
  if (!file || !file.close() || !progress.ok)
    return make_issue(IssueCode::io_out_of_memory, "HDF5 could not build the file in memory");
  return {};
}

}  // namespace

Status write_asset(const Asset& asset, const std::filesystem::path& file, const WriteOptions& options) {
  try {
    storage::SegmentBuffer buffer;
    if (Status status = build_file(asset, options, buffer); !status) return status;
    return replace_file(file, buffer.pieces());
  } catch (const std::exception& error) {
    return make_issue(IssueCode::io_out_of_memory, error.what(), file.string());
  }
}

Result<std::vector<std::byte>> write_asset_memory(const Asset& asset, const WriteOptions& options) {
  try {
    storage::SegmentBuffer buffer;
    if (Status status = build_file(asset, options, buffer); !status) return status.issue();
    std::vector<std::byte> bytes;
    bytes.reserve(buffer.size());
    for (const auto& piece : buffer.pieces()) bytes.insert(bytes.end(), piece.begin(), piece.end());
    return bytes;
  } catch (const std::exception& error) {
    return make_issue(IssueCode::io_out_of_memory, error.what());
  }
}

}  // namespace souple
