// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/exchange/tets/number_type.hpp"

#include <cmath>
#include <limits>

namespace souple {
namespace {

std::int64_t load_signed(const char* bytes, std::size_t width, bool swap) {
  switch (width) {
    case 1:
      return load_number<std::int8_t>(bytes, swap);
    case 2:
      return load_number<std::int16_t>(bytes, swap);
    case 4:
      return load_number<std::int32_t>(bytes, swap);
    default:
      return load_number<std::int64_t>(bytes, swap);
  }
}

std::uint64_t load_unsigned(const char* bytes, std::size_t width, bool swap) {
  switch (width) {
    case 1:
      return load_number<std::uint8_t>(bytes, swap);
    case 2:
      return load_number<std::uint16_t>(bytes, swap);
    case 4:
      return load_number<std::uint32_t>(bytes, swap);
    default:
      return load_number<std::uint64_t>(bytes, swap);
  }
}

}  // namespace

double load_real(const char* bytes, const NumberType& type, bool swap) {
  switch (type.kind) {
    case NumberKind::signed_integer:
      return static_cast<double>(load_signed(bytes, type.width, swap));
    case NumberKind::unsigned_integer:
      return static_cast<double>(load_unsigned(bytes, type.width, swap));
    case NumberKind::real:
      break;
  }
  return type.width == 4 ? double{load_number<float>(bytes, swap)} : load_number<double>(bytes, swap);
}

std::optional<std::int64_t> load_integer(const char* bytes, const NumberType& type, bool swap) {
  if (type.kind == NumberKind::signed_integer) return load_signed(bytes, type.width, swap);
  if (type.kind == NumberKind::real) return exact_integer(load_real(bytes, type, swap));
  const std::uint64_t value = load_unsigned(bytes, type.width, swap);
  if (value > static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max())) return std::nullopt;
  return static_cast<std::int64_t>(value);
}

std::optional<std::int64_t> exact_integer(double value) {
  constexpr double largest = 9007199254740992.0;  // 2^53
  if (!(std::abs(value) <= largest) || value != std::trunc(value)) return std::nullopt;
  return static_cast<std::int64_t>(value);
}

}  // namespace souple
