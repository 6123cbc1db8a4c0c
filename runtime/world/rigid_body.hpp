// SPDX-License-Identifier: MIT
// Rigid bodies as the world steps them. Internal to the world.
#pragma once
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "formats/core/result.hpp"
#include "runtime/collision/rigid_distance.hpp"
#include "runtime/collision/rigid_mesh.hpp"
#include "runtime/world/settings.hpp"

namespace souple {

/// How a body moves on the whole.
struct BodyMotion {
  Vec3 velocity = Vec3::Zero();  ///< mean
  double deviation = 0;          ///< of the velocity of any point from it, at most
};

/// State of a rigid body that moves by the forces on it. The body frame lies in the centre of mass
/// along the principal axes.
struct FreeRigidState {
  double mass = 0;              ///< kg
  Vec3 inertia = Vec3::Zero();  ///< about the principal axes, kg m^2
  RigidPlacement body_frame;    ///< in the frame of the shape

  Vec3 position = Vec3::Zero();                                     ///< of the centre of mass, m
  Eigen::Quaterniond orientation = Eigen::Quaterniond::Identity();  ///< of the body frame
  Vec3 velocity = Vec3::Zero(), spin = Vec3::Zero();                ///< m/s, rad/s; world axes

  // Of one step: motion of the centre of mass and rotation vector, and the compliance
  // C = h^2 diag(1/m, J^-1) (METHOD 4.2).
  Vec3 shift = Vec3::Zero(), turn = Vec3::Zero();
  double shift_compliance = 0;          ///< m/N
  Mat3 turn_compliance = Mat3::Zero();  ///< rad/(N m)

  RigidPlacement shape_placement() const;
  Mat3 world_inertia() const;
  /// Of a held body: what its turn does to an arm beyond the cross product, which a hand's may show.
  Mat3 bend = Mat3::Zero();
  /// In this step, linear in the forces.
  Vec3 motion_of(const Vec3& arm) const { return shift + turn.cross(arm) + bend * arm; }
};

/// Of a body that a hand holds. It has no mass; in place of it the coupling resists.
struct HeldState {
  HandleCoupling coupling;
  RigidPlacement now, next;  ///< where the hand holds the shape at the start and end of the step
};

struct RigidBody {
  std::string name;
  RigidShape shape;
  std::vector<Keyframe> path;  ///< of a free body where it starts
  CollisionFilter filter;
  double size = 0;                     ///< longest side of the shape, m; of a plane 0
  std::optional<FreeRigidState> free;  ///< of a held body too, which has a massless one
  std::optional<HeldState> held;
  std::unique_ptr<PlacedMesh> placed;  ///< of a mesh: its surface at the start of the step
  RigidPlacement start, end;           ///< of the shape, in this step

  /// `time_s`: now.
  static Result<RigidBody> create(const RigidBodyDescription& description, double time_s);

  RigidPlacement placement_at(double time_s) const;
  /// Start and, for a driven body, end of the step; the surface of a mesh.
  void begin_step(double time_s, double time_step_s);
  /// Motion of a driven body's material point that is at `point` at the start of the step.
  Vec3 driven_motion_of(const Vec3& point) const;
  /// Where the shape would be after the free motion.
  RigidPlacement free_end() const;
  /// Of a free body: motion by inertia, weight and the gyroscopic moment; the compliance of the step.
  void move_freely(double time_step_s, const Vec3& gravity);
  /// The same of a held body: by the hand, and by what the damper keeps of how far it was from it.
  void follow_hand(double time_step_s);
  /// A force on a free body in this step, at an arm from its centre of mass: world axes.
  void push(const Vec3& force, const Vec3& arm);
  void take_motion(double time_step_s);
  void stop();  ///< a free body: without velocity
  /// Of its points; of a driven body, of those in `region`.
  BodyMotion motion_in(const Eigen::AlignedBox3d& region, double time_step_s) const;
  double longest_side() const { return size; }  ///< m; of a plane 0
  Eigen::AlignedBox3d bounds() const;           ///< at the start of the step; of a plane everything
  double kinetic_energy() const;
};

}  // namespace souple
