// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstddef>
#include <vector>

#include "formats/core/asset.hpp"
#include "formats/core/result.hpp"

namespace souple {

struct NestedHierarchyOptions {
  int level_count = 2;  ///< levels in all, the coarse mesh included; each further level has 8x the tets
  bool fit_surface = true;  ///< move boundary nodes of every finer level to the target surface
};

struct NestedLevelReport {
  std::size_t node_count = 0;
  std::size_t tet_count = 0;
  double min_dihedral_deg = 0;
  double hausdorff_m = 0;     ///< largest distance of a boundary node from the target surface
  double rms_distance_m = 0;  ///< root mean square of the same
  std::size_t held_back_count =
      0;  ///< boundary nodes moved only part of the way, to keep tets positive
};

struct NestedHierarchy {
  std::vector<MeshLevel> levels;  ///< coarsest first
  std::vector<NestedLevelReport> reports;
};

/// Red refinement (1 -> 8, shortest inner diagonal) of `coarse`, `level_count - 1` times; every
/// boundary node of a finer level is moved to the target surface (METHOD 3.2, Alg. 10: the barycentre
/// of its closest points on the 3 nearest triangles), as far as every tet stays positively oriented.
Result<NestedHierarchy> build_nested_hierarchy(const TetMesh& coarse, const TriangleMesh& target,
                                               const NestedHierarchyOptions& options);

}  // namespace souple
