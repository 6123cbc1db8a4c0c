// SPDX-License-Identifier: MIT
#include "runtime/fem/half_products.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <bit>
#if defined(__F16C__) && defined(__AVX2__) && defined(__FMA__)
#include <immintrin.h>
#endif

namespace souple {

void append_halves(std::span<const float> values, PackedValues& halves) {
  constexpr float largest = 65504;
  for (const float value : values)
    halves.push_back(
        Eigen::numext::bit_cast<std::uint16_t>(Eigen::half(std::clamp(value, -largest, largest))));
}

#if defined(__F16C__) && defined(__AVX2__) && defined(__FMA__)

namespace {

__m256 eight(const std::uint16_t* halves) {
  return _mm256_cvtph_ps(_mm_loadu_si128(reinterpret_cast<const __m128i*>(halves)));
}

float sum_of(__m256 v) {
  const __m128 four = _mm_add_ps(_mm256_castps256_ps128(v), _mm256_extractf128_ps(v, 1));
  const __m128 two = _mm_add_ps(four, _mm_movehl_ps(four, four));
  return _mm_cvtss_f32(_mm_add_ss(two, _mm_shuffle_ps(two, two, 1)));
}

}  // namespace

// Three columns at a time, those of a node: y is loaded and stored once for them.
void add_product(const std::uint16_t* m, std::size_t rows, std::size_t columns, const float* x,
                 float* y) {
  for (std::size_t j = 0; j < columns; j += 3) {
    const std::uint16_t *m0 = m + j * rows, *m1 = m0 + rows, *m2 = m1 + rows;
    const __m256 x0 = _mm256_set1_ps(x[j]), x1 = _mm256_set1_ps(x[j + 1]),
                 x2 = _mm256_set1_ps(x[j + 2]);
    for (std::size_t i = 0; i < rows; i += 8) {
      // A line of the columns that come next, of which one holds 32 numbers.
      _mm_prefetch(reinterpret_cast<const char*>(m2 + (1 + i / 8 % 3) * rows + i), _MM_HINT_T0);
      __m256 sum = _mm256_loadu_ps(y + i);
      sum = _mm256_fmadd_ps(eight(m0 + i), x0, sum);
      sum = _mm256_fmadd_ps(eight(m1 + i), x1, sum);
      sum = _mm256_fmadd_ps(eight(m2 + i), x2, sum);
      _mm256_storeu_ps(y + i, sum);
    }
  }
}

void subtract_transposed_product(const std::uint16_t* m, std::size_t rows, std::size_t columns,
                                 const float* x, float* y) {
  for (std::size_t j = 0; j < columns; j += 3) {
    const std::uint16_t *m0 = m + j * rows, *m1 = m0 + rows, *m2 = m1 + rows;
    __m256 s0 = _mm256_setzero_ps(), s1 = s0, s2 = s0;
    for (std::size_t i = 0; i < rows; i += 8) {
      const __m256 v = _mm256_loadu_ps(x + i);
      s0 = _mm256_fmadd_ps(eight(m0 + i), v, s0);
      s1 = _mm256_fmadd_ps(eight(m1 + i), v, s1);
      s2 = _mm256_fmadd_ps(eight(m2 + i), v, s2);
    }
    y[j] -= sum_of(s0);
    y[j + 1] -= sum_of(s1);
    y[j + 2] -= sum_of(s2);
  }
}

#else

namespace {

float value_of(std::uint16_t half) { return float(Eigen::numext::bit_cast<Eigen::half>(half)); }

}  // namespace

void add_product(const std::uint16_t* m, std::size_t rows, std::size_t columns, const float* x,
                 float* y) {
  for (std::size_t j = 0; j < columns; ++j)
    for (std::size_t i = 0; i < rows; ++i) y[i] += value_of(m[j * rows + i]) * x[j];
}

void subtract_transposed_product(const std::uint16_t* m, std::size_t rows, std::size_t columns,
                                 const float* x, float* y) {
  for (std::size_t j = 0; j < columns; ++j) {
    float sum = 0;
    for (std::size_t i = 0; i < rows; ++i) sum += value_of(m[j * rows + i]) * x[i];
    y[j] -= sum;
  }
}

#endif

}  // namespace souple
