// SPDX-License-Identifier: MIT
#include "runtime/compliance/product_kernel.hpp"

#include <cmath>

#if defined(__AVX2__) && defined(__FMA__)
#include <immintrin.h>
#endif

namespace souple {

#if defined(__AVX2__) && defined(__FMA__)

namespace {

// One row of a tile: sixteen sums in two registers.
struct Row {
  __m256 low = _mm256_setzero_ps(), high = _mm256_setzero_ps();
  void add(float a, __m256 b_low, __m256 b_high) {
    const __m256 factor = _mm256_set1_ps(a);
    low = _mm256_fmadd_ps(factor, b_low, low);
    high = _mm256_fmadd_ps(factor, b_high, high);
  }
  void store(float* out) const {
    _mm256_storeu_ps(out, low);
    _mm256_storeu_ps(out + 8, high);
  }
};

__m256 eight(const float* values) { return _mm256_loadu_ps(values); }
__m256 eight(const std::int8_t* integers) {
  return _mm256_cvtepi32_ps(
      _mm256_cvtepi8_epi32(_mm_loadl_epi64(reinterpret_cast<const __m128i*>(integers))));
}
__m256 eight(const std::int16_t* integers) {
  return _mm256_cvtepi32_ps(
      _mm256_cvtepi16_epi32(_mm_loadu_si128(reinterpret_cast<const __m128i*>(integers))));
}
__m256 eight(const std::int32_t* integers) {
  return _mm256_cvtepi32_ps(_mm256_loadu_si256(reinterpret_cast<const __m256i*>(integers)));
}

float sum_of_lanes(__m256 v) {
  __m128 s = _mm_add_ps(_mm256_castps256_ps128(v), _mm256_extractf128_ps(v, 1));
  s = _mm_add_ps(s, _mm_movehl_ps(s, s));
  return _mm_cvtss_f32(_mm_add_ss(s, _mm_movehdup_ps(s)));
}

}  // namespace

void multiply_tile(const float* a, const float* b, std::size_t terms, float* tile) {
  Row r0, r1, r2, r3, r4, r5;
  for (std::size_t k = 0; k < terms; ++k, a += tile_rows, b += tile_columns) {
    const __m256 low = _mm256_loadu_ps(b), high = _mm256_loadu_ps(b + 8);
    r0.add(a[0], low, high);
    r1.add(a[1], low, high);
    r2.add(a[2], low, high);
    r3.add(a[3], low, high);
    r4.add(a[4], low, high);
    r5.add(a[5], low, high);
  }
  r0.store(tile);
  r1.store(tile + 16);
  r2.store(tile + 32);
  r3.store(tile + 48);
  r4.store(tile + 64);
  r5.store(tile + 80);
}

template <class Number>
void add_projection(const Number* factor, std::size_t rows, std::size_t terms, const float* x,
                    float* sums) {
  for (std::size_t k = 0; k < terms; ++k, factor += rows) {
    __m256 sum = _mm256_setzero_ps();
    for (std::size_t i = 0; i < rows; i += product_lane_count)
      sum = _mm256_fmadd_ps(eight(factor + i), _mm256_loadu_ps(x + i), sum);
    sums[k] += sum_of_lanes(sum);
  }
}

namespace {

// The first 8 `count` rows: they stay in registers over all terms.
template <std::size_t count, class Number>
void add_stripe(const Number* factor, std::size_t rows, std::size_t terms, const float* sums,
                float* y) {
  __m256 v[count];
  for (std::size_t r = 0; r < count; ++r) v[r] = _mm256_loadu_ps(y + product_lane_count * r);
  for (std::size_t k = 0; k < terms; ++k, factor += rows) {
    const __m256 s = _mm256_set1_ps(sums[k]);
    for (std::size_t r = 0; r < count; ++r)
      v[r] = _mm256_fmadd_ps(eight(factor + product_lane_count * r), s, v[r]);
  }
  for (std::size_t r = 0; r < count; ++r) _mm256_storeu_ps(y + product_lane_count * r, v[r]);
}

// add_stripe<count>.
template <class Number, std::size_t most = 12>
void add_stripe_of(std::size_t count, const Number* factor, std::size_t rows, std::size_t terms,
                   const float* sums, float* y) {
  if (count == most) return add_stripe<most>(factor, rows, terms, sums, y);
  if constexpr (most > 1) add_stripe_of<Number, most - 1>(count, factor, rows, terms, sums, y);
}

}  // namespace

// By stripes of about the same height, as high as the registers hold.
template <class Number>
void add_combination(const Number* factor, std::size_t rows, std::size_t terms, const float* sums,
                     float* y) {
  constexpr std::size_t most = 12;
  const std::size_t count = rows / product_lane_count;
  const std::size_t stripes = (count + most - 1) / most;
  for (std::size_t stripe = 0; stripe < stripes; ++stripe) {
    const std::size_t first = stripe * count / stripes, last = (stripe + 1) * count / stripes;
    add_stripe_of<Number>(last - first, factor + product_lane_count * first, rows, terms, sums,
                          y + product_lane_count * first);
  }
}

#else

void multiply_tile(const float* a, const float* b, std::size_t terms, float* tile) {
  for (std::size_t j = 0; j < tile_rows * tile_columns; ++j) tile[j] = 0;
  for (std::size_t k = 0; k < terms; ++k, a += tile_rows, b += tile_columns)
    for (std::size_t i = 0; i < tile_rows; ++i)
      for (std::size_t j = 0; j < tile_columns; ++j)
        tile[tile_columns * i + j] = std::fma(a[i], b[j], tile[tile_columns * i + j]);
}

template <class Number>
void add_projection(const Number* factor, std::size_t rows, std::size_t terms, const float* x,
                    float* sums) {
  for (std::size_t k = 0; k < terms; ++k, factor += rows) {
    float lanes[product_lane_count] = {};
    for (std::size_t i = 0; i < rows; ++i)
      lanes[i % product_lane_count] = std::fma(float(factor[i]), x[i], lanes[i % product_lane_count]);
    float half[4];
    for (std::size_t r = 0; r < 4; ++r) half[r] = lanes[r] + lanes[r + 4];
    sums[k] += (half[0] + half[2]) + (half[1] + half[3]);
  }
}

template <class Number>
void add_combination(const Number* factor, std::size_t rows, std::size_t terms, const float* sums,
                     float* y) {
  for (std::size_t k = 0; k < terms; ++k, factor += rows)
    for (std::size_t i = 0; i < rows; ++i) y[i] = std::fma(float(factor[i]), sums[k], y[i]);
}

#endif

#define SOUPLE_PRODUCTS(Number)                                                                \
  template void add_projection(const Number*, std::size_t, std::size_t, const float*, float*); \
  template void add_combination(const Number*, std::size_t, std::size_t, const float*, float*);
SOUPLE_PRODUCTS(float)
SOUPLE_PRODUCTS(std::int8_t)
SOUPLE_PRODUCTS(std::int16_t)
SOUPLE_PRODUCTS(std::int32_t)
#undef SOUPLE_PRODUCTS

}  // namespace souple
