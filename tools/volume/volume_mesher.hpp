// SPDX-License-Identifier: GPL-3.0-or-later
// The only door to CGAL's Mesh_3: plain structs in and out, no exception passes.
#pragma once
#include <cstddef>
#include <memory>
#include <vector>

#include "formats/core/mesh.hpp"
#include "formats/core/result.hpp"

namespace souple {

/// Lengths in units of the surface that is meshed.
struct MesherSizes {
  double cell_radius = 0;   ///< largest circumradius of a tet
  double facet_radius = 0;  ///< largest surface-Delaunay-ball radius of a boundary triangle
  double facet_distance =
      0;  ///< largest distance of a boundary triangle's circumcentre from its ball's
};

/// One surface, meshed as often as the caller wants. Deterministic, bounded by counts, never by time.
class VolumeMesher {
 public:
  /// `surface`: closed, oriented, triangles not degenerate, about unit size. `seeds`: points on it from
  /// which the refinement starts; every shell needs some.
  VolumeMesher(const TriangleMesh& surface, const std::vector<Point>& seeds);
  ~VolumeMesher();
  VolumeMesher(const VolumeMesher&) = delete;
  VolumeMesher& operator=(const VolumeMesher&) = delete;

  /// Delaunay refinement from the start; returns the number of tets.
  Result<std::size_t> refine(const MesherSizes& sizes, std::size_t most_vertices);
  /// Perturbs and exudes the slivers of the last refinement and hands the tets over, in no order.
  Result<TetMesh> optimise();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace souple
