// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>

#include "formats/core/mesh.hpp"
#include "formats/core/result.hpp"

namespace souple {

/// x = origin + length_m * (u_0 axes[0] + u_1 axes[1] + u_2 axes[2]); the axes are orthonormal and
/// right-handed.
struct PrincipalFrame {
  Point origin{};  ///< m, middle of the bounding box along the axes
  std::array<Point, 3> axes{Point{1, 0, 0}, Point{0, 1, 0}, Point{0, 0, 1}};
  double length_m = 1;  ///< longest side of that box

  Point to_world(const Point& u) const;
  Point to_unit(const Point& x) const;
};

/// A surface brought to unit size, its middle at the origin.
struct UnitSurface {
  TriangleMesh mesh;  ///< triangles of zero area left out
  PrincipalFrame frame;
};

/// The axes are the principal ones of the surface's area, where these are distinct (else those of the
/// input), and coordinates are rounded to 2^-20 of the longest side (0.2 um on a body of 0.2 m): the
/// rounding of other units, another place or another attitude vanishes in it, so that the same shape
/// gives the same mesh. Refuses what is not a closed, oriented, manifold surface with a positive
/// volume.
Result<UnitSurface> to_unit_surface(const TriangleMesh& surface);

}  // namespace souple
