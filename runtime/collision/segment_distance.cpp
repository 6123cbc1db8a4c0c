// SPDX-License-Identifier: MIT
#include "runtime/collision/segment_distance.hpp"

#include <algorithm>

namespace souple {

SegmentPair closest_of_segments(const Vec3& a_from, const Vec3& a_to, const Vec3& b_from,
                                const Vec3& b_to) {
  const Vec3 u = a_to - a_from, v = b_to - b_from, w = a_from - b_from;
  const double uu = u.squaredNorm(), vv = v.squaredNorm(), uv = u.dot(v), uw = u.dot(w), vw = v.dot(w);
  const double determinant = uu * vv - uv * uv;
  SegmentPair pair;
  if (determinant > 1e-14 * uu * vv)
    pair.along_a = std::clamp((uv * vw - vv * uw) / determinant, 0.0, 1.0);
  const double along_b = vv > 0 ? (uv * pair.along_a + vw) / vv : 0;
  pair.along_b = std::clamp(along_b, 0.0, 1.0);
  if (along_b != pair.along_b || vv == 0)
    pair.along_a = uu > 0 ? std::clamp((uv * pair.along_b - uw) / uu, 0.0, 1.0) : 0;
  pair.a = a_from + pair.along_a * u;
  pair.b = b_from + pair.along_b * v;
  return pair;
}

}  // namespace souple
