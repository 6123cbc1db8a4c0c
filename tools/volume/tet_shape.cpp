// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/volume/tet_shape.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "tools/geometry/vector.hpp"

namespace souple {
namespace {

/// Area vectors of the faces, outward for a positive tet; face k is opposite corner k.
TetCorners face_areas(const TetCorners& x) {
  const auto area = [&](std::size_t a, std::size_t b, std::size_t c) {
    return scaled(cross(subtract(x[b], x[a]), subtract(x[c], x[a])), 0.5);
  };
  return {area(1, 2, 3), area(0, 3, 2), area(0, 1, 3), area(0, 2, 1)};
}

}  // namespace

double smallest_dihedral_deg(const TetCorners& x) {
  const double volume6 = signed_volume6(x[0], x[1], x[2], x[3]);
  if (volume6 <= 0) return 0;
  const TetCorners area = face_areas(x);
  double largest_cosine = -1;
  for (std::size_t i = 0; i < 4; ++i)
    for (std::size_t j = i + 1; j < 4; ++j) {
      const double lengths = norm(area[i]) * norm(area[j]);
      if (lengths <= 0) return 0;
      largest_cosine = std::max(largest_cosine, -dot(area[i], area[j]) / lengths);
    }
  return std::acos(std::clamp(largest_cosine, -1.0, 1.0)) * 180 / std::numbers::pi;
}

/// 3 r_in / r_circ with r_in = 3 V / A and r_circ = sqrt of Heron's (p, q, r the products of opposite
/// edges' lengths) / (24 V).
double radius_ratio(const TetCorners& x) {
  const double volume6 = signed_volume6(x[0], x[1], x[2], x[3]);
  if (volume6 <= 0) return 0;
  double faces = 0;
  for (const Point& a : face_areas(x)) faces += norm(a);
  const auto length = [&](std::size_t a, std::size_t b) { return norm(subtract(x[a], x[b])); };
  const double p = length(0, 1) * length(2, 3), q = length(0, 2) * length(1, 3);
  const double r = length(0, 3) * length(1, 2);
  const double heron = (p + q + r) * (p + q - r) * (p - q + r) * (-p + q + r);
  if (faces <= 0 || heron <= 0) return 0;
  const double volume = volume6 / 6;
  return std::min(1.0, 3 * (3 * volume / faces) / (std::sqrt(heron) / (24 * volume)));
}

double aspect(const TetCorners& x) {
  const double volume6 = signed_volume6(x[0], x[1], x[2], x[3]);
  double longest = 0, largest_face = 0;
  for (const Point& a : face_areas(x)) largest_face = std::max(largest_face, norm(a));
  for (std::size_t a = 0; a < 4; ++a)
    for (std::size_t b = a + 1; b < 4; ++b) longest = std::max(longest, norm(subtract(x[a], x[b])));
  const double height = volume6 / (2 * largest_face);
  if (!(height > 0)) return std::numeric_limits<double>::max();
  return longest / height / std::sqrt(1.5);
}

}  // namespace souple
