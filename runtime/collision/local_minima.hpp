// SPDX-License-Identifier: MIT
// Local Minimal Distances (METHOD 4, Detection; Johnson and Cohen 2001) between deforming surfaces.
#pragma once
#include <array>
#include <vector>

#include "runtime/collision/proximity_work.hpp"
#include "runtime/collision/surface_tree.hpp"

namespace souple {

/// A material point of a surface: 1 a vertex, 2 on an edge, 3 on a face; 0: of an analytic shape.
struct SurfacePoint {
  int count = 0;
  std::array<Index, 3> node{};  ///< of the body's mesh
  std::array<double, 3> weight{};
};

/// A pair of points at which the distance of two surfaces has a local minimum.
struct LocalMinimum {
  SurfacePoint a, b;
  /// Which feature holds each point: vertex k of SurfaceTree::nodes(), then edges, then triangles, as
  /// SurfaceTree::{vertex,edge,face}_feature number them; of analytic shapes small numbers. The same
  /// from step to step, so contacts are matched by them.
  Index feature_a = 0, feature_b = 0;
  Vec3 normal = Vec3::UnitZ();  ///< unit, from B to A
  Vec3 point_b = Vec3::Zero();  ///< the point of B; that of A is point_b + gap normal
  /// m; < 0 penetrates. Where edges have cut through each other and one of them is flat, greater by 1 %
  /// of that one's length.
  double gap = 0;
};

/// Appends the local minima of distance between two refitted surfaces to `out`, ascending by
/// (feature_a, feature_b):
/// - every vertex of one with each feature of the other at which its distance has a local minimum,
///   if the vertex in turn is (nearly) nearest among its neighbours, or over a face by less than a
///   quarter of `alarm_distance` (beside the face by 2 % of that distance counts as over it);
/// - pairs of convex edges that cross, with the common normal in the cones of both;
/// all with a gap below `alarm_distance`. A vertex inside the other body gives one pair: the nearest
/// place of the surface that faces it, to `inside_reach` deep. Parts whose normals point the same way
/// never meet. Minima of a vertex whose normals are within 15 degrees of a nearer one are left out.
/// Nothing is allocated once `work` and `out` have grown.
void find_local_minima(const DeformedSurface& a, const DeformedSurface& b, double alarm_distance,
                       double inside_reach, ProximityWork& work, std::vector<LocalMinimum>& out);

/// The same for a surface and itself. Features that share a node, and pairs that are within
/// `alarm_distance` of each other in the rest shape, are left out; a penetration is taken for one only
/// to a quarter of the rest distance, since through a thin part every vertex lies behind the far side.
void find_self_minima(const DeformedSurface& surface, double alarm_distance, double inside_reach,
                      ProximityWork& work, std::vector<LocalMinimum>& out);

}  // namespace souple
