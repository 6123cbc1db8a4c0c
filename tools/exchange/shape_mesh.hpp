// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "formats/core/mesh.hpp"
#include "runtime/world/settings.hpp"

namespace souple {

/// A rigid shape as triangles, wound outward, so that a viewer can show it. A plane becomes a square
/// of side `plane_size_m` around its origin; a mesh, which has triangles already, gives none.
TriangleMesh triangulate_shape(const RigidShape& shape, const Pose& pose, double plane_size_m);

/// x_world = rotation x_local + translation.
Point place(const Pose& pose, const Point& local);

}  // namespace souple
