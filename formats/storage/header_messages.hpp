// SPDX-License-Identifier: MIT
// The messages of an object header, as far as they must be known to say that they are well-formed.
// "HDF5 File Format Specification Version 3.0", IV.A.2.
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

namespace souple::storage {

inline constexpr std::uint64_t undefined_address = ~std::uint64_t{0};

enum class Message : unsigned {
  null = 0,
  dataspace = 1,
  link_info = 2,
  datatype = 3,
  fill_value = 5,
  link = 6,
  layout = 8,
  group_info = 10,
  filters = 11,
  attribute = 12,
  continuation = 16,
  attribute_info = 21,
};

/// Extent of a dataset or attribute: rank 0 (one value) to 3, of fixed size.
struct Dataspace {
  std::size_t rank = 0;
  std::array<std::uint64_t, 3> extent{1, 1, 1};
};

/// Chunked layout of version 4, as one chunk or indexed by a fixed array.
struct ChunkLayout {
  std::size_t rank = 0;  ///< of the data
  std::array<std::uint64_t, 3> chunk{1, 1, 1};
  std::uint64_t scalar_bytes = 0;
  bool has_array = false;  ///< else one chunk
  std::uint64_t page_bits = 0;
  std::uint64_t address = 0;  ///< of the array's header, or of the chunk
};

std::optional<Dataspace> parse_dataspace(std::span<const std::byte> body);
/// Bytes of a scalar: uint8, int32, int64, float32, float64 or fixed-length text; nothing else is
/// well-formed.
std::optional<std::uint64_t> parse_datatype(std::span<const std::byte> body);
std::optional<ChunkLayout> parse_layout(std::span<const std::byte> body);

/// Messages that carry nothing the reader of the header needs.
bool is_sound_message(Message type, std::span<const std::byte> body);

}  // namespace souple::storage
