// SPDX-License-Identifier: MIT
#pragma once
#include <vector>

#include "runtime/contact/contact.hpp"
#include "runtime/world/bodies.hpp"

namespace souple {

/// A rigid body during one step.
struct RigidStep {
  const RigidBody* body = nullptr;
  RigidPlacement start, end;

  /// Motion of the body's material point that is at `point` at the start.
  Vec3 motion_of(const Vec3& point) const;
};

struct PairSettings {
  double alarm_distance_m = 0;
  double friction = 0;
};

/// Appends a contact for every movable surface node of `soft` closer than the alarm distance to the
/// rigid body. Contacts ascend by key.
void detect_soft_rigid(std::uint32_t soft_index, const SoftBody& soft, std::uint32_t rigid_index,
                       const RigidStep& rigid, const PairSettings& settings,
                       std::vector<Contact>& contacts);

/// Appends a contact for every surface node of `a` and its nearest triangle of `b`, if closer than the
/// alarm distance; both surfaces have been refitted. Nodes inside `b` are found to a depth of 5 % of
/// its longest side.
void detect_soft_soft(std::uint32_t a_index, const SoftBody& a, std::uint32_t b_index,
                      const SoftBody& b, const PairSettings& settings, std::vector<Contact>& contacts);

/// How deep the deformed surface of `soft` enters a rigid body, m, >= 0: exact for planes and spheres,
/// sampled on a grid of 10 divisions of each triangle for boxes.
double surface_depth(const SoftBody& soft, const RigidShape& shape, const RigidPlacement& at);
/// The same at surface nodes only.
double node_depth(const SoftBody& soft, const RigidShape& shape, const RigidPlacement& at);

}  // namespace souple
