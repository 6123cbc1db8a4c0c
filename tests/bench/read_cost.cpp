// SPDX-License-Identifier: MIT
// What it costs to look at the mesh of an asset that also holds compliances: bytes fetched and time,
// beside reading all of it. Rows read.*
#include <cstdio>
#include <cstdlib>

#include "formats/read/asset_reader.hpp"
#include "formats/write/asset_writer.hpp"
#include "sample_asset.hpp"
#include "tests/bench/row.hpp"

namespace souple::bench {
namespace {

[[noreturn]] void stop(const Issue& issue) {
  std::fprintf(stderr, "%s\n", format_issue(issue).c_str());
  std::exit(exit_code(issue.code));
}

template <class T>
T take(Result<T> result) {
  if (!result) stop(result.issue());
  return std::move(result).value();
}

struct MeshLook {
  std::uint64_t bytes_read = 0;
  MeshLevel level;
};

MeshLook look_at_mesh(const std::string& file) {
  AssetReader reader = take(AssetReader::open(file));
  MeshLook look;
  look.level = take(reader.read_level(reader.level_count() - 1));
  look.bytes_read = reader.bytes_read();
  return look;
}

void measure_read_cost(const std::string& file, std::size_t file_bytes) {
  MeshLook look;
  const auto mesh_seconds = repeated_seconds(9, [&] { look = look_at_mesh(file); });
  Asset whole;
  const auto whole_seconds = repeated_seconds(9, [&] {
    AssetReader reader = take(AssetReader::open(file));
    whole = take(read_asset(reader));
  });

  ResultHash mesh_hash;
  mesh_hash.add(look.level.mesh.nodes);
  mesh_hash.add(look.level.mesh.tets);
  ResultHash whole_hash = mesh_hash;
  for (const ComplianceVariant& variant : whole.compliances) whole_hash.add(variant.payload);

  const auto share = static_cast<double>(look.bytes_read) / static_cast<double>(file_bytes);
  print_row("read.mesh_share", "1", share, mesh_hash);
  print_row("read.mesh_time", "ms", mesh_seconds, mesh_hash, 1e3);
  print_row("read.whole_time", "ms", whole_seconds, whole_hash, 1e3);
}

}  // namespace
}  // namespace souple::bench

int main() {
  souple::test::SampleOptions options;
  options.cells = 4;
  options.tile_nodes = 32;
  const souple::Asset asset = souple::test::make_sample_asset(options);
  const souple::test::ScratchFolder folder;
  const std::string file = folder.path("sample.souple");
  const souple::Status written = souple::write_asset(asset, file);
  if (!written) souple::bench::stop(written.issue());
  souple::bench::measure_read_cost(file, souple::test::read_bytes(file).size());
}
