// SPDX-License-Identifier: MIT
#include "formats/storage/header_messages.hpp"

#include <algorithm>
#include <cstring>
#include <limits>

#include "formats/storage/byte_cursor.hpp"
#include "formats/storage/layout.hpp"

namespace souple::storage {
namespace {

using Bytes = std::span<const std::byte>;

constexpr std::uint64_t largest_extent = std::uint64_t{1} << 60;

/// Any of these flag bits may be set, no other.
bool only(std::uint64_t flags, std::uint64_t allowed) { return (flags & ~allowed) == 0; }

/// Links that all lie in the header itself: no heap, no trees.
bool is_sound_link_info(ByteCursor cursor) {
  if (!cursor.is(1, 0)) return false;
  const std::uint64_t flags = cursor.number(1);
  if ((flags & 1) != 0) cursor.take(8);
  bool sound = only(flags, 3) && cursor.is(8, undefined_address) && cursor.is(8, undefined_address);
  if ((flags & 2) != 0) sound = sound && cursor.is(8, undefined_address);
  return sound && cursor.at_end();
}

/// The same for attributes.
bool is_sound_attribute_info(ByteCursor cursor) {
  if (!cursor.is(1, 0)) return false;
  const std::uint64_t flags = cursor.number(1);
  if ((flags & 1) != 0) cursor.take(2);
  bool sound = only(flags, 3) && cursor.is(8, undefined_address) && cursor.is(8, undefined_address);
  if ((flags & 2) != 0) sound = sound && cursor.is(8, undefined_address);
  return sound && cursor.at_end();
}

bool is_sound_group_info(ByteCursor cursor) {
  if (!cursor.is(1, 0)) return false;
  const std::uint64_t flags = cursor.number(1);
  cursor.take(((flags & 1) != 0 ? 4 : 0) + ((flags & 2) != 0 ? 4 : 0));
  return only(flags, 3) && cursor.at_end();
}

/// Hard links only.
bool is_sound_link(ByteCursor cursor) {
  if (!cursor.is(1, 1)) return false;
  const std::uint64_t flags = cursor.number(1);
  constexpr std::uint64_t has_type = 8, has_order = 4, has_character_set = 16;
  if (!only(flags, 0x1F)) return false;
  if ((flags & has_type) != 0 && !cursor.is(1, 0)) return false;
  if ((flags & has_order) != 0) cursor.take(8);
  if ((flags & has_character_set) != 0 && cursor.number(1) > 1) return false;
  const auto name = cursor.take(cursor.number(std::size_t{1} << (flags & 3)));
  cursor.take(8);  // the address is looked at when the link is followed
  return !name.empty() && std::ranges::find(name, std::byte{0}) == name.end() && cursor.at_end();
}

bool is_sound_attribute(ByteCursor cursor) {
  if (!cursor.is(1, 3) || !cursor.is(1, 0)) return false;
  const std::uint64_t name_bytes = cursor.number(2), type_bytes = cursor.number(2);
  const std::uint64_t space_bytes = cursor.number(2);
  if (cursor.number(1) > 1) return false;  // character set
  const auto name = cursor.take(name_bytes);
  if (name.size() < 2 || std::ranges::find(name, std::byte{0}) != name.end() - 1) return false;
  const std::optional<std::uint64_t> scalar_bytes = parse_datatype(cursor.take(type_bytes));
  const std::optional<Dataspace> space = parse_dataspace(cursor.take(space_bytes));
  if (!cursor.ok() || !scalar_bytes || !space) return false;
  std::uint64_t bytes = *scalar_bytes;
  for (const std::uint64_t extent : space->extent) {
    if (extent > std::numeric_limits<std::uint16_t>::max() || bytes > cursor.left()) return false;
    bytes *= extent;
  }
  return bytes == cursor.left();
}

/// No fill value of its own.
bool is_sound_fill_value(ByteCursor cursor) {
  return cursor.is(1, 3) && only(cursor.number(1), 0x1F) && cursor.at_end();
}

bool is_sound_filter_list(ByteCursor cursor) {
  constexpr std::uint64_t first_named = 256;
  if (!cursor.is(1, 2)) return false;
  const std::uint64_t count = cursor.number(1);
  if (count == 0 || count > 4) return false;
  for (std::uint64_t i = 0; i < count; ++i) {
    const std::uint64_t name_bytes = cursor.number(2) >= first_named ? cursor.number(2) : 0;
    const std::uint64_t flags = cursor.number(2), value_count = cursor.number(2);
    const auto name = cursor.take(name_bytes);
    cursor.take(4 * value_count);
    if (!only(flags, 1) || value_count > 8) return false;
    if (name_bytes > 0 && (name.empty() || name.back() != std::byte{0})) return false;
  }
  return cursor.at_end();
}

}  // namespace

std::optional<Dataspace> parse_dataspace(Bytes body) {
  ByteCursor cursor(body);
  Dataspace space;
  if (!cursor.is(1, 2)) return {};
  const std::uint64_t rank = cursor.number(1), flags = cursor.number(1), kind = cursor.number(1);
  if (rank > space.extent.size() || !only(flags, 1) || kind != (rank == 0 ? 0u : 1u)) return {};
  space.rank = rank;
  for (std::size_t i = 0; i < rank; ++i) {
    space.extent[i] = cursor.number(8);
    if (space.extent[i] == 0 || space.extent[i] > largest_extent) return {};
  }
  for (std::size_t i = 0; i < rank && (flags & 1) != 0; ++i)
    if (!cursor.is(8, space.extent[i])) return {};
  return cursor.at_end() ? std::optional(space) : std::nullopt;
}

std::optional<std::uint64_t> parse_datatype(Bytes body) {
  // Class and version, three bytes of bits, size, properties.
  using Encoding = std::array<unsigned char, 20>;
  constexpr Encoding uint8{0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 8, 0};
  constexpr Encoding int32{0, 0x08, 0, 0, 4, 0, 0, 0, 0, 0, 32, 0};
  constexpr Encoding int64{0, 0x08, 0, 0, 8, 0, 0, 0, 0, 0, 64, 0};
  constexpr Encoding float32{1, 0x20, 31, 0, 4, 0, 0, 0, 0, 0, 32, 0, 23, 8, 0, 23, 127, 0, 0, 0};
  constexpr Encoding float64{1, 0x20, 63, 0, 8, 0, 0, 0, 0, 0, 64, 0, 52, 11, 0, 52, 0xFF, 3, 0, 0};
  ByteCursor cursor(body);
  const std::uint64_t front = cursor.number(1), kind = front & 15, version = front >> 4;
  if (version < 1 || version > 3) return {};
  const auto matches = [&](const Encoding& expected, std::size_t length) {
    return body.size() == length && std::memcmp(body.data() + 1, expected.data() + 1, length - 1) == 0;
  };
  if (kind == 0 && matches(uint8, 12)) return 1;
  if (kind == 0 && matches(int32, 12)) return 4;
  if (kind == 0 && matches(int64, 12)) return 8;
  if (kind == 1 && matches(float32, 20)) return 4;
  if (kind == 1 && matches(float64, 20)) return 8;
  if (kind != 3) return {};
  const std::uint64_t bits = cursor.number(3), bytes = cursor.number(4);
  const bool known = (bits & 15) <= 2 && (bits >> 4) <= 1 && bytes > 0 && bytes <= 0xFFFF;
  return known && cursor.at_end() ? std::optional(bytes) : std::nullopt;
}

std::optional<ChunkLayout> parse_layout(Bytes body) {
  constexpr std::uint64_t version = 4, chunked = 2, single_chunk = 1, fixed_array = 3, filtered = 2;
  ByteCursor cursor(body);
  ChunkLayout layout;
  if (!cursor.is(1, version) || !cursor.is(1, chunked)) return {};
  const std::uint64_t flags = cursor.number(1), axes = cursor.number(1), width = cursor.number(1);
  if (axes < 2 || axes > layout.chunk.size() + 1 || width < 1 || width > 8) return {};
  layout.rank = axes - 1;
  std::uint64_t bytes = 1;
  for (std::size_t i = 0; i < axes; ++i) {
    const std::uint64_t extent = cursor.number(width);
    if (extent == 0 || extent > layout::largest_chunk_bytes) return {};
    bytes *= extent;  // at most 2^20 each, four of them only if the product stays small
    if (bytes > layout::largest_chunk_bytes) return {};
    (i < layout.rank ? layout.chunk[i] : layout.scalar_bytes) = extent;
  }
  const std::uint64_t index = cursor.number(1);
  layout.has_array = index == fixed_array;
  if (layout.has_array && flags == 0) {
    layout.page_bits = cursor.number(1);
  } else if (index == single_chunk && flags == filtered) {
    cursor.take(12);  // stored size, filter mask
  } else {
    return {};
  }
  layout.address = cursor.number(8);
  return cursor.at_end() ? std::optional(layout) : std::nullopt;
}

bool is_sound_message(Message type, Bytes body) {
  const ByteCursor cursor(body);
  switch (type) {
    case Message::null:
      return true;
    case Message::link_info:
      return is_sound_link_info(cursor);
    case Message::fill_value:
      return is_sound_fill_value(cursor);
    case Message::link:
      return is_sound_link(cursor);
    case Message::group_info:
      return is_sound_group_info(cursor);
    case Message::filters:
      return is_sound_filter_list(cursor);
    case Message::attribute:
      return is_sound_attribute(cursor);
    case Message::attribute_info:
      return is_sound_attribute_info(cursor);
    default:
      return false;
  }
}

}  // namespace souple::storage
