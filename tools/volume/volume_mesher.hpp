// SPDX-License-Identifier: GPL-3.0-or-later
// The only door to CGAL's Mesh_3: plain structs in and out, no exception passes.
#pragma once
#include <cstddef>
#include <functional>
#include <memory>
#include <vector>

#include "formats/core/mesh.hpp"
#include "formats/core/result.hpp"

namespace souple {

/// Lengths in units of the surface that is meshed, at a point of it.
struct MesherSizes {
  using Field = std::function<double(const Point&)>;
  Field cell_radius;     ///< largest circumradius of a tet
  Field facet_radius;    ///< largest surface-Delaunay-ball radius of a boundary triangle
  Field facet_distance;  ///< largest distance of a boundary triangle's circumcentre from its ball's
  Field edge_length;     ///< largest step along a protected sharp edge
};

struct RefinedMesh {
  std::size_t tet_count = 0;
  double mean_edge = 0;  ///< over the six edges of every tet
};

/// What the mesher starts from besides the surface.
struct MesherStart {
  std::vector<Point> seeds;                   ///< on the surface; every shell needs some
  std::vector<std::vector<Point>> polylines;  ///< sharp edges to keep; closed ones end where they began
};

/// One surface, meshed as often as the caller wants. Deterministic, bounded by counts, never by time.
class VolumeMesher {
 public:
  /// `surface`: closed, oriented, triangles not degenerate, about unit size.
  VolumeMesher(const TriangleMesh& surface, const MesherStart& start);
  ~VolumeMesher();
  VolumeMesher(const VolumeMesher&) = delete;
  VolumeMesher& operator=(const VolumeMesher&) = delete;

  /// Delaunay refinement from the start.
  Result<RefinedMesh> refine(const MesherSizes& sizes, std::size_t most_vertices);
  /// Perturbs and exudes the slivers of the last refinement and hands the tets over, in no order.
  Result<TetMesh> optimise();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace souple
