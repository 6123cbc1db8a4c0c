// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <array>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <iterator>
#include <thread>

#include "formats/read/asset_reader.hpp"
#include "formats/read/validate.hpp"
#include "formats/write/asset_writer.hpp"
#include "sample_asset.hpp"

namespace souple::test {
namespace {

/// Bytes this process has fetched by read(2) and its kin.
std::uint64_t process_bytes_read() {
  std::ifstream stream("/proc/self/io");
  std::string word;
  std::uint64_t count = 0;
  while (stream >> word >> count)
    if (word == "rchar:") return count;
  return 0;
}

/// `process_bytes_read` counts its own reading of /proc too; this much at most.
constexpr std::uint64_t own_reading = 1024;

/// What a group takes in the file; 0 if it is not listed.
std::uint64_t stored_bytes(AssetReader& reader, const std::string& path) {
  const Result<std::vector<GroupCost>> costs = reader.group_costs();
  if (costs)
    for (const GroupCost& cost : *costs)
      if (cost.path == path) return cost.stored_bytes;
  return 0;
}

class LazyReading : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    scratch_ = new ScratchFolder;
    asset_ = new Asset(
        make_sample_asset({.cells = 6, .static_variant = false, .tile_nodes = 64, .visual_cells = 20}));
    ASSERT_TRUE(write_asset(*asset_, scratch_->path("big.souple")).ok());
  }
  static void TearDownTestSuite() {
    delete asset_;
    delete scratch_;
  }
  /// Of the finest level, if it were the only one.
  static std::uint64_t stored_without_ties() {
    Asset asset = *asset_;
    asset.multigrid.clear();
    asset.levels = {{asset.levels[1].mesh, asset.levels[1].boundary, {}, {}, {}}};
    const Result<std::vector<std::byte>> bytes = write_asset_memory(asset);
    if (!bytes) return 0;
    Result<AssetReader> reader = AssetReader::open_memory(*bytes);
    return reader ? stored_bytes(*reader, "mesh/levels/0") : 0;
  }
  static inline ScratchFolder* scratch_ = nullptr;
  static inline Asset* asset_ = nullptr;
};

TEST_F(LazyReading, TheMeshCostsASmallShareOfTheFile) {
  const std::string file = scratch_->path("big.souple");
  const std::uint64_t size = std::filesystem::file_size(file);
  ASSERT_GT(size, 2u << 20);
  const std::uint64_t before = process_bytes_read();
  Result<AssetReader> reader = AssetReader::open(file);
  ASSERT_TRUE(reader.ok()) << format_issue(reader.issue());
  const std::uint64_t after_open = reader->bytes_read();
  const Result<MeshLevel> coarse = reader->read_level(0);
  const Result<MeshLevel> finest = reader->read_level(1);
  const Result<Material> material = reader->read_material();
  const Result<ComplianceHeader> header = reader->read_compliance_header("default");
  const std::uint64_t counted = reader->bytes_read();
  const std::uint64_t by_kernel = process_bytes_read() - before;
  ASSERT_TRUE(coarse.ok() && finest.ok() && material.ok() && header.ok());
  EXPECT_EQ(finest->embedding.size(), asset_->levels[1].embedding.size());
  EXPECT_EQ(finest->mesh.tets, asset_->levels[1].mesh.tets);
  std::cout << "file " << size << " bytes; opened with " << after_open
            << ", meshes, material and a header with " << counted << " (kernel: " << by_kernel << ")\n";
  EXPECT_LT(after_open, 16u << 10);
  EXPECT_LT(counted, size / 20);
  EXPECT_GE(by_kernel, counted);
  EXPECT_LE(by_kernel, counted + own_reading);
}

TEST_F(LazyReading, TheMeshToSimulateReadsNeitherItsTiesNorOtherLevelsNorTheVisualSurface) {
  Result<AssetReader> reader = AssetReader::open(scratch_->path("big.souple"));
  ASSERT_TRUE(reader.ok());
  Result<AssetReader> another = AssetReader::open(scratch_->path("big.souple"));
  ASSERT_TRUE(another.ok());
  constexpr std::uint64_t headers = 8192;  // of the groups and datasets on the way, at most
  const std::uint64_t stored = stored_bytes(*another, "mesh/levels/1");
  const std::uint64_t before = reader->bytes_read();
  ASSERT_TRUE(reader->read_level_mesh(1).ok());
  const std::uint64_t mesh = reader->bytes_read() - before;
  ASSERT_TRUE(reader->read_level(1).ok());
  const std::uint64_t level = reader->bytes_read() - before - mesh;
  ASSERT_TRUE(reader->read_visual().ok());
  const std::uint64_t visual = reader->bytes_read() - before - mesh - level;
  ASSERT_TRUE(reader->read_transition(1).ok());
  const std::uint64_t transition = reader->bytes_read() - before - mesh - level - visual;
  EXPECT_GE(transition, stored_bytes(*another, "multigrid/1"));
  // The sizes of both levels come from headers of theirs.
  EXPECT_LT(transition, stored_bytes(*another, "multigrid/1") + 2 * headers);
  std::cout << "mesh of a level " << mesh << " bytes, with its ties " << level << ", visual surface "
            << visual << "\n";
  EXPECT_LT(mesh, stored_without_ties() + headers);
  EXPECT_GE(level, stored);
  EXPECT_LT(level, stored + headers);
  EXPECT_GE(visual, stored_bytes(*another, "mesh/visual"));
  EXPECT_LT(visual, stored_bytes(*another, "mesh/visual") + headers);
}

TEST_F(LazyReading, OneVariantDoesNotReadTheOther) {
  const std::string file = scratch_->path("big.souple");
  Result<AssetReader> reader = AssetReader::open(file);
  ASSERT_TRUE(reader.ok());
  const std::uint64_t stored = stored_bytes(*reader, "compliance/clamped");
  ASSERT_GT(stored, 0u);
  const std::uint64_t before = reader->bytes_read();
  ASSERT_TRUE(reader->read_compliance("clamped").ok());
  const std::uint64_t cost = reader->bytes_read() - before;
  EXPECT_GE(cost, stored);
  EXPECT_LT(cost, stored + (64 << 10));
}

// Leaves are read by chunks: what a leaf costs is its record and what shares a chunk with it.
TEST_F(LazyReading, RecordsCostTheirChunksAndTheIndexCostsNoPayload) {
  Result<AssetReader> reader = AssetReader::open(scratch_->path("big.souple"));
  ASSERT_TRUE(reader.ok());
  const Result<GroupCost> cost = reader->read_compliance_cost("compressed");
  ASSERT_TRUE(cost.ok());
  ASSERT_GT(cost->payload_raw_bytes, 8 * cost->payload_chunk_bytes);
  constexpr std::uint64_t headers = 16384;
  const auto cost_of = [&](const auto& read) {
    const std::uint64_t before = reader->bytes_read();
    EXPECT_TRUE(read());
    return reader->bytes_read() - before;
  };
  EXPECT_LT(cost_of([&] { return reader->read_compliance_cost("compressed").ok(); }), headers);
  const std::uint64_t index = cost_of([&] { return reader->read_compliance_index("compressed").ok(); });
  const std::uint64_t stored = cost->stored_bytes - cost->payload_stored_bytes;
  EXPECT_GE(index, stored);
  EXPECT_LT(index, stored + headers);
  std::vector<std::byte> part(1000);
  const auto read_at = [&](std::uint64_t begin) {
    return cost_of([&] { return reader->read_payload("compressed", begin, part).ok(); });
  };
  const std::uint64_t chunk = cost->payload_chunk_bytes;
  EXPECT_LT(read_at(chunk), chunk + headers);  // opens the payload
  EXPECT_LT(read_at(chunk), chunk + 64);
  EXPECT_GT(read_at(2 * chunk - 500), chunk);
  EXPECT_LT(read_at(2 * chunk - 500), 2 * chunk);
}

TEST_F(LazyReading, CountsTheSameFromMemory) {
  const std::string file = scratch_->path("big.souple");
  const std::vector<std::byte> bytes = read_bytes(file);
  Result<AssetReader> from_file = AssetReader::open(file);
  Result<AssetReader> from_memory = AssetReader::open_memory(bytes);
  ASSERT_TRUE(from_file.ok() && from_memory.ok());
  ASSERT_TRUE(from_file->read_level(1).ok() && from_memory->read_level(1).ok());
  EXPECT_EQ(from_file->bytes_read(), from_memory->bytes_read());
}

TEST(Descriptors, AreAllClosedAgain) {
  const auto open_count = [] {
    const std::filesystem::directory_iterator entries("/proc/self/fd");
    return std::distance(begin(entries), end(entries));
  };
  const ScratchFolder scratch;
  const std::string file = scratch.path("a.souple");
  const Asset asset = make_sample_asset();
  ASSERT_TRUE(write_asset(asset, file).ok());
  std::vector<std::byte> damaged = read_bytes(file);
  damaged[damaged.size() / 2] ^= std::byte{4};
  write_bytes(scratch.path("damaged.souple"), damaged);
  const auto before = open_count();
  for (int i = 0; i < 50; ++i) {
    Result<AssetReader> reader = AssetReader::open(file);
    ASSERT_TRUE(reader.ok());
    ASSERT_TRUE(read_asset(*reader).ok());
    AssetReader moved = std::move(reader).value();
    EXPECT_EQ(moved.level_count(), 2u);
    EXPECT_FALSE(moved.read_compliance("none").ok());
    EXPECT_FALSE(validate_asset_file(scratch.path("damaged.souple")).valid());
    EXPECT_FALSE(AssetReader::open(scratch.folder()).ok());
    EXPECT_FALSE(write_asset(asset, scratch.folder()).ok());
  }
  EXPECT_EQ(open_count(), before);
}

TEST(OpenReader, KeepsReadingAFileThatWasReplaced) {
  const ScratchFolder scratch;
  const std::string file = scratch.path("a.souple");
  const Asset first = make_sample_asset(), second = make_sample_asset({.cells = 2});
  ASSERT_TRUE(write_asset(first, file).ok());
  Result<AssetReader> reader = AssetReader::open(file);
  ASSERT_TRUE(reader.ok());
  ASSERT_TRUE(write_asset(second, file).ok());
  const Result<Asset> read = read_asset(*reader);
  ASSERT_TRUE(read.ok());
  EXPECT_TRUE(same_content(first, *read));
}

TEST(OpenReader, ReadsBesideReadersAndWritersOfOtherThreads) {
  const Asset asset = make_sample_asset();
  const Result<std::vector<std::byte>> bytes = write_asset_memory(asset);
  ASSERT_TRUE(bytes.ok());
  std::array<int, 4> good{};
  std::vector<std::thread> threads;
  for (int& count : good)
    threads.emplace_back([&] {
      for (int i = 0; i < 10; ++i) {
        Result<AssetReader> reader = AssetReader::open_memory(*bytes);
        const Result<Asset> read = reader ? read_asset(*reader) : Result<Asset>(reader.issue());
        const Result<std::vector<std::byte>> again = write_asset_memory(asset);
        count += read && same_content(asset, *read) && again && *again == *bytes;
      }
    });
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(good, (std::array<int, 4>{10, 10, 10, 10}));
}

TEST(OpenReader, RefusesAFileThatShrinksUnderIt) {
  const ScratchFolder scratch;
  const std::string file = scratch.path("a.souple");
  ASSERT_TRUE(write_asset(make_sample_asset({.cells = 2}), file).ok());
  Result<AssetReader> reader = AssetReader::open(file);
  ASSERT_TRUE(reader.ok());
  std::filesystem::resize_file(file, 4096);
  EXPECT_FALSE(read_asset(*reader).ok());
}

}  // namespace
}  // namespace souple::test
