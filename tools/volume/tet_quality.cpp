// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <vector>

#include "tools/volume/tet_shape.hpp"
#include "tools/volume/tetrahedralize.hpp"

namespace souple {

TetQuality measure_tet_quality(const TetMesh& mesh) {
  TetQuality quality;
  if (mesh.tets.empty()) return quality;
  std::vector<double> angles;
  angles.reserve(mesh.tets.size());
  quality.worst_radius_ratio = 1;
  for (const Tet& tet : mesh.tets) {
    const TetCorners x = corners_of(mesh, tet);
    quality.volume_m3 += signed_volume6(x[0], x[1], x[2], x[3]) / 6;
    quality.worst_radius_ratio = std::min(quality.worst_radius_ratio, radius_ratio(x));
    quality.worst_aspect = std::max(quality.worst_aspect, aspect(x));
    angles.push_back(smallest_dihedral_deg(x));
  }
  quality.min_dihedral_deg = std::ranges::min(angles);
  const auto middle = angles.begin() + static_cast<std::ptrdiff_t>(angles.size() / 2);
  std::ranges::nth_element(angles, middle);
  quality.median_dihedral_deg = *middle;
  return quality;
}

}  // namespace souple
