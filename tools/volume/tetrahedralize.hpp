// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstddef>

#include "formats/core/mesh.hpp"
#include "formats/core/result.hpp"

namespace souple {

struct TetrahedralizeOptions {
  std::size_t target_tet_count = 10000;  ///< used when edge_length_m is 0
  double edge_length_m = 0;              ///< > 0: edge length instead of a count
};

struct TetQuality {
  double min_dihedral_deg = 0;
  double median_dihedral_deg = 0;  ///< median over tets of the smallest dihedral angle
  double worst_radius_ratio = 0;   ///< 3 r_in / r_circ: 1 for the regular tet, 0 for a flat one
  double volume_m3 = 0;
};

TetQuality measure_tet_quality(const TetMesh& mesh);

struct TetrahedralizeReport {
  std::size_t node_count = 0;
  std::size_t tet_count = 0;
  int attempts = 0;  ///< runs of the mesher until the count was near the target
  TetQuality quality;
};

struct TetrahedralizedVolume {
  TetMesh mesh;  ///< every tet positively oriented, every node used
  TetrahedralizeReport report;
};

/// Fills a closed oriented surface with tetrahedra (CGAL Mesh_3: Delaunay refinement, then perturb and
/// exude, bounded by iterations so that the result does not depend on load). The count of tets ends
/// within 15 % of the target where the shape allows it. Deterministic: same input, same bytes.
Result<TetrahedralizedVolume> tetrahedralize(const TriangleMesh& surface,
                                             const TetrahedralizeOptions& options);

}  // namespace souple
