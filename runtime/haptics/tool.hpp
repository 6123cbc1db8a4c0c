// SPDX-License-Identifier: MIT
#pragma once
#include <span>
#include <string>
#include <vector>

#include "formats/core/result.hpp"
#include "runtime/world/tool_problem.hpp"
#include "runtime/world/world.hpp"

namespace souple {

/// A rigid part of a tool. With the tool's opening phi it stands at
/// handle * hinge * rotation(axis, turn_per_opening phi) * mount, which is the frame of its shape.
struct JawDescription {
  RigidShape shape;             ///< anything but a plane
  Pose hinge;                   ///< in the frame of the handle
  Point axis{0, 1, 0};          ///< in the frame of the hinge
  Pose mount;                   ///< of the shape
  double turn_per_opening = 0;  ///< of two jaws that open alike 0.5 and -0.5; 0: rigid
  HandleCoupling coupling;
};

struct ToolDescription {
  std::string name;
  std::vector<JawDescription> jaws;  ///< one or two
  Pose pose;                         ///< of the handle, to begin with
  double opening_rad = 0;
  CollisionFilter filter;
};

/// A tool that a hand holds: rigid bodies of a world that follow one handle with an opening. They do
/// not touch each other.
class Tool {
 public:
  /// Adds its bodies to the world. Issue world_parameter_invalid.
  static Result<Tool> create(World& world, const ToolDescription& description);

  std::size_t jaw_count() const { return jaws_.size(); }
  std::span<const BodyId> bodies() const { return bodies_; }
  bool has_opening() const;

  /// Where the shape of a jaw is with the handle there.
  RigidPlacement jaw_pose(std::size_t jaw, const RigidPlacement& handle, double opening_rad) const;
  /// Of a jaw at that pose: a point its hinge turns it about, and how its rotation vector changes with
  /// the opening; world axes.
  Vec3 hinge_point(std::size_t jaw, const RigidPlacement& handle) const;
  Vec3 hinge_turn(std::size_t jaw, const RigidPlacement& handle) const;

  /// Where the handle is at the end of the next step. Allocates nothing. Issue
  /// world_parameter_invalid: a pose or opening that is not finite; nothing has moved then.
  Status move(World& world, const Pose& handle, double opening_rad) const;
  /// The same at once, past all that lies between.
  Status place(World& world, const Pose& handle, double opening_rad) const;

 private:
  template <class Set>
  Status for_each_pose(const Pose& handle, double opening_rad, Set&& set) const;

  struct Jaw {
    RigidPlacement hinge, mount;
    Vec3 axis;
    double turn_per_opening;
  };
  std::vector<Jaw> jaws_;
  std::vector<BodyId> bodies_;
};

}  // namespace souple
