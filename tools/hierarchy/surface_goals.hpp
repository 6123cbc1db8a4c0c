// SPDX-License-Identifier: GPL-3.0-or-later
// Where the vertices of a level's surface ought to be: the fit rules.
#pragma once
#include <vector>

#include "formats/core/mesh.hpp"
#include "tools/hierarchy/level_surface.hpp"
#include "tools/hierarchy/shape_optimizer.hpp"
#include "tools/hierarchy/target_surface.hpp"

namespace souple {

/// METHOD 3.2, Alg. 10: the barycentre of the closest points on the 3 nearest triangles.
std::vector<Point> nearest_three_goals(const std::vector<Point>& positions,
                                       const TargetSurface& target);

/// METHOD 3.2 after Winkler: the two-sided distance to fixed closest points, with mean-value smoothing.
/// These are looked up again `lookups` times.
std::vector<Point> least_squares_goals(const LevelSurface& surface, const std::vector<Point>& positions,
                                       const TargetSurface& target, int lookups);

/// The closest point of the target that faces the same way.
std::vector<Point> projection_goals(const LevelSurface& surface, const std::vector<Point>& positions,
                                    const TargetSurface& target);

struct BalancedGoals {
  std::vector<Point> places;  ///< m
  /// Sum of m m^T over the samples that pull at a vertex, m the target's normals there, of unit size:
  /// on a smooth place a projector on the normal, on a ridge it holds two directions, at a corner all.
  std::vector<Symmetric> metrics;
  /// 1, up to 6 beside samples far farther off than most: how hard a vertex is to be drawn.
  std::vector<double> urgency;
};

/// Moves that make the two-sided distance least, each measured across the target's planes: vertices go
/// onto its ridges, and outside of where it is convex, by about half the height of an arc, since chords
/// lie inside. Start from projected positions. `anchoring` (> 0) holds vertices where they are, most of
/// all along the surface, where the samples leave them free: the planes are true only nearby.
BalancedGoals balanced_goals(const LevelSurface& surface, const std::vector<Point>& positions,
                             const TargetSurface& target, double anchoring);

}  // namespace souple
