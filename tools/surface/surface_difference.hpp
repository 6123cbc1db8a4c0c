// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "formats/core/mesh.hpp"
#include "tools/geometry/triangle_bvh.hpp"

namespace souple {

/// Largest distance between the triangles that only one of the surfaces has and the other surface.
double distance_where_different(const TriangleMesh& a, const TriangleMesh& b);

/// Share of the area of `surface` that lies within `distance` of `base`.
double share_of_area_near(const TriangleMesh& surface, const TriangleBvh& base, double distance,
                          double spacing);

}  // namespace souple
