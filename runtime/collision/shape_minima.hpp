// SPDX-License-Identifier: MIT
// Local minima of distance that involve analytic shapes.
#pragma once
#include <vector>

#include "runtime/collision/local_minima.hpp"
#include "runtime/collision/rigid_distance.hpp"

namespace souple {

/// Appends pairs of a refitted surface (A) and an analytic shape (B: plane, sphere, capsule or box;
/// a mesh gives none) with a gap below `alarm_distance`, ascending by (feature_a, feature_b):
/// every vertex of the surface by its signed distance, and where the shape touches deeper inside an
/// edge or a face than at its ends, by more than a quarter of the longest edge there (a box: by a
/// thousandth), that point: a small sphere or a corner of a box does not sink into a large triangle.
/// feature_b: 0 for the vertices; then which sphere end, corner or edge of the shape it is.
void find_shape_minima(const DeformedSurface& surface, const RigidShape& shape,
                       const RigidPlacement& at, double alarm_distance, ProximityWork& work,
                       std::vector<LocalMinimum>& out);

/// Appends the contacts of two analytic shapes with a gap below `alarm_distance`: enough of them to
/// carry a moment. Sphere with anything 1; capsule with plane or box up to 2, with a capsule 1, 2 if
/// parallel, 3 if nearly so; box with plane up to 8 corners, box with box corners both ways and
/// crossing edges, which is the clipped face. Both points have count 0. Features persist from step to
/// step. Two planes: none; a mesh: none.
void find_rigid_minima(const RigidShape& a, const RigidPlacement& at_a, const RigidShape& b,
                       const RigidPlacement& at_b, double alarm_distance,
                       std::vector<LocalMinimum>& out);

/// The box around a shape at its place; a plane's is the half-space (infinite where it must be).
Eigen::AlignedBox3d shape_bounds(const RigidShape& shape, const RigidPlacement& at);

}  // namespace souple
