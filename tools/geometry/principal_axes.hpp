// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>

#include "formats/core/mesh.hpp"

namespace souple {

/// The principal axes of the surface's area, longest first, right-handed, each pointing where the
/// surface has its longer tail; x, y, z where the moments are not distinct. `middle` and `unit` (both
/// m) only scale the sums.
std::array<Point, 3> principal_axes(const TriangleMesh& mesh, const Point& middle, double unit);

}  // namespace souple
