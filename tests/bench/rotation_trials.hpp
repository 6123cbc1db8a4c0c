// SPDX-License-Identifier: GPL-3.0-or-later
// Ways to a rotation that were measured against the shipped one (rotation_lanes.hpp), on deformation
// gradients that are at hand as arrays of entries: entry k of matrix i at k n + i, row-major.
#pragma once
#include <immintrin.h>

#include <cstddef>
#include <vector>

#include "runtime/fem/rotation_lanes.hpp"

namespace souple::bench {

using Floats = __m256;

inline Floats filled(Floats, double value) { return _mm256_set1_ps(float(value)); }
inline Lanes filled(Lanes, double value) { return _mm256_set1_pd(value); }
inline Floats fused(Floats a, Floats b, Floats c) { return _mm256_fmadd_ps(a, b, c); }
inline Lanes fused(Lanes a, Lanes b, Lanes c) { return _mm256_fmadd_pd(a, b, c); }
inline Floats root(Floats a) { return _mm256_sqrt_ps(a); }
inline Lanes root(Lanes a) { return _mm256_sqrt_pd(a); }
inline Floats at(const float* p) { return _mm256_loadu_ps(p); }
inline Lanes at(const double* p) { return _mm256_loadu_pd(p); }
inline void put(float* p, Floats v) { _mm256_storeu_ps(p, v); }
inline void put(double* p, Lanes v) { _mm256_storeu_pd(p, v); }

template <class V>
struct Matrix {
  V m[3][3];
};

template <class V>
SOUPLE_KERNEL Matrix<V> cofactor(const Matrix<V>& f) {
  Matrix<V> c;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      const int i1 = (i + 1) % 3, i2 = (i + 2) % 3, j1 = (j + 1) % 3, j2 = (j + 2) % 3;
      c.m[i][j] = f.m[i1][j1] * f.m[i2][j2] - f.m[i1][j2] * f.m[i2][j1];
    }
  return c;
}

template <class V>
SOUPLE_KERNEL V inner(const Matrix<V>& a, const Matrix<V>& b) {
  V sum = filled(V{}, 0);
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) sum = fused(a.m[i][j], b.m[i][j], sum);
  return sum;
}

/// Higham's scaled Newton iteration X <- (g X + X^-T / g) / 2. Not safe for flat or inverted elements.
template <int iterations>
struct HighamNewton {
  template <class V>
  SOUPLE_KERNEL static Matrix<V> rotation(Matrix<V> x, const V*, V*) {
    for (int step = 0; step < iterations; ++step) {
      const Matrix<V> c = cofactor(x);
      const V det = fused(x.m[0][0], c.m[0][0], fused(x.m[0][1], c.m[0][1], x.m[0][2] * c.m[0][2]));
      const V inverse = filled(V{}, 1) / det;
      // The scale matters in the first steps only.
      const V g2 = step < 2 ? root(inner(c, c) * inverse * inverse / inner(x, x)) : filled(V{}, 1);
      const V g = step < 2 ? root(g2) : g2;
      const V half = filled(V{}, 0.5), of_c = half * inverse / g;
      for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) x.m[i][j] = fused(half * g, x.m[i][j], of_c * c.m[i][j]);
    }
    return x;
  }
};

template <class V>
SOUPLE_KERNEL Matrix<V> matrix_of(const V* q) {
  const V one = filled(V{}, 1), two = filled(V{}, 2);
  const V &w = q[0], &x = q[1], &y = q[2], &z = q[3];
  return {{{one - two * (y * y + z * z), two * (x * y - w * z), two * (x * z + w * y)},
           {two * (x * y + w * z), one - two * (x * x + z * z), two * (y * z - w * x)},
           {two * (x * z - w * y), two * (y * z + w * x), one - two * (x * x + y * y)}}};
}

/// Turns q by the small rotation with vector part v / 2, and makes it unit again.
template <class V>
SOUPLE_KERNEL void turn(V* q, const V* v) {
  const V half = filled(V{}, 0.5);
  const V a = half * v[0], b = half * v[1], c = half * v[2];
  const V r[4] = {q[0] - a * q[1] - b * q[2] - c * q[3], q[1] + a * q[0] + b * q[3] - c * q[2],
                  q[2] - a * q[3] + b * q[0] + c * q[1], q[3] + a * q[2] - b * q[1] + c * q[0]};
  const V length = root(r[0] * r[0] + r[1] * r[1] + r[2] * r[2] + r[3] * r[3]);
  for (int k = 0; k < 4; ++k) q[k] = r[k] / length;
}

/// axial[k]: sum of r_i x f_i over the columns.
template <class V>
SOUPLE_KERNEL void axial_vector(const Matrix<V>& r, const Matrix<V>& f, V* axial) {
  for (int k = 0; k < 3; ++k) {
    const int k1 = (k + 1) % 3, k2 = (k + 2) % 3;
    axial[k] = filled(V{}, 0);
    for (int i = 0; i < 3; ++i) axial[k] = axial[k] + r.m[k1][i] * f.m[k2][i] - r.m[k2][i] * f.m[k1][i];
  }
}

/// Müller et al. 2016: turns by (sum r_i x f_i) / |sum r_i . f_i|, from the rotation of the last step.
template <int iterations>
struct QuaternionSteps {
  template <class V>
  SOUPLE_KERNEL static Matrix<V> rotation(const Matrix<V>& f, const V* last, V* q) {
    for (int k = 0; k < 4; ++k) q[k] = last[k];
    for (int step = 0; step < iterations; ++step) {
      const Matrix<V> r = matrix_of(q);
      V v[3];
      axial_vector(r, f, v);
      const V trace = inner(r, f);
      const V inverse = filled(V{}, 1) / (root(trace * trace) + filled(V{}, 1e-9));
      for (V& component : v) component = component * inverse;
      turn(q, v);
    }
    return matrix_of(q);
  }
};

/// Newton's method for the largest trace of R^T F: turns by (tr S - S)^-1 of the same sum, S the
/// symmetric part of F R^T, from the rotation of the last step.
template <int iterations>
struct QuaternionNewton {
  template <class V>
  SOUPLE_KERNEL static Matrix<V> rotation(const Matrix<V>& f, const V* last, V* q) {
    for (int k = 0; k < 4; ++k) q[k] = last[k];
    for (int step = 0; step < iterations; ++step) {
      const Matrix<V> r = matrix_of(q);
      V v[3];
      axial_vector(r, f, v);
      Matrix<V> s;
      for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
          s.m[i][j] = f.m[i][0] * r.m[j][0] + f.m[i][1] * r.m[j][1] + f.m[i][2] * r.m[j][2];
      const V trace = s.m[0][0] + s.m[1][1] + s.m[2][2];
      Matrix<V> h;
      for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) {
          h.m[i][j] = filled(V{}, -0.5) * (s.m[i][j] + s.m[j][i]);
          if (i == j) h.m[i][j] = h.m[i][j] + trace;
        }
      const Matrix<V> c = cofactor(h);
      const V det = h.m[0][0] * c.m[0][0] + h.m[0][1] * c.m[0][1] + h.m[0][2] * c.m[0][2];
      const V inverse = filled(V{}, 1) / det;
      V w[3];
      for (int i = 0; i < 3; ++i)
        w[i] = (c.m[i][0] * v[0] + c.m[i][1] * v[1] + c.m[i][2] * v[2]) * inverse;
      turn(q, w);
    }
    return matrix_of(q);
  }
};

/// All matrices by one of the above; `last` and `next` hold quaternions like `f` holds matrices.
template <class Method, class Scalar>
void rotate_all(const std::vector<Scalar>& f, const std::vector<Scalar>& last,
                std::vector<Scalar>& next, std::vector<Scalar>& r) {
  using V = decltype(at(f.data()));
  constexpr std::size_t width = sizeof(V) / sizeof(Scalar);
  const std::size_t n = f.size() / 9;
  for (std::size_t i = 0; i < n; i += width) {
    Matrix<V> m;
    for (std::size_t k = 0; k < 9; ++k) m.m[k / 3][k % 3] = at(f.data() + k * n + i);
    V before[4], q[4];
    for (std::size_t k = 0; k < 4; ++k) before[k] = q[k] = at(last.data() + k * n + i);
    const Matrix<V> found = Method::rotation(m, before, q);
    for (std::size_t k = 0; k < 9; ++k) put(r.data() + k * n + i, found.m[k / 3][k % 3]);
    for (std::size_t k = 0; k < 4; ++k) put(next.data() + k * n + i, q[k]);
  }
}

/// The shipped kernel on the same arrays; hard lanes are left as they are.
inline void shipped_all(const std::vector<double>& f, std::vector<double>& r) {
  const std::size_t n = f.size() / 9;
  for (std::size_t begin = 0; begin < n; begin += std::size_t{lane_count} * tile_packs) {
    const int packs = int(std::min<std::size_t>(tile_packs, (n - begin) / lane_count));
    LaneMat3 m[tile_packs];
    LaneRotations found[tile_packs];
    for (int p = 0; p < packs; ++p)
      for (std::size_t k = 0; k < 9; ++k)
        m[p].m[k / 3][k % 3] = at(f.data() + k * n + begin + 4 * std::size_t(p));
    rotations_of<RotationMethod::polar>(m, packs, found);
    for (int p = 0; p < packs; ++p)
      for (std::size_t k = 0; k < 9; ++k)
        put(r.data() + k * n + begin + 4 * std::size_t(p), found[p].matrices.m[k / 3][k % 3]);
  }
}

}  // namespace souple::bench
