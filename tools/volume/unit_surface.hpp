// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "formats/core/mesh.hpp"
#include "formats/core/result.hpp"
#include "tools/geometry/unit_frame.hpp"

namespace souple {

/// A surface brought to unit size, its middle at the origin.
struct UnitSurface {
  TriangleMesh mesh;  ///< triangles of zero area left out
  UnitFrame frame;
};

/// The axes are the principal ones of the surface's area, where these are distinct (else those of the
/// input), and coordinates are rounded to 2^-20 of the longest side (0.2 um on a body of 0.2 m): the
/// rounding of other units, another place or another attitude vanishes in it, so that the same shape
/// gives the same mesh. Refuses what is not a closed, oriented, manifold surface with a positive
/// volume.
Result<UnitSurface> to_unit_surface(const TriangleMesh& surface);

}  // namespace souple
