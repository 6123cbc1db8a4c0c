// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <cstring>
#include <iterator>

#include "formats/core/limits.hpp"
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

bool has_sane_counts(const ComplianceHeader& header) {
  if (header.node_count < 1 || static_cast<std::uint64_t>(header.node_count) > limits::nodes)
    return false;
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
                             header.error.frobenius, header.error.worst_column})
    if (!not_negative(value))
      issues.add(IssueCode::asset_compliance_invalid, where,
                 [&] { return "a factor, tolerance or error is " + std::to_string(value); });
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

/// Empty, or what is wrong with the block.
template <class Scalar>
const char* fault_of(const BlockView& view, const std::byte* bytes) {
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

void check_payload(const ComplianceVariant& variant, const std::string& where, IssueList& issues) {
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
    const char* fault = header.scalar == ScalarType::float32 ? fault_of<float>(view, bytes)
                                                             : fault_of<double>(view, bytes);
    if (fault != nullptr)
      issues.add(IssueCode::asset_compliance_invalid, where,
                 [&] { return "block " + std::to_string(block) + ": " + fault; });
    if (++column_tile > row_tile) {
      ++row_tile;
      column_tile = 0;
    }
  }
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
             " scalars do not fit " + std::to_string(header.node_count) + " nodes in tiles of " +
             std::to_string(header.tile_nodes);
    });
}

void check_compliance(const ComplianceVariant& variant, std::size_t node_count,
                      const std::string& where, IssueList& issues) {
  const std::size_t before = issues.count();
  const ComplianceHeader& header = variant.header;
  check_compliance_header(header, where, issues);
  const auto refuse = [&](const char* what) {
    issues.add(IssueCode::asset_compliance_invalid, where, [&] { return std::string(what); });
  };
  const auto& nodes = variant.nodes;
  if (nodes.size() != static_cast<std::uint64_t>(header.node_count))
    refuse("the node list has not the length that the header says");
  else if (std::ranges::adjacent_find(nodes, std::ranges::greater_equal{}) != nodes.end())
    refuse("the nodes are not ascending");
  else if (!nodes.empty() &&
           (nodes.front() < 0 || static_cast<std::size_t>(nodes.back()) >= node_count))
    refuse("a node lies outside the mesh");
  if (issues.count() != before) return;
  const auto scalar_count = static_cast<std::uint64_t>(header.block_count * header.block_scalars);
  if (variant.payload.size() != scalar_count * layout::bytes_of(header.scalar))
    refuse("the payload has not the size that the header says");
  else
    check_payload(variant, where, issues);
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
