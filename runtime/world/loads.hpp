// SPDX-License-Identifier: MIT
// Forces from outside on a soft body, as the application describes them. SI units.
#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "formats/core/mesh.hpp"

namespace souple {

enum class LoadKind : std::uint8_t {
  node_force,   ///< N, in all, shared equally by `nodes`
  point_force,  ///< N, at a barycentric point of a boundary triangle
  traction,     ///< Pa, on the rest area of `triangles`
  pressure,     ///< Pa, on `triangles`, > 0 pushes inwards
};

/// Between two of them a load is linear in time, before the first and after the last it is held.
struct LoadKeyframe {
  double time_s = 0;
  Point vector{};          ///< N or Pa; not of a pressure
  double pressure_pa = 0;  ///< of a pressure only
};

struct LoadDescription {
  std::string name;
  LoadKind kind = LoadKind::node_force;
  /// A dead load keeps its direction in the world; a pressure that is dead keeps the normals and areas
  /// of the body as it was added. A vector that follows is given in the rest frame and turns with the
  /// rotation of every node; a pressure that follows is normal to the present surface, on its present
  /// area. Directions are those at the start of a step: the tangent has no part of them.
  bool follows = false;
  std::vector<Index> nodes;
  Index triangle = -1;             ///< of a point force: place in the asset's boundary
  std::array<double, 3> weight{};  ///< of its corners, sum 1
  std::vector<Index> triangles;    ///< places in the asset's boundary; empty: all of it
  std::vector<LoadKeyframe> course;
};

struct LoadId {
  std::uint32_t body = 0;   ///< index of its BodyId
  std::uint32_t index = 0;  ///< within the body
};

}  // namespace souple
