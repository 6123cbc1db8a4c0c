// SPDX-License-Identifier: MIT
// 3x3 blocks of single precision, row-major and unpadded, in registers.
#pragma once
#include <immintrin.h>

#include <array>
#include <cstddef>

namespace souple::block_kernel {

inline constexpr std::size_t floats = 9;

/// Eight entries and the last one.
struct Block {
  __m256 head;
  __m128 last;
};

inline Block zero() { return {_mm256_setzero_ps(), _mm_setzero_ps()}; }
inline Block load(const float* p) { return {_mm256_loadu_ps(p), _mm_load_ss(p + 8)}; }
inline void store(float* p, const Block& b) {
  _mm256_storeu_ps(p, b.head);
  _mm_store_ss(p + 8, b.last);
}

/// sum + weight block
inline Block add(const Block& sum, float weight, const Block& b) {
  return {_mm256_fmadd_ps(_mm256_set1_ps(weight), b.head, sum.head),
          _mm_fmadd_ss(_mm_set_ss(weight), b.last, sum.last)};
}
inline Block scaled(float weight, const Block& b) {
  return {_mm256_mul_ps(_mm256_set1_ps(weight), b.head), _mm_mul_ss(_mm_set_ss(weight), b.last)};
}

/// upper = a + b^T, and its transpose in `lower`; they may be the same block if a is b.
inline void store_symmetric(const float* a, const float* b, float* upper, float* lower) {
  std::array<float, floats> sum;
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j) sum[3 * i + j] = a[3 * i + j] + b[3 * j + i];
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j) upper[3 * i + j] = lower[3 * j + i] = sum[3 * i + j];
}

}  // namespace souple::block_kernel
