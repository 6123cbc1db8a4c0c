// SPDX-License-Identifier: MIT
#include "runtime/compliance/rest_compliance.hpp"

#include <algorithm>
#include <cmath>
#include <new>

#include "runtime/compliance/dense_tiled_compliance.hpp"
#include "runtime/compliance/hierarchical_compliance.hpp"
#include "runtime/compliance/pair_table.hpp"

namespace souple {

namespace {

using Opened = Result<std::unique_ptr<const RestCompliance>>;

// In units of the diagonal of C~, about 1.
constexpr double largest_shift = 1e3;

Opened open_dense_tiled(const ComplianceHeader& header, std::unique_ptr<BlockSource> source) {
  const TileLayout layout{static_cast<Index>(header.node_count), static_cast<Index>(header.tile_nodes)};
  if (header.node_count < 1 || header.tile_nodes < 1 || header.node_count > (Index{1} << 28) ||
      header.tile_nodes > 4096 || header.block_count != layout.block_count() ||
      header.block_scalars != layout.block_scalars())
    return make_issue(IssueCode::asset_corrupt,
                      "the blocks of the compliance do not fit its node count",
                      "compliance/" + header.name);
  std::unique_ptr<const RestCompliance> compliance;
  if (header.scalar == ScalarType::float32)
    compliance = std::make_unique<DenseTiledCompliance<float>>(layout, std::move(source));
  else
    compliance = std::make_unique<DenseTiledCompliance<double>>(layout, std::move(source));
  return compliance;
}

Issue corrupt(const ComplianceHeader& header, const std::string& what) {
  return make_issue(IssueCode::asset_corrupt, what, "compliance/" + header.name);
}

bool is_whole(const DecodedRecords& records) {
  for (Index leaf = 0; leaf < records.leaf_count(); ++leaf)
    if (!records.is_ready(leaf)) return false;
  return true;
}

// What is in memory already is decoded here, so that no step has to.
Opened open_hierarchical(const ComplianceHeader& header, const HierarchicalIndex& hierarchy,
                         std::unique_ptr<BlockSource> source, std::size_t table_bytes) {
  const std::int64_t payload_bytes = hierarchy.record_begin.empty() ? 0 : hierarchy.record_begin.back();
  const std::string fault =
      fault_of(hierarchy, header.node_count, static_cast<std::uint64_t>(payload_bytes));
  if (!fault.empty()) return corrupt(header, fault);
  if (!(std::isfinite(header.shift) && header.shift >= 0 && header.shift <= largest_shift))
    return corrupt(header, "the shift is not a small positive number");
  auto records = std::make_unique<DecodedRecords>(static_cast<Index>(header.node_count), hierarchy,
                                                  header.shift, std::move(source));
  for (Index leaf = 0; leaf < records->leaf_count(); ++leaf)
    if (!records->make_if_there(leaf))
      return corrupt(header, "record " + std::to_string(leaf) + " cannot be decoded");
  std::unique_ptr<const PairTable> table;
  if (PairTable::bytes_for(records->node_count()) <= table_bytes && is_whole(*records))
    table = PairTable::create(*records);
  std::unique_ptr<const RestCompliance> compliance =
      std::make_unique<HierarchicalCompliance>(std::move(records), std::move(table));
  return compliance;
}

}  // namespace

// By chunks of rows: few enough that what symmetry would give costs little; enough that a
// representation can work by small matrix products.
void RestCompliance::gather_lower(std::span<const Index> rows, float* out, std::size_t stride,
                                  ComplianceWork& work) const {
  constexpr std::size_t chunk = 128;
  for (std::size_t first = 0, last; first < rows.size(); first = last) {
    last = std::min(first + chunk, rows.size());
    gather_block(rows.subspan(first, last - first), rows.first(last), out + 3 * first * stride, stride,
                 work);
  }
}

Result<std::unique_ptr<const RestCompliance>> open_rest_compliance(const ComplianceHeader& header,
                                                                   const HierarchicalIndex& hierarchy,
                                                                   std::unique_ptr<BlockSource> source,
                                                                   std::size_t table_bytes) {
  if (header.representation == ComplianceRepresentation::dense_tiled)
    return open_dense_tiled(header, std::move(source));
  if (header.representation == ComplianceRepresentation::hierarchical) {
    try {
      return open_hierarchical(header, hierarchy, std::move(source), table_bytes);
    } catch (const std::bad_alloc&) {
      return corrupt(header, "its blocks do not fit the memory");
    }
  }
  return make_issue(IssueCode::unsupported_feature,
                    "compliance \"" + header.name + "\" has an unknown representation");
}

}  // namespace souple
