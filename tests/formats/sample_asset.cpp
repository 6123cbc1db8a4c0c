// SPDX-License-Identifier: MIT
#include "sample_asset.hpp"

#include <stdlib.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <tuple>

#include "runtime/multigrid/level_transitions.hpp"
#include "sample_embedding.hpp"
#include "sample_hierarchy.hpp"

namespace souple::test {
namespace {

constexpr double side_m = 0.2;

int node_index(int cells, int x, int y, int z) { return (z * (cells + 1) + y) * (cells + 1) + x; }

/// Nodes of the refined grid at even places are coarse nodes, the others halve an edge of Kuhn's cubes,
/// which all run from (0, 0, 0) towards (1, 1, 1).
std::vector<std::array<Index, 2>> refined_parents(int coarse_cells) {
  std::vector<std::array<Index, 2>> parents;
  const int fine = 2 * coarse_cells;
  for (int z = 0; z <= fine; ++z)
    for (int y = 0; y <= fine; ++y)
      for (int x = 0; x <= fine; ++x)
        parents.push_back({node_index(coarse_cells, x / 2, y / 2, z / 2),
                           node_index(coarse_cells, (x + 1) / 2, (y + 1) / 2, (z + 1) / 2)});
  return parents;
}

FixedSet bottom_nodes(const TetMesh& mesh) {
  FixedSet set{"bottom", {}};
  for (std::size_t i = 0; i < mesh.nodes.size(); ++i)
    if (mesh.nodes[i][2] == 0) set.nodes.push_back(static_cast<Index>(i));
  return set;
}

/// Decays with distance; symmetric; rough enough in its last digits not to shrink to nothing.
double compliance_entry(const TetMesh& mesh, Index i, Index j, int axis_i, int axis_j) {
  const Point& a = mesh.nodes[static_cast<std::size_t>(i)];
  const Point& b = mesh.nodes[static_cast<std::size_t>(j)];
  const double d[3] = {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
  const double distance = std::sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]) + 0.01;
  const double tensor = (axis_i == axis_j ? 1.0 : 0.0) + d[axis_i] * d[axis_j] / (distance * distance);
  return 1e-3 * tensor / distance * (1 + 0.05 * std::sin(40 * (a[0] + b[0]) + 70 * (a[1] + b[1])));
}

template <class Scalar>
std::vector<std::byte> make_payload(const TetMesh& mesh, const ComplianceVariant& variant) {
  const std::int64_t tile = variant.header.tile_nodes, n = variant.header.node_count;
  const std::int64_t tiles = (n + tile - 1) / tile;
  std::vector<Scalar> scalars;
  for (std::int64_t bi = 0; bi < tiles; ++bi)
    for (std::int64_t bj = 0; bj <= bi; ++bj)
      for (std::int64_t r = 3 * tile * bi; r < 3 * tile * (bi + 1); ++r)
        for (std::int64_t c = 3 * tile * bj; c < 3 * tile * (bj + 1); ++c) {
          const bool used = r < 3 * n && c < 3 * n;
          const auto node = [&](std::int64_t row) {
            return variant.nodes[static_cast<std::size_t>(row / 3)];
          };
          scalars.push_back(
              used ? static_cast<Scalar>(compliance_entry(
                         mesh, node(r), node(c), static_cast<int>(r % 3), static_cast<int>(c % 3)))
                   : Scalar{0});
        }
  std::vector<std::byte> bytes(scalars.size() * sizeof(Scalar));
  std::memcpy(bytes.data(), scalars.data(), bytes.size());
  return bytes;
}

ComplianceVariant make_variant(const Asset& asset, const std::string& name, ComplianceKind kind,
                               const FixedSet* fixed, const SampleOptions& options) {
  const MeshLevel& finest = asset.levels.back();
  ComplianceVariant variant;
  const std::vector<Index> surface = used_nodes(finest.boundary);
  if (fixed != nullptr)
    std::ranges::set_difference(surface, fixed->nodes, std::back_inserter(variant.nodes));
  else
    variant.nodes = surface;
  ComplianceHeader& header = variant.header;
  header.name = name;
  header.kind = kind;
  header.fixed_set = fixed != nullptr ? fixed->name : "";
  const bool dynamic = kind == ComplianceKind::dynamic_step;
  const double h = dynamic ? 0.01 : 0;
  header.time_step_s = h;
  header.mass_factor = dynamic ? 1 / (h * h) + asset.material.rayleigh_mass_per_s / h : 0;
  header.stiffness_factor = dynamic ? 1 + asset.material.rayleigh_stiffness_s / h : 1;
  header.error = {1e-14, 3e-8, 2e-8, 4e-8};
  header.scalar = dynamic ? ScalarType::float32 : ScalarType::float64;
  header.node_count = static_cast<std::int64_t>(variant.nodes.size());
  header.tile_nodes = options.tile_nodes;
  const std::int64_t tiles = (header.node_count + options.tile_nodes - 1) / options.tile_nodes;
  header.block_count = tiles * (tiles + 1) / 2;
  header.block_scalars = 9 * options.tile_nodes * options.tile_nodes;
  variant.payload =
      dynamic ? make_payload<float>(finest.mesh, variant) : make_payload<double>(finest.mesh, variant);
  return variant;
}

void tie(const TetMesh& coarse, int coarse_cells, Ties ties, MeshLevel& fine) {
  if (ties != Ties::embedding) fine.parents = refined_parents(coarse_cells);
  if (ties == Ties::parents) return;
  for (Point& node : fine.mesh.nodes) node[2] += node[2] * (side_m - node[2]);
  fine.embedding = embed_points(fine.mesh.nodes, coarse);
  fine.rigid_motion_error = {fine.parents.empty() ? -1 : 0.0625, 3e-16};
}

VisualMesh make_visual(int cells, const TetMesh& finest) {
  const TetMesh box = make_box(cells);
  VisualMesh visual;
  visual.surface.triangles = boundary_triangles(box.tets);
  const std::vector<Index> used = used_nodes(visual.surface.triangles);
  for (const Index node : used) {
    Point vertex = box.nodes[static_cast<std::size_t>(node)];
    for (double& x : vertex) x += 0.02 * (x - side_m / 2);
    visual.surface.vertices.push_back(vertex);
  }
  for (Triangle& triangle : visual.surface.triangles)
    for (Index& node : triangle)
      node = static_cast<Index>(std::ranges::lower_bound(used, node) - used.begin());
  visual.embedding = embed_points(visual.surface.vertices, finest);
  return visual;
}

void add_regions(Asset& asset, int count) {
  static const char* const names[] = {"flesh", "härter", "bone"};
  for (int r = 0; r < count; ++r)
    asset.material.regions.push_back({names[r % 3], 1e4 * (r + 1), 0.4, 1000});
  if (count < 2) return;
  for (std::size_t t = 0; t < asset.levels.back().mesh.tets.size(); ++t)
    asset.material.tet_region.push_back(static_cast<Index>(t) % count);
}

}  // namespace

TetMesh make_box(int cells) {
  static constexpr int orders[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2},
                                       {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
  TetMesh mesh;
  for (int z = 0; z <= cells; ++z)
    for (int y = 0; y <= cells; ++y)
      for (int x = 0; x <= cells; ++x)
        mesh.nodes.push_back({side_m * x / cells, side_m * y / cells, side_m * z / cells});
  for (int z = 0; z < cells; ++z)
    for (int y = 0; y < cells; ++y)
      for (int x = 0; x < cells; ++x)
        for (const auto& order : orders) {
          int corner[3] = {x, y, z};
          Tet tet{};
          for (std::size_t k = 0; k < 4; ++k) {
            tet[k] = node_index(cells, corner[0], corner[1], corner[2]);
            if (k < 3) ++corner[order[k]];
          }
          const auto& p = mesh.nodes;
          const auto at = [&](std::size_t k) { return p[static_cast<std::size_t>(tet[k])]; };
          if (signed_volume6(at(0), at(1), at(2), at(3)) < 0) std::swap(tet[2], tet[3]);
          mesh.tets.push_back(tet);
        }
  return mesh;
}

Asset make_sample_asset(const SampleOptions& options) {
  Asset asset;
  for (int l = 0, cells = options.cells; l < options.levels; ++l, cells *= 2) {
    MeshLevel level;
    level.mesh = make_box(cells);
    level.boundary = boundary_triangles(level.mesh.tets);
    if (l > 0) tie(asset.levels.back().mesh, cells / 2, options.ties, level);
    asset.levels.push_back(std::move(level));
  }
  if (options.multigrid) asset.multigrid = store_transitions(asset.levels).value();
  if (options.visual_cells > 0)
    asset.visual = make_visual(options.visual_cells, asset.levels.back().mesh);
  add_regions(asset, options.regions);
  const auto dynamic = ComplianceKind::dynamic_step;
  asset.compliances.push_back(make_variant(asset, "default", dynamic, nullptr, options));
  if (options.fixed_bottom) {
    asset.fixed_sets.push_back(bottom_nodes(asset.levels.back().mesh));
    asset.fixed_sets.push_back({"ecke", {0}});
    const FixedSet& bottom = asset.fixed_sets.front();
    asset.compliances.push_back(make_variant(asset, "clamped", dynamic, &bottom, options));
    if (options.static_variant)
      asset.compliances.push_back(
          make_variant(asset, "clamped-static", ComplianceKind::static_equilibrium, &bottom, options));
  }
  if (options.hierarchical) {
    asset.compliances.push_back(make_hierarchical_variant(asset, 2, 4));
    if (options.levels > 1) asset.compliances.push_back(make_coarse_variant(asset));
  }
  asset.provenance = {"souple 0.1.0", "[mesh]\ntets = 48\n# größe\n", "box.obj",
                      "00112233445566778899aabbccddeeff"};
  return asset;
}

namespace {

auto header_fields(const ComplianceHeader& h) {
  return std::tie(h.name, h.kind, h.time_step_s, h.fixed_set, h.mass_factor, h.stiffness_factor,
                  h.tolerance_asked, h.error.solve_residual, h.error.scaled_spectral, h.error.frobenius,
                  h.error.worst_column, h.representation, h.scalar, h.node_count, h.tile_nodes,
                  h.block_count, h.block_scalars, h.error_norm, h.shift, h.coarsening);
}

auto hierarchy_fields(const HierarchicalIndex& h) {
  return std::tie(h.depth, h.order, h.scale, h.leaf_step, h.leaf_planes, h.rank, h.step, h.singular,
                  h.planes, h.record_begin);
}

bool same_prolongation(const RowProlongation& a, const RowProlongation& b) {
  return a.row == b.row && a.weight == b.weight;
}

bool same_row(const Embedding& a, const Embedding& b) {
  return a.tet == b.tet && a.weights == b.weights;
}

bool same_visual(const VisualMesh& a, const VisualMesh& b) {
  return a.surface.vertices == b.surface.vertices && a.surface.triangles == b.surface.triangles &&
         std::ranges::equal(a.embedding, b.embedding, same_row);
}

bool same_level(const MeshLevel& a, const MeshLevel& b) {
  return a.mesh.nodes == b.mesh.nodes && a.mesh.tets == b.mesh.tets && a.boundary == b.boundary &&
         a.parents == b.parents && std::ranges::equal(a.embedding, b.embedding, same_row) &&
         a.rigid_motion_error.parents == b.rigid_motion_error.parents &&
         a.rigid_motion_error.embedding == b.rigid_motion_error.embedding;
}

bool same_region(const MaterialRegion& a, const MaterialRegion& b) {
  return a.name == b.name && a.young_pa == b.young_pa && a.poisson == b.poisson &&
         a.density_kg_m3 == b.density_kg_m3;
}

bool same_material(const Material& a, const Material& b) {
  return std::ranges::equal(a.regions, b.regions, same_region) && a.tet_region == b.tet_region &&
         a.rayleigh_mass_per_s == b.rayleigh_mass_per_s &&
         a.rayleigh_stiffness_s == b.rayleigh_stiffness_s;
}

bool same_set(const FixedSet& a, const FixedSet& b) { return a.name == b.name && a.nodes == b.nodes; }

bool same_variant(const ComplianceVariant& a, const ComplianceVariant& b) {
  return header_fields(a.header) == header_fields(b.header) && a.nodes == b.nodes &&
         std::ranges::equal(a.prolongation, b.prolongation, same_prolongation) &&
         hierarchy_fields(a.hierarchy) == hierarchy_fields(b.hierarchy) && a.payload == b.payload;
}

bool same_provenance(const Provenance& a, const Provenance& b) {
  return std::tie(a.generator, a.recipe, a.input_name, a.input_hash) ==
         std::tie(b.generator, b.recipe, b.input_name, b.input_hash);
}

/// Named parts have no order of their own; the file lists them ascending.
Asset sorted(Asset asset) {
  std::ranges::sort(asset.fixed_sets, {}, &FixedSet::name);
  std::ranges::sort(asset.compliances, {}, [](const auto& v) { return v.header.name; });
  return asset;
}

}  // namespace

bool same_content(const Asset& first, const Asset& second) {
  const Asset a = sorted(first), b = sorted(second);
  return std::ranges::equal(a.levels, b.levels, same_level) && a.multigrid == b.multigrid &&
         a.default_solver == b.default_solver && same_visual(a.visual, b.visual) &&
         same_material(a.material, b.material) &&
         std::ranges::equal(a.fixed_sets, b.fixed_sets, same_set) &&
         std::ranges::equal(a.compliances, b.compliances, same_variant) &&
         same_provenance(a.provenance, b.provenance);
}

ScratchFolder::ScratchFolder() {
  std::string name = (std::filesystem::temp_directory_path() / "souple-test-XXXXXX").string();
  if (::mkdtemp(name.data()) == nullptr) throw std::runtime_error("no scratch folder");
  folder_ = name;
}

ScratchFolder::~ScratchFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(folder_, ignored);
}

std::size_t ScratchFolder::entry_count() const {
  const std::filesystem::directory_iterator entries(folder_);
  return static_cast<std::size_t>(std::distance(begin(entries), end(entries)));
}

std::vector<std::byte> read_bytes(const std::string& file) {
  std::ifstream stream(file, std::ios::binary);
  const std::string text((std::istreambuf_iterator<char>(stream)), {});
  const auto bytes = std::as_bytes(std::span(text));
  return {bytes.begin(), bytes.end()};
}

void write_bytes(const std::string& file, std::span<const std::byte> bytes) {
  std::ofstream stream(file, std::ios::binary);
  stream.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  if (!stream.flush()) throw std::runtime_error("cannot write " + file);
}

}  // namespace souple::test
