// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <limits>
#include <optional>

#include "runtime/collision/rigid_distance.hpp"
#include "runtime/collision/surface_tree.hpp"

namespace souple {

struct Ray {
  Vec3 origin = Vec3::Zero();
  Vec3 direction = Vec3::UnitZ();  ///< unit
  double length = std::numeric_limits<double>::infinity();
};

struct RayHit {
  double distance = 0;             ///< along the ray, m
  Index triangle = -1;             ///< of the surface; -1: an analytic shape
  std::array<double, 3> weight{};  ///< barycentric in that triangle
  Vec3 normal = Vec3::UnitZ();     ///< outward, unit
};

/// The first triangle of a refitted surface that the ray meets, from either side; ties to the lower
/// triangle.
std::optional<RayHit> pick(const DeformedSurface& surface, const Ray& ray);

/// The first point of an analytic shape's surface that the ray meets; from inside, where it leaves. A
/// mesh has none here.
std::optional<RayHit> pick(const RigidShape& shape, const RigidPlacement& at, const Ray& ray);

}  // namespace souple
