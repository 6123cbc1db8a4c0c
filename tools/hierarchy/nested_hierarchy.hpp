// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstddef>
#include <string_view>
#include <vector>

#include "formats/core/asset.hpp"
#include "formats/core/result.hpp"
#include "tools/geometry/surface_samples.hpp"

namespace souple {

/// Which of the three inner diagonals splits the octahedron in the middle of a refined tet.
enum class DiagonalRule {
  best_quality,  ///< the one whose worst child is best
  shortest,
  fixed,  ///< always between the midpoints of edges (0,3) and (1,2): the thesis
};

/// Where the boundary nodes of a finer level go.
enum class FitRule {
  none,           ///< midpoints stay
  nearest_three,  ///< METHOD 3.2, Alg. 10: closest points on the 3 nearest triangles
  least_squares,  ///< METHOD 3.2, after Winkler: two-sided distance with mean-value smoothing
  projection,     ///< from there, distances across the target's planes made least, quality in balance:
                  ///< what measured best
};

struct NestedHierarchyOptions {
  int level_count = 2;  ///< levels in all, the coarse mesh included; each further level has 8x the tets
  DiagonalRule diagonal = DiagonalRule::best_quality;
  FitRule fit = FitRule::projection;
};

/// Mean-ratio quality of the tets of a level over that of their parents.
struct ChildQuality {
  double share_keeping_70 = 1;  ///< children with at least 0.7 of their parent's quality
  double worst_kept = 1;        ///< least quotient
};

struct LevelReport {
  std::size_t node_count = 0;
  std::size_t tet_count = 0;
  double min_dihedral_deg = 0;
  double worst_radius_ratio = 0;  ///< 3 r_in / r_circ
  double worst_aspect = 0;
  /// Of the boundary (forth) and the target surface (back), m; sampled 1/80 of the longest side apart.
  TwoSidedDistance distance;
  /// Boundary nodes that stay more than 2 % of an edge short of their goal, to keep tets sound.
  std::size_t held_back_count = 0;
  ChildQuality children;  ///< nested levels only
  RigidMotionError rigid_motion_error;
};

struct Hierarchy {
  std::vector<MeshLevel> levels;  ///< coarsest first
  std::vector<LevelReport> reports;
};

/// Red refinement (1 -> 8) of `coarse`, `level_count - 1` times; every boundary node of a finer level
/// is moved to the target surface, kept ones too, inner nodes follow (METHOD 3.2), and every tet stays
/// positively oriented. Under FitRule::none nothing moves. Levels carry the parents, the embedding that
/// corrects the prolongation of moved midpoints, and how well either carries rotations.
Result<Hierarchy> build_nested_hierarchy(const TetMesh& coarse, const TriangleMesh& target,
                                         const NestedHierarchyOptions& options);

}  // namespace souple
