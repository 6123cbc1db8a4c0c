// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <cstring>
#include <iterator>

#include "formats/core/limits.hpp"
#include "formats/read/internal/check_rows.hpp"
#include "formats/read/internal/checks.hpp"
#include "formats/storage/layout.hpp"

namespace souple::checks {
namespace {

/// Blocks and scalars of a dense_tiled payload of n nodes (asset.hpp).
struct TileCounts {
  std::int64_t blocks;
  std::int64_t scalars;
};

TileCounts dense_tile_counts(std::int64_t node_count, std::int64_t tile_nodes) {
  const std::int64_t tiles = (node_count + tile_nodes - 1) / tile_nodes;
  return {tiles * (tiles + 1) / 2, 9 * tile_nodes * tile_nodes};
}

/// The rest is for the index to say.
bool has_sane_leaf_counts(const ComplianceHeader& header) {
  return header.tile_nodes == 0 && header.block_scalars == 0 && header.block_count >= 1 &&
         header.block_count <= header.node_count;
}

bool has_sane_counts(const ComplianceHeader& header) {
  if (header.node_count < 1 || static_cast<std::uint64_t>(header.node_count) > limits::nodes)
    return false;
  if (header.representation == ComplianceRepresentation::hierarchical)
    return has_sane_leaf_counts(header);
  if (header.tile_nodes < 1 || header.tile_nodes > limits::tile_nodes) return false;
  const TileCounts counts = dense_tile_counts(header.node_count, header.tile_nodes);
  const auto block_bytes = static_cast<std::uint64_t>(counts.scalars) * layout::bytes_of(header.scalar);
  return header.block_count == counts.blocks && header.block_scalars == counts.scalars &&
         static_cast<std::uint64_t>(counts.blocks) <= limits::payload_bytes / block_bytes;
}

void check_numbers(const ComplianceHeader& header, const std::string& where, IssueList& issues) {
  const auto not_negative = [](double x) { return std::isfinite(x) && x >= 0; };
  const bool dynamic = header.kind == ComplianceKind::dynamic_step;
  const bool time_step_ok =
      dynamic ? std::isfinite(header.time_step_s) && header.time_step_s > 0 : header.time_step_s == 0;
  if (!time_step_ok)
    issues.add(IssueCode::asset_compliance_invalid, where,
               [&] { return "the time step is " + std::to_string(header.time_step_s) + " s"; });
  for (const double value : {header.mass_factor, header.stiffness_factor, header.tolerance_asked,
                             header.error.solve_residual, header.error.scaled_spectral,
                             header.error.frobenius, header.error.worst_column, header.shift})
    if (!not_negative(value))
      issues.add(IssueCode::asset_compliance_invalid, where,
                 [&] { return "a factor, tolerance, error or shift is " + std::to_string(value); });
  if (header.shift != 0 && header.representation != ComplianceRepresentation::hierarchical)
    issues.add(IssueCode::asset_compliance_invalid, where,
               [&] { return "a dense compliance with a shift of " + std::to_string(header.shift); });
  if (header.coarsening < 0 || header.coarsening > 1)
    issues.add(IssueCode::asset_compliance_invalid, where,
               [&] { return "a coarsening of " + std::to_string(header.coarsening) + " levels"; });
}

/// Where the scalars of one block lie and which of them belong to nodes.
struct BlockView {
  std::int64_t width;      ///< rows and columns of the block, 3 tile_nodes
  std::int64_t used_rows;  ///< the rest is zero
  std::int64_t used_columns;
  bool diagonal;
};

template <class Scalar>
bool all_finite(const std::byte* bytes, std::size_t count) {
  // x - x is 0 for finite x and NaN otherwise; sums of it stay 0, and the loop vectorises.
  Scalar sum = 0;
  for (std::size_t i = 0; i < count; ++i) {
    Scalar x;
    std::memcpy(&x, bytes + i * sizeof x, sizeof x);
    sum += x - x;
  }
  return sum == 0;
}

/// nullptr, or what is wrong with the block.
template <class Scalar>
const char* fault_of_tile(const BlockView& view, const std::byte* bytes) {
  const auto at = [&](std::int64_t row, std::int64_t column) {
    Scalar x;
    std::memcpy(&x, bytes + static_cast<std::size_t>(row * view.width + column) * sizeof x, sizeof x);
    return x;
  };
  if (!all_finite<Scalar>(bytes, static_cast<std::size_t>(view.width * view.width)))
    return "a scalar is not finite";
  for (std::int64_t row = 0; row < view.width; ++row) {
    if (view.diagonal && row < view.used_rows && !(at(row, row) > 0))
      return "a diagonal entry is not positive";
    const std::int64_t first_unused = row < view.used_rows ? view.used_columns : 0;
    for (std::int64_t column = first_unused; column < view.width; ++column)
      if (at(row, column) != 0) return "a scalar past the last node is not zero";
  }
  return nullptr;
}

void check_tiles(const ComplianceVariant& variant, const std::string& where, IssueList& issues) {
  const ComplianceHeader& header = variant.header;
  const std::int64_t width = 3 * header.tile_nodes;
  const std::size_t block_bytes =
      static_cast<std::size_t>(header.block_scalars) * layout::bytes_of(header.scalar);
  const auto used = [&](std::int64_t tile) {
    return std::min(width, 3 * header.node_count - tile * width);
  };
  std::int64_t row_tile = 0, column_tile = 0;
  for (std::int64_t block = 0; block < header.block_count; ++block) {
    const BlockView view{width, used(row_tile), used(column_tile), row_tile == column_tile};
    const std::byte* bytes = variant.payload.data() + static_cast<std::size_t>(block) * block_bytes;
    const char* fault = header.scalar == ScalarType::float32 ? fault_of_tile<float>(view, bytes)
                                                             : fault_of_tile<double>(view, bytes);
    if (fault != nullptr)
      issues.add(IssueCode::asset_compliance_invalid, where,
                 [&] { return "block " + std::to_string(block) + ": " + fault; });
    if (++column_tile > row_tile) {
      ++row_tile;
      column_tile = 0;
    }
  }
}

/// The finest-level nodes: one per row of the compliance, or of its prolongation.
void check_nodes(const ComplianceVariant& variant, std::size_t node_count, const std::string& where,
                 IssueList& issues) {
  const auto refuse = [&](const char* what) {
    issues.add(IssueCode::asset_compliance_invalid, where, [&] { return std::string(what); });
  };
  const auto& nodes = variant.nodes;
  const bool prolonged = variant.header.coarsening != 0;
  const auto row_count =
      prolonged ? variant.prolongation.size() : static_cast<std::uint64_t>(variant.header.node_count);
  if (nodes.empty() || nodes.size() != row_count)
    refuse("the node list has not the length that the header or the prolongation says");
  else if (std::ranges::adjacent_find(nodes, std::ranges::greater_equal{}) != nodes.end())
    refuse("the nodes are not ascending");
  else if (nodes.front() < 0 || static_cast<std::size_t>(nodes.back()) >= node_count)
    refuse("a node lies outside the mesh");
}

void check_prolongation(const ComplianceVariant& variant, const std::string& where, IssueList& issues) {
  const auto& rows = variant.prolongation;
  if (variant.header.coarsening == 0 && !rows.empty())
    issues.add(IssueCode::asset_compliance_invalid, where,
               [] { return "a prolongation without a coarsening"; });
  const auto outside = [&](Index row) { return row < 0 || row >= variant.header.node_count; };
  for (std::size_t r = 0; r < rows.size(); ++r) {
    if (std::ranges::any_of(rows[r].row, outside))
      issues.add(IssueCode::asset_compliance_invalid, where, [&] {
        return "row " + std::to_string(r) + " of the prolongation names a row that is not stored";
      });
    if (!has_sound_weights(rows[r].weight))
      issues.add(IssueCode::asset_compliance_invalid, where, [&] {
        return "the weights of row " + std::to_string(r) + " of the prolongation are not of sum 1";
      });
  }
}

/// Empty, or how the blocks contradict the header.
std::string fault_of_blocks(const ComplianceVariant& variant, std::uint64_t payload_bytes) {
  const ComplianceHeader& header = variant.header;
  if (header.representation == ComplianceRepresentation::hierarchical) {
    if (header.block_count + 1 != static_cast<std::int64_t>(variant.hierarchy.record_begin.size()))
      return std::to_string(header.block_count) + " blocks are not one per leaf";
    return fault_of(variant.hierarchy, header.node_count, payload_bytes);
  }
  const auto scalar_count = static_cast<std::uint64_t>(header.block_count * header.block_scalars);
  return payload_bytes == scalar_count * layout::bytes_of(header.scalar)
             ? ""
             : "the payload has not the size that the header says";
}

bool nearly_equal(double a, double b) { return std::abs(a - b) <= 1e-12 * std::abs(b); }

void check_factors(const ComplianceHeader& header, const Material& material, const std::string& where,
                   IssueList& issues) {
  const bool dynamic = header.kind == ComplianceKind::dynamic_step;
  const double h = header.time_step_s;
  const double mass = dynamic ? 1 / (h * h) + material.rayleigh_mass_per_s / h : 0;
  const double stiffness = dynamic ? 1 + material.rayleigh_stiffness_s / h : 1;
  if (!nearly_equal(header.mass_factor, mass) || !nearly_equal(header.stiffness_factor, stiffness))
    issues.add(IssueCode::asset_compliance_invalid, where, [&] {
      return "the factors " + std::to_string(header.mass_factor) + " and " +
             std::to_string(header.stiffness_factor) + " should be " + std::to_string(mass) + " and " +
             std::to_string(stiffness) + " for this time step and damping";
    });
}

}  // namespace

void check_compliance_header(const ComplianceHeader& header, const std::string& where,
                             IssueList& issues) {
  check_numbers(header, where, issues);
  if (!has_sane_counts(header))
    issues.add(IssueCode::asset_compliance_invalid, where, [&] {
      return std::to_string(header.block_count) + " blocks of " + std::to_string(header.block_scalars) +
             " scalars in tiles of " + std::to_string(header.tile_nodes) + " do not fit " +
             std::to_string(header.node_count) + " nodes";
    });
}

void check_compliance_index(const ComplianceVariant& variant, std::uint64_t payload_bytes,
                            std::size_t node_count, const std::string& where, IssueList& issues) {
  const std::size_t before = issues.count();
  check_compliance_header(variant.header, where, issues);
  if (issues.count() != before) return;
  check_nodes(variant, node_count, where, issues);
  check_prolongation(variant, where, issues);
  const std::string fault = fault_of_blocks(variant, payload_bytes);
  if (!fault.empty()) issues.add(IssueCode::asset_compliance_invalid, where, [&] { return fault; });
}

void check_compliance(const ComplianceVariant& variant, std::size_t node_count,
                      const std::string& where, IssueList& issues) {
  const std::size_t before = issues.count();
  check_compliance_index(variant, variant.payload.size(), node_count, where, issues);
  if (issues.count() == before &&
      variant.header.representation == ComplianceRepresentation::dense_tiled)
    check_tiles(variant, where, issues);
}

void check_compliance_context(const ComplianceVariant& variant, const Asset& asset,
                              const std::string& where, IssueList& issues) {
  const ComplianceHeader& header = variant.header;
  check_factors(header, asset.material, where, issues);
  if (header.fixed_set.empty()) {
    if (header.kind == ComplianceKind::static_equilibrium)
      issues.add(IssueCode::asset_compliance_invalid, where,
                 [] { return "a static compliance without a fixed set"; });
    return;
  }
  const auto set = std::ranges::find(asset.fixed_sets, header.fixed_set, &FixedSet::name);
  if (set == asset.fixed_sets.end()) {
    issues.add(IssueCode::asset_compliance_invalid, where,
               [&] { return "the fixed set " + header.fixed_set + " is not in the asset"; });
    return;
  }
  std::vector<Index> both;
  std::ranges::set_intersection(set->nodes, variant.nodes, std::back_inserter(both));
  if (!both.empty())
    issues.add(IssueCode::asset_compliance_invalid, where, [&] {
      return "node " + std::to_string(both.front()) + " is fixed and has a row in the compliance";
    });
}

}  // namespace souple::checks
