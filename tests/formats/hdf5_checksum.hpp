// SPDX-License-Identifier: MIT
// Repairs the checksums of HDF5's metadata blocks, to build damage that a checksum alone does not
// reveal.
#pragma once
#include <cstddef>
#include <span>
#include <vector>

namespace souple::test {

/// A checksummed block: [begin, checksum_at), followed by its 4 bytes of checksum.
struct MetadataBlock {
  std::size_t begin;
  std::size_t checksum_at;
};

/// The superblock and every object header and chunk index of a sound file, found by their signatures.
std::vector<MetadataBlock> find_metadata_blocks(std::span<const std::byte> file);

/// Makes the checksums fit what the blocks now hold; blocks past the end are left out.
void repair_checksums(std::span<std::byte> file, const std::vector<MetadataBlock>& blocks);

}  // namespace souple::test
