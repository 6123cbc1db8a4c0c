// SPDX-License-Identifier: MIT
// The product that dense blocks of a sparse factor spend their time in: four rows by twelve columns of
// the result stay in registers. Internal to the kernels.
#pragma once
#include <type_traits>

#include "runtime/fem/lanes.hpp"

namespace souple {

inline constexpr std::size_t tile_width = 12;
inline constexpr std::size_t tile_lanes = tile_width / lane_count;

/// `rows` (1 to 4) by tile_width.
template <std::size_t rows>
struct TileSum {
  Lanes value[rows][tile_lanes];
};

SOUPLE_KERNEL Lanes load_lanes(const double* p) { return _mm256_loadu_pd(p); }

/// Sum over k < depth of a_k b_k^T, where a_k are the `rows` numbers at a + k a_stride and b_k the
/// tile_width numbers at b + k b_stride; in the order of k, rounded once a term.
template <std::size_t rows>
SOUPLE_KERNEL TileSum<rows> tile_product(const double* a, std::size_t a_stride, const double* b,
                                         std::size_t b_stride, std::size_t depth) {
  TileSum<rows> sum;
  for (auto& row : sum.value)
    for (Lanes& v : row) v = zero_lanes();
  for (std::size_t k = 0; k < depth; ++k, a += a_stride, b += b_stride) {
    const Lanes b0 = load_lanes(b), b1 = load_lanes(b + 4), b2 = load_lanes(b + 8);
    for (std::size_t r = 0; r < rows; ++r) {
      const Lanes factor = all_lanes(a[r]);
      sum.value[r][0] = fma(factor, b0, sum.value[r][0]);
      sum.value[r][1] = fma(factor, b1, sum.value[r][1]);
      sum.value[r][2] = fma(factor, b2, sum.value[r][2]);
    }
  }
  return sum;
}

/// visit(std::integral_constant rows, first row) for strips of four rows, the last one of what is left.
template <class Visit>
SOUPLE_KERNEL void for_row_strips(std::size_t row_count, Visit&& visit) {
  std::size_t i = 0;
  for (; i + 4 <= row_count; i += 4) visit(std::integral_constant<std::size_t, 4>{}, i);
  switch (row_count - i) {
    case 3:
      visit(std::integral_constant<std::size_t, 3>{}, i);
      break;
    case 2:
      visit(std::integral_constant<std::size_t, 2>{}, i);
      break;
    case 1:
      visit(std::integral_constant<std::size_t, 1>{}, i);
      break;
    default:
      break;
  }
}

}  // namespace souple
