// SPDX-License-Identifier: GPL-3.0-or-later
// Arrays of legacy VTK: as text, or as big-endian bytes behind the end of the line.
#pragma once
#include <string_view>
#include <vector>

#include "tools/exchange/tets/number_type.hpp"
#include "tools/exchange/tets/text_cursor.hpp"

namespace souple {

struct VtkNumbers {
  explicit VtkNumbers(std::string_view bytes) : in(bytes) {}

  TextCursor in;
  bool binary = false;

  /// The name of a type; others are refused.
  NumberType take_type();
  /// A count of numbers.
  std::size_t take_count(const NumberType& type);
  /// The same for a count that was taken, or computed, before.
  std::size_t checked(std::int64_t count, const NumberType& type, std::size_t most = most_values);
  std::vector<std::int64_t> take_integers(std::size_t count, const NumberType& type);
  std::vector<double> take_reals(std::size_t count, const NumberType& type);
  /// Data that nobody uses may hold anything, NaN included.
  void skip(std::size_t count, const NumberType& type);

  static constexpr std::size_t most_values = std::size_t{1} << 40;

 private:
  template <class FromText, class FromBytes>
  void each(std::size_t count, const NumberType& type, FromText from_text, FromBytes from_bytes);
};

}  // namespace souple
