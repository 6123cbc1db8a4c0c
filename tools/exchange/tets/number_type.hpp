// SPDX-License-Identifier: GPL-3.0-or-later
// Binary numbers of any width and byte order.
#pragma once
#include <bit>
#include <cstdint>
#include <cstring>
#include <optional>
#include <string_view>

namespace souple {

static_assert(std::endian::native == std::endian::little);

/// The number at `bytes`, which holds at least sizeof(T) of them; `swap`: it is big-endian.
template <class T>
T load_number(const char* bytes, bool swap) {
  char raw[sizeof(T)];
  for (std::size_t k = 0; k < sizeof(T); ++k) raw[k] = bytes[swap ? sizeof(T) - 1 - k : k];
  T value;
  std::memcpy(&value, raw, sizeof(T));
  return value;
}

enum class NumberKind : std::uint8_t { signed_integer, unsigned_integer, real };

struct NumberType {
  NumberKind kind = NumberKind::real;
  std::size_t width = 8;  ///< bytes: 1, 2, 4, 8; of reals 4, 8
};

/// As a double (may be infinite or NaN), or as an integer; no integer for reals with a fraction and for
/// what exceeds 63 bits.
double load_real(const char* bytes, const NumberType& type, bool swap);
std::optional<std::int64_t> load_integer(const char* bytes, const NumberType& type, bool swap);
/// The integer that a double is, if it is one within 2^53.
std::optional<std::int64_t> exact_integer(double value);

}  // namespace souple
