// SPDX-License-Identifier: MIT
#include "formats/storage/metadata_block.hpp"

#include <cstring>

#include "formats/storage/metadata_checksum.hpp"

namespace souple::storage {

std::vector<std::byte> read_metadata_block(ByteDevice& device, std::uint64_t address,
                                           std::uint64_t length) {
  if (length <= checksum_bytes || length > largest_metadata_block || length > device.size()) return {};
  std::vector<std::byte> block(length);
  if (!device.read(address, block)) return {};
  std::uint32_t stored = 0;
  std::memcpy(&stored, block.data() + length - checksum_bytes, checksum_bytes);
  block.resize(length - checksum_bytes);
  if (metadata_checksum(block) != stored) block.clear();
  return block;
}

}  // namespace souple::storage
