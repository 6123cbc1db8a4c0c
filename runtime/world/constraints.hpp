// SPDX-License-Identifier: MIT
// Joints and grabs: points of bodies that are held together in the contact problem (bilateral rows, see
// ConstraintLaw).
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "formats/core/mesh.hpp"

namespace souple {

struct BodyId {
  std::uint32_t index = 0;
  friend bool operator==(const BodyId&, const BodyId&) = default;
};

enum class JointKind : std::uint8_t {
  ball,   ///< one point stays together
  hinge,  ///< two points on an axis: one rotation is left
  weld,   ///< three points: none is left
};

/// Holds two bodies together where they are when it is made. On a soft body the point is the nearest of
/// its boundary, and must be no farther from it than `reach_m`.
struct JointDescription {
  std::string name;
  BodyId body_a;
  std::optional<BodyId> body_b;  ///< none: the world
  JointKind kind = JointKind::ball;
  Point point_m{};         ///< in world coordinates
  Point axis{0, 0, 1};     ///< of a hinge
  double arm_m = 0.01;     ///< between the points of a hinge or weld
  double reach_m = 0.001;  ///< soft bodies
  bool collide = false;    ///< whether the two bodies still collide
};

struct JointId {
  std::uint32_t index = 0;
};

/// Takes hold of the boundary nodes of a soft body, or of a rigid body's point, near a point of the
/// world. What is held follows the handle rigidly, with the offsets it had when it was grabbed.
struct GrabDescription {
  BodyId body;
  Point point_m{};
  double radius_m = 0;  ///< 0: the nearest node; else every boundary node within, at most `most_nodes`
  int most_nodes = 16;
};

struct GrabId {
  std::uint32_t index = 0;
};

}  // namespace souple
