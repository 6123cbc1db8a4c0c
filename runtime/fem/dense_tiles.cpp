// SPDX-License-Identifier: MIT
#include "runtime/fem/dense_tiles.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "runtime/fem/tile_products.hpp"

namespace souple {
namespace {

constexpr std::size_t chunk_depth = 192;  // two strips of so many columns stay in the first cache

// The first `count` of four lanes; the others are 0 and are not touched in memory.
__m256i lane_mask(std::size_t count) {
  return _mm256_cmpgt_epi64(_mm256_set1_epi64x(static_cast<long long>(count)),
                            _mm256_set_epi64x(3, 2, 1, 0));
}

std::size_t lanes_left(std::size_t rows, std::size_t i) {
  return i < rows ? std::min<std::size_t>(rows - i, 4) : 0;
}

SOUPLE_KERNEL Lanes load_part(const double* p, std::size_t count) {
  return count == 4 ? load_lanes(p) : _mm256_maskload_pd(p, lane_mask(count));
}
SOUPLE_KERNEL void store_part(double* p, Lanes value, std::size_t count) {
  if (count == 4)
    _mm256_storeu_pd(p, value);
  else
    _mm256_maskstore_pd(p, lane_mask(count), value);
}

// Up to four columns of a strip of up to twelve rows: out = from - sum.
SOUPLE_KERNEL void store_difference(const TileSum<4>& sum, const double* from, double* out,
                                    std::size_t stride, std::size_t rows, std::size_t columns) {
  for (std::size_t c = 0; c < columns; ++c)
    for (std::size_t v = 0; v < tile_lanes; ++v)
      if (const std::size_t count = lanes_left(rows, 4 * v); count > 0) {
        const std::size_t at = c * stride + 4 * v;
        store_part(out + at, load_part(from + at, count) - sum.value[c][v], count);
      }
}

/// The factor of a diagonal block, its missing rows and columns those of the identity.
struct Diagonal {
  std::array<std::array<double, tile_width>, tile_width> column{};
  std::array<double, tile_width> reciprocal{};

  bool factorize() {
    for (std::size_t c = 0; c < tile_width; ++c) {
      const double square = column[c][c];
      if (!(square > 0) || !std::isfinite(square)) return false;
      const double root = std::sqrt(square);
      reciprocal[c] = 1 / root;
      for (double& value : column[c]) value *= reciprocal[c];
      column[c][c] = root;
      for (std::size_t d = c + 1; d < tile_width; ++d)
        for (std::size_t r = 0; r < tile_width; ++r) column[d][r] -= column[c][r] * column[c][d];
    }
    return true;
  }
};

bool factorize_diagonal(double* block, std::size_t stride, std::size_t width, Diagonal& diagonal) {
  for (std::size_t c = 0; c < tile_width; ++c) {
    diagonal.column[c].fill(0);
    if (c < width)
      std::copy(block + c * stride + c, block + c * stride + width,
                diagonal.column[c].begin() + std::ptrdiff_t(c));
    else
      diagonal.column[c][c] = 1;
  }
  if (!diagonal.factorize()) return false;
  for (std::size_t c = 0; c < width; ++c)
    std::copy(diagonal.column[c].begin() + std::ptrdiff_t(c),
              diagonal.column[c].begin() + std::ptrdiff_t(width), block + c * stride + c);
  return true;
}

// Four rows or fewer: x = x L^-T.
void solve_rows(const Diagonal& diagonal, double* x, std::size_t stride, std::size_t count,
                std::size_t width) {
  Lanes value[tile_width];
  for (std::size_t c = 0; c < tile_width; ++c)
    value[c] = c < width ? load_part(x + c * stride, count) : zero_lanes();
  for (std::size_t c = 0; c < tile_width; ++c) {
    value[c] = value[c] * all_lanes(diagonal.reciprocal[c]);
    for (std::size_t d = c + 1; d < tile_width; ++d)
      value[d] = fnma(all_lanes(diagonal.column[c][d]), value[c], value[d]);
  }
  for (std::size_t c = 0; c < width; ++c) store_part(x + c * stride, value[c], count);
}

// What the columns before take from up to twelve columns, from their diagonal on. Kernels read up to
// eleven numbers past a column: those of the next one, which a column before another always has.
void subtract_columns_before(double* panel, std::size_t rows, std::size_t begin, std::size_t width) {
  for (std::size_t i = begin; i < rows; i += tile_width)
    for (std::size_t q = 0; q < width; q += 4) {
      const auto sum = tile_product<4>(panel + begin + q, rows, panel + i, rows, begin);
      double* const out = panel + (begin + q) * rows + i;
      store_difference(sum, out, out, rows, rows - i, std::min<std::size_t>(width - q, 4));
    }
}

// Strips of twelve rows, each by columns; the last one filled with zeros.
void pack_strips(const RowsOfColumns& x, double* strips) {
  for (std::size_t i = 0; i < x.rows; i += tile_width) {
    const double* column = x.first + i;
    for (std::size_t k = 0; k < x.columns; ++k, column += x.stride, strips += tile_width)
      for (std::size_t v = 0; v < tile_lanes; ++v)
        _mm256_storeu_pd(strips + 4 * v, load_part(column + 4 * v, lanes_left(x.rows, i + 4 * v)));
  }
}

}  // namespace

bool factorize_panel(double* panel, std::size_t rows, std::size_t columns) {
  Diagonal diagonal;
  for (std::size_t k = 0; k < columns; k += tile_width) {
    const std::size_t width = std::min(tile_width, columns - k);
    if (k > 0) subtract_columns_before(panel, rows, k, width);
    double* const block = panel + k * rows;
    if (!factorize_diagonal(block + k, rows, width, diagonal)) return false;
    for (std::size_t i = k + width; i < rows; i += 4)
      solve_rows(diagonal, block + i, rows, lanes_left(rows, i), width);
  }
  return true;
}

std::size_t square_work(std::size_t rows, std::size_t columns) {
  return (rows + tile_width - 1) / tile_width * tile_width * columns;
}

void subtract_square(const RowsOfColumns& x, const double* from, double* out, double* work) {
  pack_strips(x, work);
  const auto strip = [&](std::size_t row) { return work + row * x.columns; };
  for (std::size_t j = 0; j < x.rows; j += tile_width)
    for (std::size_t i = j; i < x.rows; i += tile_width)
      for (std::size_t q = 0; q < std::min(tile_width, x.rows - j); q += 4) {
        const std::size_t at = (j + q) * x.rows + i;
        const double* before = from + at;
        for (std::size_t k = 0; k < x.columns; k += chunk_depth, before = out + at)
          store_difference(
              tile_product<4>(strip(j) + tile_width * k + q, tile_width, strip(i) + tile_width * k,
                              tile_width, std::min(chunk_depth, x.columns - k)),
              before, out + at, x.rows, x.rows - i, std::min<std::size_t>(x.rows - j - q, 4));
      }
}

}  // namespace souple
