// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "formats/core/mesh.hpp"
#include "formats/core/result.hpp"

namespace souple {

/// A surface brought to unit size: x = origin + length_m * vertex.
struct UnitSurface {
  TriangleMesh mesh;    ///< triangles of zero area left out
  Point origin{};       ///< m, middle of the bounding box
  double length_m = 1;  ///< longest side of the bounding box
};

/// Coordinates are rounded to 2^-26 of the longest side (3 nm on a body of 0.2 m): the rounding of
/// other units or another origin vanishes in it, so that the same shape gives the same mesh in mm and
/// in m. Refuses what is not a closed, oriented, manifold surface with a positive volume.
Result<UnitSurface> to_unit_surface(const TriangleMesh& surface);

}  // namespace souple
