// SPDX-License-Identifier: MIT
// The small products that evaluate low-rank blocks. Every sum is one chain of fused multiply-adds in
// the order of the terms, with or without vector instructions: the bits of an entry do not depend on
// the tile that it is computed in.
#pragma once
#include <cstddef>
#include <cstdint>

namespace souple {

inline constexpr std::size_t tile_rows = 6, tile_columns = 16;
/// Rows of a leaf are padded to this.
inline constexpr std::size_t product_lane_count = 8;

/// tile (6 x 16, row-major) = sum over k < terms of a[6 k + i] b[16 k + j].
void multiply_tile(const float* a, const float* b, std::size_t terms, float* tile);

/// sums[k] += factor[k * rows + i] x[i] over all i, for k < terms; `rows` a multiple of 8. Number:
/// std::int8_t, std::int16_t, std::int32_t or float.
template <class Number>
void add_projection(const Number* factor, std::size_t rows, std::size_t terms, const float* x,
                    float* sums);
/// y[i] += factor[k * rows + i] sums[k] over all k < terms.
template <class Number>
void add_combination(const Number* factor, std::size_t rows, std::size_t terms, const float* sums,
                     float* y);

}  // namespace souple
