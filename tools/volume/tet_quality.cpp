// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <numbers>

#include "tools/geometry/vector.hpp"
#include "tools/volume/tetrahedralize.hpp"

namespace souple {
namespace {

using Corners = std::array<Point, 4>;

/// Area vectors of the faces, outward for a positive tet; face k is opposite corner k.
Corners face_areas(const Corners& x) {
  const auto area = [&](std::size_t a, std::size_t b, std::size_t c) {
    return scaled(cross(subtract(x[b], x[a]), subtract(x[c], x[a])), 0.5);
  };
  return {area(1, 2, 3), area(0, 3, 2), area(0, 1, 3), area(0, 2, 1)};
}

double smallest_dihedral_deg(const Corners& x, double volume6) {
  if (volume6 <= 0) return 0;
  const Corners area = face_areas(x);
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
double radius_ratio(const Corners& x, double volume6) {
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

}  // namespace

TetQuality measure_tet_quality(const TetMesh& mesh) {
  TetQuality quality;
  if (mesh.tets.empty()) return quality;
  std::vector<double> angles;
  angles.reserve(mesh.tets.size());
  quality.worst_radius_ratio = 1;
  for (const Tet& tet : mesh.tets) {
    Corners x;
    std::ranges::transform(tet, x.begin(),
                           [&](Index i) { return mesh.nodes[static_cast<std::size_t>(i)]; });
    const double volume6 = signed_volume6(x[0], x[1], x[2], x[3]);
    quality.volume_m3 += volume6 / 6;
    quality.worst_radius_ratio = std::min(quality.worst_radius_ratio, radius_ratio(x, volume6));
    angles.push_back(smallest_dihedral_deg(x, volume6));
  }
  quality.min_dihedral_deg = std::ranges::min(angles);
  const auto middle = angles.begin() + static_cast<std::ptrdiff_t>(angles.size() / 2);
  std::ranges::nth_element(angles, middle);
  quality.median_dihedral_deg = *middle;
  return quality;
}

}  // namespace souple
