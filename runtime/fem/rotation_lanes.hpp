// SPDX-License-Identifier: MIT
// Rotations of four deformation gradients at a time. Internal to the kernels, which inline it: through
// memory these matrices would cost more than what is computed of them.
#pragma once
#include "runtime/fem/lanes.hpp"
#include "runtime/fem/rotation_method.hpp"

namespace souple {

struct LaneRotations {
  LaneMat3 matrices;
  int is_good = 0;  ///< bit by lane; the others are too flat or inverted for the kernel
};

/// Packs of four that are worked on together.
inline constexpr int tile_packs = 8;

namespace rotation_lanes {

// z / l^3 (see polar) is 8/27 for a rotation and falls to 0 where the rotation is not determined: s2 +
// s3 = 0 or a tet collapsed to a line. Round-off grows as its inverse: 1e-13 at this bound.
inline constexpr double least_relative_slope = 1e-3;
// Squared length of what orthonormalisation leaves of a row or column, relative to what it was.
inline constexpr double least_relative_remainder = 1e-8;
inline constexpr int newton_limit = 12;

SOUPLE_KERNEL LaneMat3 cofactors(const LaneMat3& f) {
  LaneMat3 c;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      const int i1 = (i + 1) % 3, i2 = (i + 2) % 3, j1 = (j + 1) % 3, j2 = (j + 2) % 3;
      c.m[i][j] = fnma(f.m[i1][j2], f.m[i2][j1], f.m[i1][j1] * f.m[i2][j2]);
    }
  return c;
}

/// What the largest trace depends on, and F F^T on the way to it.
struct Invariants {
  Lanes a, d, c;  ///< |F|^2, det F, |F|^4 - 4 |cof F|^2
  Lanes left[6];  ///< F F^T: xx, yy, zz, xy, yz, zx
};

SOUPLE_KERNEL Invariants invariants_of(const LaneMat3& f) {
  Invariants result;
  Lanes squares = zero_lanes(), products = zero_lanes();
  for (int i = 0; i < 3; ++i) {
    const auto &row = f.m[i], &next = f.m[(i + 1) % 3];
    Lanes &own = result.left[i], &mixed = result.left[3 + i];
    own = dot3(row[0], row[1], row[2], row[0], row[1], row[2]);
    mixed = dot3(row[0], row[1], row[2], next[0], next[1], next[2]);
    squares = fma(own, own, squares);
    products = fma(mixed, mixed, products);
  }
  result.a = result.left[0] + result.left[1] + result.left[2];
  const LaneMat3 cofactor = cofactors(f);  // of which the first row is used
  result.d =
      dot3(f.m[0][0], f.m[0][1], f.m[0][2], cofactor.m[0][0], cofactor.m[0][1], cofactor.m[0][2]);
  // 4 |cof F|^2 = 2 (|F|^4 - |F F^T|^2)
  const Lanes norm2 = fma(all_lanes(2), products, squares);
  result.c = fma(all_lanes(2), norm2, zero_lanes() - result.a * result.a);
  return result;
}

/// Largest roots of p = l^4 - 2 a l^2 - 8 d l + c: s1 + s2 + s3, the largest trace of R^T F. Newton's
/// iteration from above falls steadily. All packs go together, for a step of one is a long chain. A
/// lane that has arrived stays where it is, whatever its neighbours do; one that does not arrive is
/// NaN.
SOUPLE_KERNEL void largest_roots(const Invariants* invariants, int pack_count, Lanes* root) {
  Lanes moves[tile_packs];
  for (int pack = 0; pack < pack_count; ++pack) {
    root[pack] = _mm256_sqrt_pd(all_lanes(3) * invariants[pack].a);
    moves[pack] = _mm256_castsi256_pd(_mm256_set1_epi64x(-1));
  }
  int is_moving = 1;
  for (int iteration = 0; iteration < newton_limit && is_moving; ++iteration) {
    is_moving = 0;
    for (int pack = 0; pack < pack_count; ++pack) {
      const Lanes a = invariants[pack].a, d = invariants[pack].d, c = invariants[pack].c;
      const Lanes l = root[pack], square = l * l, minus_4d = all_lanes(-4) * d;
      const Lanes below = square - a;
      const Lanes value = fma(fma(below - a, l, minus_4d + minus_4d), l, c);
      const Lanes half_slope = fma(l + l, below, minus_4d);
      const Lanes change = value / (half_slope + half_slope);
      root[pack] = l - _mm256_and_pd(change, moves[pack]);
      // The next change would be the square of this one.
      const Lanes is_large = _mm256_cmp_pd(change, all_lanes(1e-9) * l, _CMP_GT_OQ);
      moves[pack] = _mm256_and_pd(moves[pack], is_large);
      is_moving |= _mm256_movemask_pd(moves[pack]);
    }
  }
  for (int pack = 0; pack < pack_count; ++pack) root[pack] = _mm256_or_pd(root[pack], moves[pack]);
}

}  // namespace rotation_lanes

namespace rotation_lanes {

// The rotation that maximises tr(R^T F) (Wahba's problem), in the closed form of FOAM (Markley 1993):
// R = ((k + |F|^2) F + l cof F - F F^T F) / z with l the largest trace, k = (l^2 - |F|^2) / 2 and
// z = k l - det F = (s1 + s2)(s2 + s3)(s3 + s1); s3 has the sign of det F, so that inverted elements
// flip their least stretched direction.
SOUPLE_KERNEL LaneRotations polar(const LaneMat3& f, const Invariants& invariants, Lanes trace) {
  const Lanes* s = invariants.left;
  const LaneMat3 left = {{{s[0], s[3], s[5]}, {s[3], s[1], s[4]}, {s[5], s[4], s[2]}}};
  const LaneMat3 cofactor = cofactors(f), cube = product(left, f);
  const Lanes k = all_lanes(0.5) * fma(trace, trace, zero_lanes() - invariants.a);
  const Lanes slope = fma(k, trace, zero_lanes() - invariants.d);
  const Lanes inverse = all_lanes(1) / slope;
  const Lanes of_f = (k + invariants.a) * inverse, of_cofactor = trace * inverse;
  LaneRotations result;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      result.matrices.m[i][j] =
          fma(of_f, f.m[i][j], fnma(inverse, cube.m[i][j], of_cofactor * cofactor.m[i][j]));
  // Ordered comparisons: lanes that are not finite, or where squares overflow, are not good.
  const Lanes bound = all_lanes(least_relative_slope) * trace * trace * trace;
  const Lanes is_good = _mm256_and_pd(_mm256_cmp_pd(slope, bound, _CMP_GT_OQ),
                                      _mm256_cmp_pd(bound, all_lanes(1e-200), _CMP_GT_OQ));
  const Lanes is_finite = _mm256_cmp_pd(invariants.a * invariants.a, all_lanes(1e200), _CMP_LT_OQ);
  result.is_good = _mm256_movemask_pd(_mm256_and_pd(is_good, is_finite));
  return result;
}

struct LaneVec3 {
  Lanes c[3];
};

SOUPLE_KERNEL Lanes dot(const LaneVec3& a, const LaneVec3& b) {
  return dot3(a.c[0], a.c[1], a.c[2], b.c[0], b.c[1], b.c[2]);
}

SOUPLE_KERNEL void scale(LaneVec3& v, Lanes factor) {
  for (Lanes& component : v.c) component = factor * component;
}

/// v0 and v1 made orthonormal, v2 their cross product; bits of the lanes where that is well defined.
SOUPLE_KERNEL int orthonormalise(LaneVec3& v0, LaneVec3& v1, LaneVec3& v2) {
  const Lanes length0 = dot(v0, v0), length1 = dot(v1, v1);
  scale(v0, all_lanes(1) / _mm256_sqrt_pd(length0));
  const Lanes along = dot(v0, v1);
  for (int k = 0; k < 3; ++k) v1.c[k] = fnma(along, v0.c[k], v1.c[k]);
  const Lanes rest = dot(v1, v1);
  scale(v1, all_lanes(1) / _mm256_sqrt_pd(rest));
  for (int k = 0; k < 3; ++k) {
    const int k1 = (k + 1) % 3, k2 = (k + 2) % 3;
    v2.c[k] = fnma(v0.c[k2], v1.c[k1], v0.c[k1] * v1.c[k2]);
  }
  const Lanes larger = _mm256_max_pd(length0, length1);
  const Lanes least = _mm256_min_pd(length0, rest);
  const Lanes bound = all_lanes(least_relative_remainder) * larger;
  const Lanes is_good = _mm256_and_pd(_mm256_cmp_pd(least, bound, _CMP_GT_OQ),
                                      _mm256_cmp_pd(larger, all_lanes(1e200), _CMP_LT_OQ));
  return _mm256_movemask_pd(
      _mm256_and_pd(is_good, _mm256_cmp_pd(larger, all_lanes(1e-200), _CMP_GT_OQ)));
}

/// Columns of F made orthonormal (QR), or its rows (Gram-Schmidt as in OpenTissue).
template <bool by_columns>
SOUPLE_KERNEL LaneRotations orthonormal(const LaneMat3& f) {
  LaneVec3 line[3];
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) line[i].c[j] = by_columns ? f.m[j][i] : f.m[i][j];
  LaneRotations result;
  result.is_good = orthonormalise(line[0], line[1], line[2]);
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      (by_columns ? result.matrices.m[j][i] : result.matrices.m[i][j]) = line[i].c[j];
  return result;
}

}  // namespace rotation_lanes

/// Rotations of up to tile_packs packs. What a lane holds depends on its own F alone.
template <RotationMethod method>
SOUPLE_KERNEL void rotations_of(const LaneMat3* f, int pack_count, LaneRotations* out) {
  using namespace rotation_lanes;
  if constexpr (method == RotationMethod::polar) {
    Invariants invariants[tile_packs];
    Lanes root[tile_packs];
    for (int pack = 0; pack < pack_count; ++pack) invariants[pack] = invariants_of(f[pack]);
    largest_roots(invariants, pack_count, root);
    for (int pack = 0; pack < pack_count; ++pack)
      out[pack] = polar(f[pack], invariants[pack], root[pack]);
  } else {
    for (int pack = 0; pack < pack_count; ++pack)
      out[pack] = orthonormal<method == RotationMethod::qr>(f[pack]);
  }
}

/// Rotations of the first `count` lanes, those that are not good by polar_rotation.
void store_hard_rotations(const LaneMat3& f, const LaneRotations& found, Index count, Mat3* rotations);

/// Into memory, the first `count` lanes.
SOUPLE_KERNEL void store_rotations(const LaneMat3& f, const LaneRotations& found, Index count,
                                   Mat3* rotations) {
  if (found.is_good == 15 && count == lane_count)
    store_matrices(found.matrices, rotations);
  else
    store_hard_rotations(f, found, count, rotations);
}

}  // namespace souple
