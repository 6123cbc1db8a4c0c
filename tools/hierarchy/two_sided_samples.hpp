// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <vector>

#include "formats/core/mesh.hpp"
#include "tools/hierarchy/level_surface.hpp"
#include "tools/hierarchy/target_surface.hpp"

namespace souple {

/// A point of the level's surface, sum of weights[k] times the vertices of `triangle`, and the point of
/// the target that it is to come to.
struct SurfaceSample {
  Index triangle = 0;  ///< of the level's surface
  std::array<double, 3> weights{};
  Point goal{};     ///< m
  Point normal{};   ///< of the target there; zero if unknown
  double area = 0;  ///< that it stands for, over the whole area of the side it comes from
};

/// The vertices, middles of sides and barycentres of the level's surface with their closest points on
/// the target; empty if that has none.
std::vector<SurfaceSample> samples_forth(const LevelSurface& surface,
                                         const std::vector<Point>& positions,
                                         const TargetSurface& target);

/// Points of the target, half an edge of the level apart or closer, with their closest points on the
/// level's surface.
std::vector<SurfaceSample> samples_back(const LevelSurface& surface,
                                        const std::vector<Point>& positions,
                                        const TargetSurface& target);

}  // namespace souple
