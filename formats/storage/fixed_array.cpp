// SPDX-License-Identifier: MIT
// "HDF5 File Format Specification Version 3.0", VII.C: the fixed array index.
#include "formats/storage/fixed_array.hpp"

#include <algorithm>
#include <bit>

#include "formats/storage/byte_cursor.hpp"
#include "formats/storage/metadata_block.hpp"

namespace souple::storage {
namespace {

constexpr std::uint64_t filtered_chunks = 1;  // client of the array

struct ArrayHeader {
  std::uint64_t entry_bytes, page_entries, entry_count, data_address;
};

/// Address, stored size in as many bytes as HDF5 reckons a chunk may need, filter mask.
std::uint64_t entry_size(const ChunkLayout& layout) {
  std::uint64_t chunk_bytes = layout.scalar_bytes;
  for (std::size_t i = 0; i < layout.rank; ++i) chunk_bytes *= layout.chunk[i];
  const auto log2 = static_cast<std::uint64_t>(std::bit_width(chunk_bytes) - 1);
  return 8 + std::min<std::uint64_t>(1 + (log2 + 8) / 8, 8) + 4;
}

/// 0 if there are more than `limit`.
std::uint64_t count_chunks(const ChunkLayout& layout, const Dataspace& space, std::uint64_t limit) {
  std::uint64_t count = 1;
  for (std::size_t i = 0; i < layout.rank; ++i) {
    const std::uint64_t along = (space.extent[i] + layout.chunk[i] - 1) / layout.chunk[i];
    if (along > limit / count) return 0;
    count *= along;
  }
  return count;
}

/// The data block in front of its pages, or with its entries if there are few.
std::uint64_t front_size(const ArrayHeader& header) {
  constexpr std::uint64_t prefix_bytes =
      4 + 2 + 8;  // signature, version, client, address of the header
  const std::uint64_t page_count = (header.entry_count + header.page_entries - 1) / header.page_entries;
  const bool paged = header.entry_count > header.page_entries;
  return prefix_bytes + (paged ? (page_count + 7) / 8 : header.entry_count * header.entry_bytes) +
         checksum_bytes;
}

bool are_sound_pages(ByteDevice& device, const ArrayHeader& header) {
  std::uint64_t address = header.data_address + front_size(header);
  for (std::uint64_t done = 0; done < header.entry_count; done += header.page_entries) {
    const std::uint64_t entries = std::min(header.page_entries, header.entry_count - done);
    const std::uint64_t bytes = entries * header.entry_bytes + checksum_bytes;
    if (read_metadata_block(device, address, bytes).empty()) return false;
    address += bytes;
  }
  return true;
}

}  // namespace

bool is_sound_fixed_array(ByteDevice& device, const ChunkLayout& layout, const Dataspace& space) {
  constexpr std::uint64_t header_bytes = 28;
  const auto block = read_metadata_block(device, layout.address, header_bytes);
  ByteCursor cursor(block);
  if (!cursor.signature("FAHD") || !cursor.is(1, 0) || !cursor.is(1, filtered_chunks)) return false;
  ArrayHeader header{};
  header.entry_bytes = cursor.number(1);
  const std::uint64_t page_bits = cursor.number(1);
  header.entry_count = cursor.number(8);
  header.data_address = cursor.number(8);
  if (page_bits != layout.page_bits || page_bits < 1 || page_bits > 20) return false;
  header.page_entries = std::uint64_t{1} << page_bits;
  if (header.entry_bytes != entry_size(layout) || header.entry_count == 0 ||
      header.entry_count != count_chunks(layout, space, device.size()))
    return false;
  const auto front = read_metadata_block(device, header.data_address, front_size(header));
  ByteCursor data(front);
  if (!data.signature("FADB") || !data.is(1, 0) || !data.is(1, filtered_chunks) ||
      !data.is(8, layout.address))
    return false;
  return header.entry_count <= header.page_entries || are_sound_pages(device, header);
}

}  // namespace souple::storage
