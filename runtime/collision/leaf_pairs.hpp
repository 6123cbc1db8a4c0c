// SPDX-License-Identifier: MIT
// Which leaves of two trees come near each other.
#pragma once
#include <immintrin.h>

#include "runtime/collision/proximity_arrays.hpp"

namespace souple {

/// Squared distance of two boxes, rounded down by less than the margin of `box_radius`.
inline float squared_distance(const FloatBox& a, const FloatBox& b) {
  const __m128 beyond =
      _mm_max_ps(_mm_max_ps(_mm_sub_ps(_mm_load_ps(a.low.data()), _mm_load_ps(b.high.data())),
                            _mm_sub_ps(_mm_load_ps(b.low.data()), _mm_load_ps(a.high.data()))),
                 _mm_setzero_ps());
  return _mm_cvtss_f32(_mm_dp_ps(beyond, beyond, 0x71));
}

/// The square to compare with it, for pairs of boxes whose contents may come within `distance`.
inline float box_radius(double distance) { return float(distance * distance * (1 + 1e-5)) + 1e-37F; }

/// Pairs of leaves (tree nodes of `a` and of `b`) whose boxes come within `distance`.
void find_leaf_pairs(const SurfaceTree& a, std::span<const FloatBox> boxes_a, const SurfaceTree& b,
                     std::span<const FloatBox> boxes_b, double distance, ProximityWork::Arrays& work);

/// Pairs of leaves of one surface, each unordered pair and each leaf with itself once, that come within
/// `distance` and of which some normals differ enough to face each other (cosine below 0.3).
void find_self_leaf_pairs(const DeformedSurface& surface, double distance, ProximityWork::Arrays& work);

}  // namespace souple
