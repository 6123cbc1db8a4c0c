// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <bit>
#include <charconv>
#include <cstdint>
#include <cstring>
#include <string>

#include "formats/core/mesh.hpp"

namespace souple {

/// The shortest text that reads back as the same number.
template <class T>
void append_number(std::string& text, T value) {
  std::array<char, 64> buffer;
  text.append(buffer.data(), std::to_chars(buffer.data(), buffer.data() + buffer.size(), value).ptr);
}

/// "x y z", without an end.
inline void append_point(std::string& text, const Point& point) {
  for (std::size_t k = 0; k < 3; ++k) {
    if (k > 0) text += ' ';
    append_number(text, point[k]);
  }
}

/// "a b c", counted from `first`, without an end.
template <class Cell>
void append_cell(std::string& text, const Cell& cell, std::int64_t first) {
  for (std::size_t k = 0; k < cell.size(); ++k) {
    if (k > 0) text += ' ';
    append_number(text, std::int64_t{cell[k]} + first);
  }
}

enum class ByteOrder : std::uint8_t { little, big };

template <ByteOrder order, class T>
void append_bytes(std::string& bytes, T value) {
  static_assert(std::endian::native == std::endian::little);
  std::array<char, sizeof(T)> raw;
  std::memcpy(raw.data(), &value, sizeof(T));
  for (std::size_t k = 0; k < sizeof(T); ++k)
    bytes += raw[order == ByteOrder::little ? k : sizeof(T) - 1 - k];
}

}  // namespace souple
