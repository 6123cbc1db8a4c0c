// SPDX-License-Identifier: MIT
// Points that are held together: what joints and grabs are made of. Internal to the world.
#pragma once
#include <cstdint>
#include <optional>
#include <vector>

#include "runtime/collision/rigid_distance.hpp"
#include "runtime/contact/contact.hpp"

namespace souple {

/// A point of a body: of nodes of a soft body, of a rigid body, or of a handle.
struct PinPoint {
  ContactSide side;           ///< body, nodes and weights
  Vec3 local = Vec3::Zero();  ///< in the frame of a rigid body's shape, or of a handle
};

struct Pin {
  Index serial = 0;  ///< of its key: -2 - serial
  PinPoint a, b;
  std::uint32_t joint = none, grab = none;
  static constexpr std::uint32_t none = ~std::uint32_t{0};
};

struct Handle {
  RigidPlacement now, next;
  bool is_held = false;
};

struct Pins {
  std::vector<Pin> all;
  std::vector<Handle> handles;  ///< by grab
  std::uint32_t joint_count = 0;
  Index serial_count = 0;
};

}  // namespace souple
