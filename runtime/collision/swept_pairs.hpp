// SPDX-License-Identifier: MIT
// Pairs that are apart at the start of a step and would meet in it: thin parts and fast motion. Every
// point moves on a straight line from start to end.
#pragma once
#include <limits>
#include <optional>
#include <vector>

#include "runtime/collision/local_minima.hpp"
#include "runtime/collision/rigid_distance.hpp"

namespace souple {

/// A pair, as it is at the start: its normal is that of the meeting where this has the two sides apart
/// at the start, else the direction between the points at the start. gap > 0.
struct SweptPair {
  LocalMinimum minimum;
  double time = 0;  ///< of the meeting, as a fraction of the step, 0 to 1
  /// How far a vertex is behind the plane of the face, or inside the shape, at the end, m; infinite
  /// where that was not looked at: edges, two shapes.
  double end_depth = std::numeric_limits<double>::infinity();
};

/// Appends vertex-face and edge-edge pairs of two surfaces, refitted at the start, that meet before the
/// end positions `xa_end`, `xb_end` and are farther apart than `alarm_distance` at the start. Only the
/// earliest meeting of each vertex, and of each edge of A. By conservative advancement (additive, Li et
/// al. 2021), which cannot miss: what comes closer than 1e-4 of its distance at the start counts as
/// meeting. Ascending by features.
void find_swept_pairs(const DeformedSurface& a, const Eigen::VectorXd& xa_end, const DeformedSurface& b,
                      const Eigen::VectorXd& xb_end, double alarm_distance, ProximityWork& work,
                      std::vector<SweptPair>& out);

/// The same for a surface (A) and an analytic shape (B) that moves from `start` to `end`: vertices
/// against the shape, and the shape's own ends (centre, ends of the capsule, corners of the box)
/// against faces. feature_b as in find_shape_minima. In the frame of the shape.
void find_swept_shape(const DeformedSurface& surface, const Eigen::VectorXd& x_end,
                      const RigidShape& shape, const RigidPlacement& start, const RigidPlacement& end,
                      double alarm_distance, ProximityWork& work, std::vector<SweptPair>& out);

/// The meeting of two analytic shapes that are farther apart than `alarm_distance` at the start.
std::optional<SweptPair> find_swept_shapes(const RigidShape& a, const RigidPlacement& a_start,
                                           const RigidPlacement& a_end, const RigidShape& b,
                                           const RigidPlacement& b_start, const RigidPlacement& b_end,
                                           double alarm_distance, ProximityWork& work);

}  // namespace souple
