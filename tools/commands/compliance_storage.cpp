// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/commands/compliance_storage.hpp"

#include <algorithm>
#include <vector>

#include "tools/commands/asset_json.hpp"
#include "tools/exchange/numbers.hpp"

namespace souple {
namespace {

struct Spread {
  std::int64_t least = 0, middle = 0, most = 0;
};

/// The middle one of an even count is the lower.
Spread spread_of(std::vector<std::int64_t> values) {
  if (values.empty()) return {};
  std::ranges::sort(values);
  return {values.front(), values[(values.size() - 1) / 2], values.back()};
}

/// Ranks of the blocks of one halving, from the whole body down.
std::vector<Spread> ranks_by_level(const ComplianceSummary& summary) {
  std::vector<Spread> levels;
  for (int depth = 0; depth < summary.depth; ++depth) {
    const auto first = summary.rank.begin() + block_of_cluster(depth, 0);
    levels.push_back(spread_of({first, first + (std::ptrdiff_t{1} << depth)}));
  }
  return levels;
}

/// What a contact touches: the record of every leaf it has a node in, or every tile of a row of tiles.
struct TouchedUnit {
  std::int64_t count = 0;  ///< leaves, or rows of tiles
  Spread bytes;            ///< of the payload, of one
};

TouchedUnit touched_unit(const ComplianceSummary& summary) {
  const ComplianceHeader& header = summary.header;
  if (header.representation == ComplianceRepresentation::hierarchical) {
    std::vector<std::int64_t> bytes;
    for (std::size_t leaf = 0; leaf + 1 < summary.record_begin.size(); ++leaf)
      bytes.push_back(summary.record_begin[leaf + 1] - summary.record_begin[leaf]);
    return {header.block_count, spread_of(std::move(bytes))};
  }
  const std::int64_t tile_rows = (header.node_count + header.tile_nodes - 1) / header.tile_nodes;
  const std::int64_t tile_bytes = header.block_scalars * (header.scalar == ScalarType::float32 ? 4 : 8);
  return {tile_rows, {tile_rows * tile_bytes, tile_rows * tile_bytes, tile_rows * tile_bytes}};
}

/// What is read before any record: nodes, prolongation and index.
struct IndexCost {
  std::uint64_t stored_bytes, raw_bytes;
};

IndexCost index_cost(const GroupCost& cost) {
  return {cost.stored_bytes - cost.payload_stored_bytes, cost.raw_bytes - cost.payload_raw_bytes};
}

/// As doubles of every pair of the nodes that it stands for: 72 bytes a pair.
double raw_double_bytes(const ComplianceSummary& summary) {
  const auto nodes = static_cast<double>(summary.surface_node_count);
  return 72 * nodes * nodes;
}

double ratio_to_raw_doubles(const ComplianceSummary& summary, const GroupCost& cost) {
  return raw_double_bytes(summary) / static_cast<double>(cost.stored_bytes);
}

/// Single-precision values that a leaf's record becomes: its own block and its rows of every term.
std::int64_t decoded_leaf_bytes(const ComplianceSummary& summary, Index leaf) {
  const auto depth = static_cast<int>(summary.depth);
  const auto node_count = static_cast<Index>(summary.header.node_count);
  const std::int64_t rows = 3 * std::int64_t{cluster_range(node_count, depth, leaf).size()};
  std::int64_t columns = rows;
  for (int d = 0; d < depth; ++d)
    columns += summary.rank[static_cast<std::size_t>(block_of_cluster(d, leaf >> (depth - d)))];
  return 4 * rows * columns;
}

/// In memory once loaded, about.
std::uint64_t decoded_bytes(const ComplianceSummary& summary, const GroupCost& cost) {
  if (summary.header.representation == ComplianceRepresentation::dense_tiled) return cost.raw_bytes;
  std::uint64_t bytes = index_cost(cost).raw_bytes;
  for (Index leaf = 0; leaf < static_cast<Index>(summary.header.block_count); ++leaf)
    bytes += static_cast<std::uint64_t>(decoded_leaf_bytes(summary, leaf));
  return bytes;
}

Json spread_json(const Spread& spread) {
  return {{"min", spread.least}, {"median", spread.middle}, {"max", spread.most}};
}

}  // namespace

Json compliance_storage_json(const ComplianceSummary& summary, const GroupCost& cost) {
  const IndexCost index = index_cost(cost);
  Json ranks = Json::array();
  for (const Spread& level : ranks_by_level(summary)) ranks.push_back(spread_json(level));
  const TouchedUnit unit = touched_unit(summary);
  return {
      {"stored_bytes", cost.stored_bytes},
      {"raw_double_bytes", raw_double_bytes(summary)},
      {"ratio_to_raw_doubles", ratio_to_raw_doubles(summary, cost)},
      {"rank_by_level", ranks},
      {"load", {{"read_bytes", cost.stored_bytes}, {"decoded_bytes", decoded_bytes(summary, cost)}}},
      {"streamed_load", {{"read_bytes", index.stored_bytes}, {"decoded_bytes", index.raw_bytes}}},
      {"contact",
       {{"unit_count", unit.count},
        {"payload_bytes_per_unit", spread_json(unit.bytes)},
        {"chunk_bytes", cost.payload_chunk_bytes}}}};
}

std::string compliance_storage_text(const ComplianceSummary& summary, const GroupCost& cost) {
  const bool hierarchical = summary.header.representation == ComplianceRepresentation::hierarchical;
  std::string text = "  " + bytes_text(cost.stored_bytes) + " in the file, " +
                     rounded_text(ratio_to_raw_doubles(summary, cost), 3) +
                     " times smaller than raw doubles; loading it takes " +
                     bytes_text(decoded_bytes(summary, cost)) + " of memory";
  if (hierarchical) text += ", streaming it " + bytes_text(index_cost(cost).raw_bytes) + " at first";
  text += "\n";
  if (summary.depth > 0) {
    text += "  ranks by level (min/median/max):";
    for (const Spread& level : ranks_by_level(summary))
      text += " " + std::to_string(level.least) + "/" + std::to_string(level.middle) + "/" +
              std::to_string(level.most);
    text += "\n";
  }
  const TouchedUnit unit = touched_unit(summary);
  return text + "  a contact touches " + bytes_text(static_cast<std::uint64_t>(unit.bytes.middle)) +
         " of each of the " + std::to_string(unit.count) +
         (hierarchical ? " leaves" : " rows of tiles") + " it is in\n";
}

}  // namespace souple
