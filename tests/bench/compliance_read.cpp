// SPDX-License-Identifier: GPL-3.0-or-later
// What the file has to give for W of a contact patch: a compliance of the liver is streamed, 5 % of its
// surface come into contact at once, and all that is read for that is counted, the index and HDF5's own
// bookkeeping included. Rows compliance_read.*
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <thread>

#include "formats/write/asset_writer.hpp"
#include "runtime/compliance/open_variant.hpp"
#include "runtime/load/streaming_block_source.hpp"
#include "tests/bench/liver.hpp"
#include "tests/bench/row.hpp"

namespace souple::bench {
namespace {

constexpr std::size_t patch_count = 21;

/// Rows of the 5 % of the nodes that lie nearest to one of them.
std::vector<Index> patch_around(const std::vector<Point>& positions, std::size_t seed) {
  std::vector<std::pair<double, Index>> by_distance;
  for (std::size_t row = 0; row < positions.size(); ++row) {
    double square = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double d = positions[row][axis] - positions[seed][axis];
      square += d * d;
    }
    by_distance.emplace_back(square, static_cast<Index>(row));
  }
  std::ranges::sort(by_distance);
  std::vector<Index> rows;
  for (std::size_t k = 0; 20 * k < positions.size(); ++k) rows.push_back(by_distance[k].second);
  std::ranges::sort(rows);
  return rows;
}

std::vector<double> evaluate(const RestCompliance& compliance, std::span<const Index> rows) {
  using namespace std::chrono_literals;
  for (int tries = 0; !compliance.ready(rows); ++tries) {
    if (tries == 100000)
      exit_with(make_issue(IssueCode::internal_error, "the blocks that were asked for do not come"));
    std::this_thread::sleep_for(100us);
  }
  std::vector<double> block(9 * rows.size() * rows.size());
  compliance.gather(rows, block);
  return block;
}

struct Measured {
  std::vector<double> share, milliseconds;
  ResultHash hash;
};

/// Every patch from a freshly opened file; the result must be that of the compliance in memory.
void stream_patch(std::span<const std::byte> file, const RestCompliance& whole,
                  std::span<const Index> rows, Measured& measured) {
  auto asset = std::make_shared<SharedAssetReader>(value_or_exit(AssetReader::open_memory(file)));
  const auto name = asset->reader.compliance_names().front();
  const GroupCost cost = value_or_exit(asset->reader.read_compliance_cost(name));
  const std::uint64_t before = asset->reader.bytes_read();
  std::vector<double> block;
  measured.milliseconds.push_back(
      1e3 * seconds_of([&] {
        ComplianceVariant variant = value_or_exit(asset->reader.read_compliance_index(name));
        auto source = value_or_exit(StreamingBlockSource::create(asset, name, variant.hierarchy));
        const auto streamed =
            value_or_exit(open_rest_compliance(variant.header, variant.hierarchy, std::move(source)));
        block = evaluate(*streamed, rows);
      }));
  const auto read = static_cast<double>(asset->reader.bytes_read() - before);
  measured.share.push_back(read / static_cast<double>(cost.stored_bytes));
  measured.hash.add(block);
  if (block != evaluate(whole, rows))
    exit_with(make_issue(IssueCode::internal_error, "streamed and loaded compliance differ"));
}

void measure() {
  Recipe recipe = liver_recipe(40000, 1);
  Asset asset = bake_or_exit(recipe).asset;
  const auto bytes = value_or_exit(write_asset_memory(asset));
  const ComplianceVariant& variant = asset.compliances.front();
  std::vector<Point> positions;
  for (const Index node : variant.nodes)
    positions.push_back(asset.levels.back().mesh.nodes[static_cast<std::size_t>(node)]);
  const auto whole = value_or_exit(open_variant(variant));
  Measured measured;
  for (std::size_t k = 0; k < patch_count; ++k)
    stream_patch(bytes, *whole, patch_around(positions, k * positions.size() / patch_count), measured);
  std::fprintf(stderr, "%zu surface nodes, %zu bytes of records, %lld leaves\n", positions.size(),
               variant.payload.size(), static_cast<long long>(variant.header.block_count));
  print_row("compliance_read.patch_share", "1", measured.share, measured.hash);
  print_row("compliance_read.patch_time", "ms", measured.milliseconds, measured.hash);
}

}  // namespace
}  // namespace souple::bench

int main() { souple::bench::measure(); }
