// SPDX-License-Identifier: MIT
// Four elements at a time: a vector of four doubles has one lane for each, and 3x3 matrices are made of
// such vectors. Internal to the kernels.
#pragma once
#include <immintrin.h>

#include "runtime/fem/linear_algebra.hpp"

/// Matrices in lanes have to stay in registers: what handles them is inlined.
#define SOUPLE_KERNEL [[gnu::always_inline]] inline

namespace souple {

using Lanes = __m256d;
inline constexpr Index lane_count = 4;

/// m[row][column], one matrix in each lane.
struct LaneMat3 {
  Lanes m[3][3];
};

SOUPLE_KERNEL Lanes all_lanes(double value) { return _mm256_set1_pd(value); }
SOUPLE_KERNEL Lanes zero_lanes() { return _mm256_setzero_pd(); }
/// a b + c, rounded once.
SOUPLE_KERNEL Lanes fma(Lanes a, Lanes b, Lanes c) { return _mm256_fmadd_pd(a, b, c); }
/// c - a b, rounded once.
SOUPLE_KERNEL Lanes fnma(Lanes a, Lanes b, Lanes c) { return _mm256_fnmadd_pd(a, b, c); }
SOUPLE_KERNEL Lanes dot3(Lanes a0, Lanes a1, Lanes a2, Lanes b0, Lanes b1, Lanes b2) {
  return fma(a0, b0, fma(a1, b1, a2 * b2));
}

/// Three doubles; the fourth lane is 0. Reads nothing beyond them.
SOUPLE_KERNEL Lanes load3(const double* p) {
  return _mm256_maskload_pd(p, _mm256_set_epi64x(0, -1, -1, -1));
}
SOUPLE_KERNEL void store3(double* p, Lanes v) {
  _mm_storeu_pd(p, _mm256_castpd256_pd128(v));
  _mm_store_sd(p + 2, _mm256_extractf128_pd(v, 1));
}

/// Rows become columns.
SOUPLE_KERNEL void transpose(Lanes& a, Lanes& b, Lanes& c, Lanes& d) {
  const Lanes ab0 = _mm256_unpacklo_pd(a, b), ab1 = _mm256_unpackhi_pd(a, b);
  const Lanes cd0 = _mm256_unpacklo_pd(c, d), cd1 = _mm256_unpackhi_pd(c, d);
  a = _mm256_permute2f128_pd(ab0, cd0, 0x20);
  b = _mm256_permute2f128_pd(ab1, cd1, 0x20);
  c = _mm256_permute2f128_pd(ab0, cd0, 0x31);
  d = _mm256_permute2f128_pd(ab1, cd1, 0x31);
}

/// a b.
SOUPLE_KERNEL LaneMat3 product(const LaneMat3& a, const LaneMat3& b) {
  LaneMat3 c;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      c.m[i][j] = dot3(a.m[i][0], a.m[i][1], a.m[i][2], b.m[0][j], b.m[1][j], b.m[2][j]);
  return c;
}

/// a b^T.
SOUPLE_KERNEL LaneMat3 product_transposed(const LaneMat3& a, const LaneMat3& b) {
  LaneMat3 c;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      c.m[i][j] = dot3(a.m[i][0], a.m[i][1], a.m[i][2], b.m[j][0], b.m[j][1], b.m[j][2]);
  return c;
}

/// Four consecutive matrices into the lanes.
SOUPLE_KERNEL LaneMat3 load_matrices(const Mat3* from) {
  const double* p = from->data();
  Lanes v[9];
  for (int lane = 0; lane < 4; ++lane) v[lane] = _mm256_loadu_pd(p + 9 * lane);
  for (int lane = 0; lane < 4; ++lane) v[4 + lane] = _mm256_loadu_pd(p + 9 * lane + 4);
  transpose(v[0], v[1], v[2], v[3]);
  transpose(v[4], v[5], v[6], v[7]);
  v[8] = _mm256_set_pd(p[35], p[26], p[17], p[8]);
  LaneMat3 result;
  for (int k = 0; k < 9; ++k) result.m[k % 3][k / 3] = v[k];
  return result;
}

SOUPLE_KERNEL void store_matrices(const LaneMat3& matrices, Mat3* to) {
  double* p = to->data();
  Lanes v[9];
  for (int k = 0; k < 9; ++k) v[k] = matrices.m[k % 3][k / 3];
  transpose(v[0], v[1], v[2], v[3]);
  transpose(v[4], v[5], v[6], v[7]);
  for (int lane = 0; lane < 4; ++lane) _mm256_storeu_pd(p + 9 * lane, v[lane]);
  for (int lane = 0; lane < 4; ++lane) _mm256_storeu_pd(p + 9 * lane + 4, v[4 + lane]);
  alignas(32) double last[4];
  _mm256_store_pd(last, v[8]);
  for (int lane = 0; lane < 4; ++lane) p[9 * lane + 8] = last[lane];
}

}  // namespace souple
