// SPDX-License-Identifier: MIT
#pragma once
#include <span>

#include "runtime/fem/linear_algebra.hpp"
#include "runtime/world/settings.hpp"

namespace souple {

/// Of a solid of density 1 kg/m3, in its own frame.
struct MassProperties {
  double volume = 0;            ///< m3
  Vec3 centre = Vec3::Zero();   ///< of mass, m
  Mat3 inertia = Mat3::Zero();  ///< about the centre, in the axes of the frame, kg m2 at 1 kg/m3
};

/// Sphere, capsule, box and mesh, filled evenly. A plane has no volume: all zero.
MassProperties mass_properties(const RigidShape& shape);

/// Of the inside of a closed, outward-wound surface, by the divergence theorem: signed tets from a
/// point near the surface (Tonon 2004).
MassProperties mass_properties(std::span<const Point> vertices, std::span<const Triangle> triangles);

}  // namespace souple
