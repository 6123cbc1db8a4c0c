// SPDX-License-Identifier: MIT
// Damage whose metadata checksums were made to fit again: it reaches the parsers behind the checksums.
// Deterministic; SOUPLE_FUZZ_ROUNDS asks for more rounds, SOUPLE_FUZZ_SEED for others.
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
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

unsigned from_environment(const char* name, unsigned otherwise) {
  const char* text = std::getenv(name);
  return text != nullptr ? static_cast<unsigned>(std::strtoul(text, nullptr, 10)) : otherwise;
}

class Mutator {
 public:
  Mutator(Bytes sound, unsigned seed)
      : sound_(std::move(sound)), blocks_(find_metadata_blocks(sound_)), random_(seed) {}

  std::size_t block_count() const { return blocks_.size(); }

  Bytes next() {
    Bytes bytes = sound_;
    const unsigned edits = 1 + random_() % 4;
    for (unsigned i = 0; i < edits; ++i) edit(bytes);
    repair_checksums(bytes, blocks_);
    return bytes;
  }

 private:
  void edit(Bytes& bytes) {
    const MetadataBlock& block = blocks_[random_() % blocks_.size()];
    const std::size_t length = block.checksum_at - block.begin;
    std::byte* at = bytes.data() + block.begin + random_() % length;
    const std::size_t room = static_cast<std::size_t>(bytes.data() + block.checksum_at - at);
    static constexpr std::uint64_t values[] = {0,
                                               1,
                                               0x7F,
                                               0xFF,
                                               0x7FFF,
                                               0xFFFF,
                                               0x7FFFFFFF,
                                               0xFFFFFFFF,
                                               std::uint64_t{1} << 40,
                                               ~std::uint64_t{0} >> 1,
                                               ~std::uint64_t{0}};
    const std::uint64_t value = values[random_() % std::size(values)];
    switch (random_() % 4) {
      case 0:
        *at ^= std::byte{1} << random_() % 8;
        break;
      case 1:
        *at = static_cast<std::byte>(random_());
        break;
      case 2:
        std::memcpy(at, &value, std::min<std::size_t>(room, std::size_t{1} << random_() % 4));
        break;
      default: {  // a piece of another block
        const MetadataBlock& other = blocks_[random_() % blocks_.size()];
        const std::size_t count =
            std::min({room, other.checksum_at - other.begin, std::size_t{1 + random_() % 64}});
        std::memcpy(at, sound_.data() + other.begin, count);
      }
    }
  }

  Bytes sound_;
  std::vector<MetadataBlock> blocks_;
  std::mt19937 random_;
};

/// Everything a caller may do with a file of unknown origin.
bool use(const Bytes& bytes) {
  Result<AssetReader> reader = AssetReader::open_memory(bytes);
  if (!reader) return false;
  const bool listed = reader->group_costs().ok();
  for (const std::string& name : reader->compliance_names())
    if (!reader->read_compliance_header(name)) continue;
  for (std::size_t l = 0; l < reader->level_count(); ++l)
    if (!reader->read_level_sizes(l) || !reader->read_level_mesh(l)) break;
  for (std::size_t l = 1; l < reader->level_count(); ++l)
    if (!reader->read_transition(l)) break;
  (void)reader->read_visual_sizes();
  return validate_asset_memory(bytes).valid() && listed;
}

/// A crash in HDF5 must not hide which round it was: rounds run in children of 500.
TEST(AssetMutations, NeverCrashHangOrExhaustMemory) {
  const unsigned rounds = from_environment("SOUPLE_FUZZ_ROUNDS", 6000);
  const unsigned seed = from_environment("SOUPLE_FUZZ_SEED", 1);
  const Result<Bytes> nested = write_asset_memory(make_sample_asset({.cells = 2, .tile_nodes = 20}));
  const Result<Bytes> embedded = write_asset_memory(make_sample_asset(
      {.levels = 3, .fixed_bottom = false, .tile_nodes = 20, .ties = Ties::embedding}));
  ASSERT_TRUE(nested.ok() && embedded.ok());
  ASSERT_GT(Mutator(*nested, 0).block_count(), 20u);
  ASSERT_GT(Mutator(*embedded, 0).block_count(), 20u);
  constexpr unsigned batch = 500;
  for (unsigned first = 0; first < rounds; first += batch) {
    const Bytes& sound = first / batch % 3 == 2 ? *embedded : *nested;
    const pid_t child = ::fork();
    if (child == 0) {
      ::alarm(120);
      Mutator mutator(sound, seed * 100000 + first);
      for (unsigned i = 0; i < batch; ++i) use(mutator.next());
      ::_exit(0);
    }
    int status = -1;
    rusage usage{};
    ASSERT_EQ(::wait4(child, &status, 0, &usage), child);
    EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0)
        << "rounds from " << first << " of seed " << seed << ": signal " << WTERMSIG(status);
    EXPECT_LT(usage.ru_maxrss, 512 << 10) << "KiB, rounds from " << first;
  }
}

}  // namespace
}  // namespace souple::test
