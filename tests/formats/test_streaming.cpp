// SPDX-License-Identifier: MIT
// Records that are fetched while others read those that are there.
#include <gtest/gtest.h>

#include <filesystem>
#include <iostream>
#include <thread>

#include "formats/write/asset_writer.hpp"
#include "runtime/load/streaming_block_source.hpp"
#include "sample_asset.hpp"
#include "sample_hierarchy.hpp"

namespace souple::test {
namespace {

constexpr int depth = 5;
constexpr std::size_t leaf_count = 32;

class Streaming : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    scratch_ = new ScratchFolder;
    Asset asset = make_sample_asset({.cells = 8, .fixed_bottom = false, .hierarchical = false});
    variant_ = new ComplianceVariant(make_hierarchical_variant(asset, depth, 60));
    asset.compliances = {*variant_};
    ASSERT_TRUE(write_asset(asset, file()).ok());
  }
  static void TearDownTestSuite() {
    delete variant_;
    delete scratch_;
  }
  static std::string file() { return scratch_->path("streamed.souple"); }

  void SetUp() override {
    Result<AssetReader> reader = AssetReader::open(file());
    ASSERT_TRUE(reader.ok());
    const Result<ComplianceVariant> index = reader->read_compliance_index("compressed");
    ASSERT_TRUE(index.ok()) << format_issue(index.issue());
    index_ = index->hierarchy;
    asset_ = std::make_shared<SharedAssetReader>(std::move(*reader));
  }

  std::unique_ptr<StreamingBlockSource> stream(StreamingBlockSource::Failed failed = {}) {
    auto source = StreamingBlockSource::create(asset_, "compressed", index_, std::move(failed));
    EXPECT_TRUE(source.ok()) << (source ? "" : format_issue(source.issue()));
    return source ? std::move(*source) : nullptr;
  }
  static bool is_record(const StreamingBlockSource& source, std::size_t leaf) {
    const auto begin = static_cast<std::size_t>(variant_->hierarchy.record_begin[leaf]);
    const auto end = static_cast<std::size_t>(variant_->hierarchy.record_begin[leaf + 1]);
    return std::ranges::equal(source.block(leaf),
                              std::span(variant_->payload).subspan(begin, end - begin));
  }

  static inline ScratchFolder* scratch_ = nullptr;
  static inline ComplianceVariant* variant_ = nullptr;
  HierarchicalIndex index_;
  std::shared_ptr<SharedAssetReader> asset_;
};

TEST_F(Streaming, FetchesNothingBeforeItIsAskedFor) {
  const std::uint64_t before = asset_->reader.bytes_read();
  const auto source = stream();
  ASSERT_NE(source, nullptr);
  EXPECT_TRUE(source->wait_for_requested());
  for (std::size_t leaf = 0; leaf < leaf_count; ++leaf) EXPECT_FALSE(source->ready(leaf));
  EXPECT_LT(asset_->reader.bytes_read() - before, 16u << 10);
  EXPECT_LT(source->resident_bytes(), 4096u);
}

TEST_F(Streaming, GivesTheRecordsThatWereAskedForAndReadsTheirChunksAlone) {
  const auto source = stream();
  ASSERT_NE(source, nullptr);
  const std::uint64_t before = asset_->reader.bytes_read();
  const std::vector<Index> leaves{7, 8, 21};
  source->request(leaves);
  ASSERT_TRUE(source->wait_for_requested());
  for (std::size_t leaf = 0; leaf < leaf_count; ++leaf)
    EXPECT_EQ(source->ready(leaf), leaf == 7 || leaf == 8 || leaf == 21) << leaf;
  for (const std::size_t leaf : {7u, 8u, 21u}) EXPECT_TRUE(is_record(*source, leaf)) << leaf;
  const std::uint64_t read = asset_->reader.bytes_read() - before;
  std::cout << "3 of 32 records: " << read << " bytes read of " << variant_->payload.size()
            << " decoded ones\n";
  EXPECT_LT(read, variant_->payload.size() * 7 / 32);
  EXPECT_GE(source->resident_bytes(), 3 * variant_->payload.size() / 40);
}

TEST_F(Streaming, ReadsEveryChunkOnce) {
  const auto source = stream();
  ASSERT_NE(source, nullptr);
  for (std::size_t leaf = 0; leaf < leaf_count; ++leaf) source->request((leaf * 11) % leaf_count);
  ASSERT_TRUE(source->wait_for_requested());
  const std::uint64_t read = asset_->reader.bytes_read();
  for (std::size_t leaf = 0; leaf < leaf_count; ++leaf) {
    source->request(leaf);
    EXPECT_TRUE(source->ready(leaf) && is_record(*source, leaf)) << leaf;
  }
  EXPECT_TRUE(source->wait_for_requested());
  EXPECT_EQ(asset_->reader.bytes_read(), read);
  const Result<GroupCost> cost = asset_->reader.read_compliance_cost("compressed");
  ASSERT_TRUE(cost.ok());
  EXPECT_LT(read, cost->stored_bytes + (64u << 10));
}

TEST_F(Streaming, IgnoresLeavesThatAreNone) {
  const auto source = stream();
  ASSERT_NE(source, nullptr);
  source->request(std::vector<Index>{-1, static_cast<Index>(leaf_count), 1 << 30});
  EXPECT_TRUE(source->wait_for_requested());
  EXPECT_FALSE(source->ready(leaf_count));
}

TEST_F(Streaming, ServesReadersThatDoNotWaitFromSeveralThreads) {
  const auto first = stream(), second = stream();
  ASSERT_TRUE(first && second);
  std::array<int, 4> good{};
  std::vector<std::thread> threads;
  for (std::size_t t = 0; t < good.size(); ++t)
    threads.emplace_back([&, t] {
      StreamingBlockSource& source = t % 2 == 0 ? *first : *second;
      std::vector<char> seen(leaf_count);
      while (good[t] < static_cast<int>(leaf_count))
        for (std::size_t k = 0; k < leaf_count; ++k) {
          const std::size_t leaf = (k + 8 * t) % leaf_count;
          if (seen[leaf]) continue;
          source.request(leaf);
          if (!source.ready(leaf)) continue;
          seen[leaf] = 1;
          if (!is_record(source, leaf)) return;
          ++good[t];
        }
    });
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(good, (std::array<int, 4>{32, 32, 32, 32}));
}

TEST_F(Streaming, EndsWhileRequestsAreOpen) {
  for (int i = 0; i < 20; ++i) {
    const auto source = stream();
    ASSERT_NE(source, nullptr);
    for (std::size_t leaf = 0; leaf < leaf_count; ++leaf) source->request(leaf);
  }
}

TEST_F(Streaming, SaysOnceThatTheFileShrankAndKeepsWhatItHas) {
  const std::string copy = scratch_->path("copy.souple");
  std::filesystem::copy_file(file(), copy);
  Result<AssetReader> reader = AssetReader::open(copy);
  ASSERT_TRUE(reader.ok());
  asset_ = std::make_shared<SharedAssetReader>(std::move(*reader));
  std::atomic<int> failures{0};
  const auto source = stream([&](const Issue& issue) {
    EXPECT_EQ(issue.code, IssueCode::asset_corrupt);
    ++failures;
  });
  ASSERT_NE(source, nullptr);
  source->request(0);
  ASSERT_TRUE(source->wait_for_requested());
  std::filesystem::resize_file(copy, std::filesystem::file_size(copy) / 8);
  source->request(std::vector<Index>{20, 25, 30});
  EXPECT_FALSE(source->wait_for_requested());
  EXPECT_FALSE(source->ready(30));
  EXPECT_TRUE(source->ready(0) && is_record(*source, 0));
  source->request(31);
  EXPECT_FALSE(source->wait_for_requested());
  while (failures == 0) std::this_thread::yield();
  EXPECT_EQ(failures, 1);
}

TEST_F(Streaming, RefusesAnIndexOfAnotherPayload) {
  --index_.record_begin.back();
  const auto source = StreamingBlockSource::create(asset_, "compressed", index_);
  ASSERT_FALSE(source.ok());
  EXPECT_EQ(source.issue().code, IssueCode::asset_corrupt);
  EXPECT_EQ(StreamingBlockSource::create(asset_, "none", index_).issue().code,
            IssueCode::asset_missing_part);
}

TEST(MemoryBlocks, MayDifferInSize) {
  std::vector<std::byte> payload(10);
  for (std::size_t i = 0; i < payload.size(); ++i) payload[i] = static_cast<std::byte>(i);
  const MemoryBlockSource source(payload, {0, 3, 3, 10});
  EXPECT_TRUE(source.ready(0) && source.ready(1) && source.ready(2) && !source.ready(3));
  EXPECT_EQ(source.block(0).size(), 3u);
  EXPECT_EQ(source.block(1).size(), 0u);
  ASSERT_EQ(source.block(2).size(), 7u);
  EXPECT_EQ(source.block(2).front(), std::byte{3});
}

}  // namespace
}  // namespace souple::test
