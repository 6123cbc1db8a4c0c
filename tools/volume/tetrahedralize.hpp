// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstddef>
#include <string>
#include <variant>
#include <vector>

#include "formats/core/mesh.hpp"
#include "formats/core/result.hpp"

namespace souple {

/// Where a size of its own holds, in metres and in the frame of the surface.
struct BoxRegion {
  Point low{}, high{};
};
struct BallRegion {
  Point centre{};
  double radius_m = 0;
};
/// All points within `distance_m` of a piece of surface, which may be open.
struct PatchRegion {
  TriangleMesh patch;
  double distance_m = 0;
};

struct LocalSize {
  double edge_length_m = 0;  ///< inside; from there the size grows smoothly to what holds elsewhere
  std::variant<BoxRegion, BallRegion, PatchRegion> region;
};

enum class FeatureMode {
  automatic,  ///< protect sharp edges where the statistics of the dihedral angles show a machine part
  keep,
  ignore,
};

enum class MesherKind {
  automatic,  ///< Delaunay, and the lattice where it fails
  delaunay,   ///< CGAL Mesh_3
  lattice,    ///< isosurface stuffing: never fails, coarse
};

struct TetrahedralizeOptions {
  std::size_t target_tet_count = 10000;  ///< used when edge_length_m and max_error_m are 0
  double edge_length_m = 0;              ///< > 0: edge length instead of a count
  double max_error_m = 0;  ///< > 0: boundary within this distance of the surface, whatever the count
  double interior_coarsening = 1;  ///< >= 1: edge deep inside over edge at the surface, graded smoothly
  FeatureMode features = FeatureMode::automatic;
  MesherKind mesher = MesherKind::automatic;
  std::vector<LocalSize> local_sizes;
};

struct TetQuality {
  double min_dihedral_deg = 0;
  double median_dihedral_deg = 0;  ///< median over tets of the smallest dihedral angle
  double worst_radius_ratio = 0;   ///< 3 r_in / r_circ: 1 for the regular tet, 0 for a flat one
  double worst_aspect = 0;         ///< longest edge over least height, over that of the regular tet
  double volume_m3 = 0;
};

TetQuality measure_tet_quality(const TetMesh& mesh);

/// The decision on sharp edges and the statistics behind it.
struct FeatureReport {
  std::size_t sharp_edge_count = 0;  ///< dihedral angle off flat by more than the threshold
  double sharp_length_share = 0;     ///< of the length of all edges
  bool kept = false;
  std::string reason;
};

struct TetrahedralizeReport {
  std::size_t node_count = 0;
  std::size_t tet_count = 0;
  int attempts = 0;  ///< runs of the mesher until the count was near the target
  TetQuality quality;
  MesherKind mesher = MesherKind::delaunay;  ///< the one that made the mesh
  FeatureReport features;
  std::vector<std::string> notes;  ///< why the lattice was taken, what was missed
};

struct TetrahedralizedVolume {
  TetMesh mesh;  ///< every tet positively oriented, every node used
  TetrahedralizeReport report;
};

/// Fills a closed oriented surface with tetrahedra (CGAL Mesh_3: Delaunay refinement, then perturb and
/// exude, bounded by iterations so that the result does not depend on load; or a body-centred lattice
/// cut at the surface, Labelle and Shewchuk 2007). The count of tets ends within 15 % of the target
/// where the shape allows it. Deterministic: same input, same bytes; the same shape in other units or
/// elsewhere gives the same connectivity.
Result<TetrahedralizedVolume> tetrahedralize(const TriangleMesh& surface,
                                             const TetrahedralizeOptions& options);

}  // namespace souple
