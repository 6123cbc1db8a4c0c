// SPDX-License-Identifier: MIT
#include "hdf5_checksum.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <string_view>

#include "formats/storage/metadata_checksum.hpp"

namespace souple::test {
namespace {

std::array<std::byte, 4> checksum_of(std::span<const std::byte> bytes) {
  return std::bit_cast<std::array<std::byte, 4>>(storage::metadata_checksum(bytes));
}

constexpr std::size_t longest_block = 8192;

/// Length of the block whose checksum fits, 0 if there is none.
std::size_t block_length(std::span<const std::byte> bytes) {
  for (std::size_t length = 8; length + 4 <= bytes.size() && length <= longest_block; ++length)
    if (std::memcmp(checksum_of(bytes.first(length)).data(), bytes.data() + length, 4) == 0)
      return length;
  return 0;
}

}  // namespace

std::vector<MetadataBlock> find_metadata_blocks(std::span<const std::byte> file) {
  static constexpr std::string_view signatures[] = {"OHDR", "OCHK", "FAHD", "FADB"};
  std::vector<MetadataBlock> blocks{{0, 44}};
  const std::string_view text(reinterpret_cast<const char*>(file.data()), file.size());
  for (const std::string_view signature : signatures)
    for (std::size_t at = text.find(signature); at != text.npos; at = text.find(signature, at + 1))
      if (const std::size_t length = block_length(file.subspan(at)); length > 0)
        blocks.push_back({at, at + length});
  return blocks;
}

void repair_checksums(std::span<std::byte> file, const std::vector<MetadataBlock>& blocks) {
  for (const MetadataBlock& block : blocks) {
    if (block.checksum_at + 4 > file.size()) continue;
    const auto sum = checksum_of(file.subspan(block.begin, block.checksum_at - block.begin));
    std::ranges::copy(sum, file.data() + block.checksum_at);
  }
}

}  // namespace souple::test
