// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/compliance/precompute.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <thread>

#include "runtime/compliance/dense_tiled_compliance.hpp"
#include "runtime/fem/corotational_model.hpp"
#include "tools/compliance/check_support.hpp"
#include "tools/compliance/supernodal_factor.hpp"
#include "tools/compliance/tile_encoder.hpp"

namespace souple {
namespace {

// Tiles of 64 nodes: 147 KB in single precision, a chunk that a reader fetches at once.
constexpr Index largest_tile_nodes = 64;
// A column of A0 C0 further from the identity than this is refused; a sound mesh gives 1e-12.
constexpr double largest_residual = 1e-6;
constexpr std::size_t worker_count = 2;

/// What the columns are solved for and where they go.
struct Task {
  const BlockMatrix* a0 = nullptr;
  std::vector<Index> free_nodes;  ///< of the mesh, ascending: the unknowns
  std::vector<Index> unknown;     ///< of every mesh node, -1 if fixed
  std::vector<Index> surface;     ///< nodes of the compliance, ascending
  TileLayout layout;
  std::vector<double> tiles;          ///< result: the lower triangle
  std::vector<double> tile_residual;  ///< worst column of every tile column
};

Task make_task(const MeshLevel& level, const FixedSet* fixed, const BlockMatrix& a0) {
  Task task;
  task.a0 = &a0;
  task.unknown.assign(level.mesh.nodes.size(), 0);
  if (fixed)
    for (const Index node : fixed->nodes) task.unknown[std::size_t(node)] = -1;
  for (std::size_t node = 0; node < task.unknown.size(); ++node) {
    if (task.unknown[node] < 0) continue;
    task.unknown[node] = Index(task.free_nodes.size());
    task.free_nodes.push_back(Index(node));
  }
  for (const Index node : used_nodes(level.boundary))
    if (task.unknown[std::size_t(node)] >= 0) task.surface.push_back(node);
  const auto count = Index(task.surface.size());
  task.layout = {count, std::min(count, largest_tile_nodes)};
  return task;
}

// max over columns of ||A0 x - e||_2, A0 restricted to the free nodes.
double worst_residual(const Task& task, std::span<const double> solution, Index first_node,
                      Index node_count) {
  const BlockPattern& pattern = *task.a0->pattern;
  const std::size_t size = 3 * task.free_nodes.size();
  double worst = 0;
  for (Index c = 0; c < 3 * node_count; ++c) {
    const double* x = solution.data() + std::size_t(c) * size;
    const Index source = task.surface[std::size_t(first_node + c / 3)];
    double norm2 = 0;
    for (const Index node : task.free_nodes) {
      Vec3 sum = Vec3::Zero();
      for (Index b = pattern.row_begin[node]; b < pattern.row_begin[node + 1]; ++b) {
        const Index other = task.unknown[std::size_t(pattern.column[b])];
        if (other >= 0) sum.noalias() += task.a0->block(b) * Eigen::Map<const Vec3>(x + 3 * other);
      }
      if (node == source) sum[c % 3] -= 1;
      norm2 += sum.squaredNorm();
    }
    worst = std::max(worst, norm2);
  }
  return std::sqrt(worst);
}

// The rows of tiles (i, column), i >= column, from the solutions of one tile's columns.
void store_tiles(Task& task, std::span<const double> solution, std::int64_t column) {
  const std::int64_t t = task.layout.tile_nodes, n = task.layout.node_count;
  const std::size_t size = 3 * task.free_nodes.size();
  const std::int64_t columns = 3 * std::min(t, n - column * t);
  for (std::int64_t row = column * t; row < n; ++row) {
    const auto unknown = std::size_t(task.unknown[std::size_t(task.surface[std::size_t(row)])]);
    double* tile = task.tiles.data() +
                   TileLayout::block_index(row / t, column) * task.layout.block_scalars() +
                   9 * (row % t) * t;
    for (std::int64_t c = 0; c < columns; ++c)
      for (int k = 0; k < 3; ++k)
        tile[k * 3 * t + c] = solution[std::size_t(c) * size + 3 * unknown + std::size_t(k)];
  }
  double* diagonal =
      task.tiles.data() + TileLayout::block_index(column, column) * task.layout.block_scalars();
  for (std::int64_t i = 0; i < 3 * t; ++i)
    for (std::int64_t j = 0; j < i; ++j) {
      const double mean = 0.5 * (diagonal[i * 3 * t + j] + diagonal[j * 3 * t + i]);
      diagonal[i * 3 * t + j] = diagonal[j * 3 * t + i] = mean;
    }
}

bool solve_tile_column(Task& task, const SupernodalFactor& factor,
                       SupernodalFactor::Workspace& workspace, std::int64_t column) {
  const Index t = task.layout.tile_nodes;
  const Index first = Index(column) * t, count = std::min(t, task.layout.node_count - first);
  const auto right_sides = workspace.right_sides();
  if (right_sides.empty()) return false;
  std::fill_n(right_sides.begin(), factor.size() * 3 * std::size_t(count), 0.0);
  for (Index c = 0; c < 3 * count; ++c) {
    const Index unknown = task.unknown[std::size_t(task.surface[std::size_t(first + c / 3)])];
    right_sides[std::size_t(c) * factor.size() + 3 * std::size_t(unknown) + std::size_t(c % 3)] = 1;
  }
  const auto solution = factor.solve(workspace, 3 * std::size_t(count));
  if (solution.empty()) return false;
  task.tile_residual[std::size_t(column)] = worst_residual(task, solution, first, count);
  store_tiles(task, solution, column);
  return true;
}

// Tile columns are independent, so the bits do not depend on which thread takes which.
bool solve_all(Task& task, const SupernodalFactor& factor,
               const std::function<void(double)>& progress) {
  const std::int64_t tile_count = task.layout.tile_count();
  std::atomic<std::int64_t> next{0}, done{0};
  std::atomic<bool> ok{true};
  const auto work = [&](bool reports) {
    SupernodalFactor::Workspace workspace(factor, 3 * std::size_t(task.layout.tile_nodes));
    for (std::int64_t column; ok && (column = next++) < tile_count;) {
      if (!solve_tile_column(task, factor, workspace, column)) ok = false;
      // Column j of the lower triangle stores tile_count - j tiles, but costs one solve like any other.
      const double fraction = double(++done) / double(tile_count);
      if (reports && progress) progress(fraction);
    }
  };
  std::vector<std::jthread> helpers;
  for (std::size_t k = 1; k < worker_count; ++k) helpers.emplace_back(work, false);
  work(true);
  helpers.clear();
  return ok;
}

Status check_memory(const Task& task, ScalarType scalar, std::size_t limit) {
  const double scalars = double(task.layout.block_count()) * double(task.layout.block_scalars());
  const double solves = double(worker_count) * 4 * double(3 * task.free_nodes.size()) *
                        double(3 * task.layout.tile_nodes) * sizeof(double);
  const double needed = scalars * (sizeof(double) + (scalar == ScalarType::float32 ? 4 : 8)) + solves;
  if (needed <= double(limit)) return {};
  return make_issue(IssueCode::compliance_out_of_memory,
                    std::to_string(task.surface.size()) + " surface nodes need " +
                        std::to_string(std::llround(needed / 1e6)) + " MB, allowed are " +
                        std::to_string(limit / 1000000) + " MB");
}

Result<ComplianceHeader> make_header(const CompliancePrecomputeOptions& options,
                                     const Material& material, const FixedSet* fixed) {
  ComplianceHeader header;
  header.name = options.name;
  header.kind = options.kind;
  header.fixed_set = fixed ? fixed->name : "";
  header.scalar = options.scalar;
  if (options.kind == ComplianceKind::static_equilibrium) return header;
  const double h = options.time_step_s;
  if (!(h >= 1e-7 && h <= 10))
    return make_issue(IssueCode::material_out_of_range,
                      "time step " + std::to_string(h) + " s is outside [1e-7, 10]", options.name);
  header.time_step_s = h;
  header.mass_factor = 1 / (h * h) + material.rayleigh_mass_per_s / h;
  header.stiffness_factor = 1 + material.rayleigh_stiffness_s / h;
  return header;
}

}  // namespace

Result<ComplianceVariant> precompute_compliance(const MeshLevel& level, const Material& material,
                                                const FixedSet* fixed,
                                                const CompliancePrecomputeOptions& options) {
  auto header = make_header(options, material, fixed);
  if (!header) return header.issue();
  auto model = CorotationalModel::create(level.mesh, material);
  if (!model) return model.issue();
  if (fixed)
    if (auto status = check_fixed_set(*fixed, level.mesh.nodes.size()); !status) return status.issue();
  if (options.kind == ComplianceKind::static_equilibrium)
    if (auto status = check_static_support(level.mesh, fixed); !status) return status.issue();

  BlockMatrix a0(model->pattern());
  model->assemble_rest(header->mass_factor, header->stiffness_factor, a0);
  Task task = make_task(level, fixed, a0);
  if (task.surface.empty())
    return make_issue(IssueCode::fixed_set_invalid, "no surface node is left to move", options.name);
  if (auto status = check_memory(task, options.scalar, options.memory_limit_bytes); !status)
    return status.issue();
  const std::string worst_element = "worst element: tet " + std::to_string(model->worst_element());
  auto factor = SupernodalFactor::create(a0, task.free_nodes, options.memory_limit_bytes);
  if (!factor) {
    Issue issue = factor.issue();
    issue.where = worst_element;
    return issue;
  }
  task.tiles.assign(std::size_t(task.layout.block_count() * task.layout.block_scalars()), 0.0);
  task.tile_residual.assign(std::size_t(task.layout.tile_count()), 0.0);
  if (!solve_all(task, *factor, options.progress))
    return make_issue(IssueCode::compliance_out_of_memory, "the solves ran out of memory");

  header->error.solve_residual = *std::ranges::max_element(task.tile_residual);
  if (!(header->error.solve_residual <= largest_residual))
    return make_issue(
        IssueCode::compliance_residual_too_large,
        "a column of A0 C0 is " + std::to_string(header->error.solve_residual) + " from the identity",
        worst_element);
  header->node_count = task.layout.node_count;
  header->tile_nodes = task.layout.tile_nodes;
  header->block_count = task.layout.block_count();
  header->block_scalars = task.layout.block_scalars();
  ComplianceVariant variant;
  variant.payload = encode_tiles(task.tiles, task.layout, options.scalar, header->error);
  variant.header = std::move(*header);
  variant.nodes = std::move(task.surface);
  return variant;
}

}  // namespace souple
