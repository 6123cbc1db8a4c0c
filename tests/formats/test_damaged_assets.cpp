// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>
#include <hdf5.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <cstring>
#include <iostream>
#include <random>

#include "formats/read/asset_reader.hpp"
#include "formats/read/validate.hpp"
#include "formats/write/asset_writer.hpp"
#include "hdf5_checksum.hpp"
#include "sample_asset.hpp"

namespace souple::test {
namespace {

using Bytes = std::vector<std::byte>;

class DamagedAsset : public ::testing::Test {
 protected:
  void SetUp() override {
    Result<Bytes> written = write_asset_memory(asset_);
    ASSERT_TRUE(written.ok());
    sound_ = std::move(written).value();
    ASSERT_TRUE(validate_asset_memory(sound_).valid());
  }

  /// Refused by the reader, or read to the same content: even without the hash nothing may slip by.
  bool is_refused_or_same(std::span<const std::byte> bytes) const {
    Result<AssetReader> reader = AssetReader::open_memory(bytes);
    if (!reader) return true;
    const Result<Asset> read = read_asset(*reader);
    return !read || same_content(asset_, *read);
  }

  Asset asset_ = make_sample_asset();
  Bytes sound_;
};

TEST_F(DamagedAsset, IsRefusedAtEveryTruncation) {
  ASSERT_LE(sound_.size(), 64u << 10);
  for (std::size_t length = 0; length < sound_.size(); ++length) {
    const ValidationReport report = validate_asset_memory(std::span(sound_).first(length));
    ASSERT_FALSE(report.valid()) << length;
    ASSERT_NE(report.issues.front().code, IssueCode::io_out_of_memory) << length;
  }
}

// A truncation that the length in the superblock does not betray.
TEST_F(DamagedAsset, IsRefusedAtTruncationsWithARepairedSuperblock) {
  for (std::size_t length = 48; length < sound_.size(); length += 5) {
    Bytes cut(sound_.begin(), sound_.begin() + static_cast<std::ptrdiff_t>(length));
    const std::uint64_t end = length;
    std::memcpy(cut.data() + 28, &end, sizeof end);
    repair_checksums(cut, {{0, 44}});
    ASSERT_FALSE(validate_asset_memory(cut).valid()) << length;
  }
}

TEST_F(DamagedAsset, IsRefusedWithExtraBytes) {
  for (const std::size_t extra : {1u, 7u, 8u, 512u, 100000u}) {
    Bytes longer = sound_;
    longer.resize(sound_.size() + extra);
    const ValidationReport report = validate_asset_memory(longer);
    ASSERT_FALSE(report.valid()) << extra;
    EXPECT_EQ(report.issues.front().code, IssueCode::asset_corrupt);
  }
}

TEST_F(DamagedAsset, IsRefusedWithBytesInFront) {
  // HDF5 itself would look for its signature at 512 as well.
  Bytes shifted(512);
  shifted.insert(shifted.end(), sound_.begin(), sound_.end());
  EXPECT_EQ(AssetReader::open_memory(shifted).issue().code, IssueCode::asset_not_an_asset);
}

TEST_F(DamagedAsset, IsRefusedOrTheSameAfter3000BitFlips) {
  std::mt19937 random(20240501);
  int refused = 0;
  for (int i = 0; i < 3000; ++i) {
    Bytes damaged = sound_;
    const std::size_t bit = random() % (8 * damaged.size());
    damaged[bit / 8] ^= std::byte{1} << bit % 8;
    if (!validate_asset_memory(damaged).valid()) ++refused;
    ASSERT_TRUE(is_refused_or_same(damaged)) << "bit " << bit;
  }
  std::cout << refused << " of 3000 flips refused, the others without effect\n";
  EXPECT_GT(refused, 2000);
}

TEST_F(DamagedAsset, IsRefusedOrTheSameAfterBursts) {
  std::mt19937 random(7);
  for (int i = 0; i < 1500; ++i) {
    Bytes damaged = sound_;
    const std::size_t length = 1 + random() % 64;
    const std::size_t begin = random() % (damaged.size() - length);
    for (std::size_t k = 0; k < length; ++k) damaged[begin + k] = static_cast<std::byte>(random());
    ASSERT_TRUE(is_refused_or_same(damaged)) << "bytes " << begin << " + " << length;
  }
}

TEST_F(DamagedAsset, IsRefusedWhenPiecesChangePlaces) {
  std::mt19937 random(8);
  for (int i = 0; i < 500; ++i) {
    Bytes damaged = sound_;
    const std::size_t length = 8 + random() % 2048;
    const std::size_t from = random() % (damaged.size() - length),
                      to = random() % (damaged.size() - length);
    std::memmove(damaged.data() + to, sound_.data() + from, length);
    ASSERT_TRUE(is_refused_or_same(damaged)) << from << " to " << to << ", " << length;
  }
}

// HDF5 complains when the process ends if a damaged file made it lose something.
TEST_F(DamagedAsset, LeavesHdf5InOrder) {
  const ScratchFolder scratch;
  const std::string complaints = scratch.path("stderr");
  const pid_t child = ::fork();
  if (child == 0) {
    if (std::freopen(complaints.c_str(), "w", stderr) == nullptr) ::_exit(1);
    for (std::size_t at = 0; at < sound_.size(); at += 37) {
      Bytes damaged = sound_;
      damaged[at] ^= std::byte{0x10};
      (void)is_refused_or_same(damaged);
    }
    H5close();
    std::fflush(stderr);
    ::_exit(0);
  }
  int status = 1;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  EXPECT_EQ(status, 0);
  const Bytes text = read_bytes(complaints);
  EXPECT_EQ(std::string(reinterpret_cast<const char*>(text.data()), text.size()), "");
}

TEST(DamagedLargeAsset, IsRefusedAtSampledTruncations) {
  const Result<Bytes> sound =
      write_asset_memory(make_sample_asset({.cells = 3, .static_variant = false, .tile_nodes = 32}));
  ASSERT_TRUE(sound.ok());
  ASSERT_GT(sound->size(), 64u << 10);
  std::mt19937 random(9);
  for (int i = 0; i < 2000; ++i) {
    const std::size_t length = random() % sound->size();
    ASSERT_FALSE(validate_asset_memory(std::span(*sound).first(length)).valid()) << length;
  }
  for (std::size_t back = 1; back < 64; ++back)
    ASSERT_FALSE(validate_asset_memory(std::span(*sound).first(sound->size() - back)).valid()) << back;
}

TEST(NoAsset, IsRefused) {
  std::mt19937 random(10);
  EXPECT_EQ(AssetReader::open_memory({}).issue().code, IssueCode::asset_not_an_asset);
  for (const std::size_t size : {1u, 8u, 47u, 48u, 1000u, 70000u}) {
    Bytes noise(size);
    for (std::byte& byte : noise) byte = static_cast<std::byte>(random());
    EXPECT_EQ(AssetReader::open_memory(noise).issue().code, IssueCode::asset_not_an_asset);
  }
}

}  // namespace
}  // namespace souple::test
