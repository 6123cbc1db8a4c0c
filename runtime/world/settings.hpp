// SPDX-License-Identifier: MIT
// Plain parameters of a world: no behaviour, defaults that work, SI units.
#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "formats/core/mesh.hpp"

namespace souple {

/// Rigid placement: x_world = rotation x_local + translation.
struct Pose {
  std::array<double, 4> rotation{1, 0, 0, 0};  ///< unit quaternion w, x, y, z
  Point translation{};                         ///< m
};

/// Where the compliance of the contacts comes from.
enum class ContactMethod : std::uint8_t {
  warped,  ///< C = R C0 R^T from the precomputed rest compliance (METHOD 4.2)
  exact,   ///< columns of A^-1 solved at every step with the current tangent (eq. 4.16): the reference
};

/// Ends when the largest relative change of the contact forces in a sweep falls below `tolerance`.
struct ContactSolverSettings {
  double tolerance = 1e-9;
  int max_sweeps = 1000;
};

/// Conjugate gradients on A dx = b; stops at ||r|| <= tolerance ||b||.
struct FreeMotionSettings {
  double tolerance = 1e-8;
  int max_iterations = 1000;
};

struct WorldSettings {
  double time_step_s = 0.01;
  Point gravity_m_s2{0, 0, -9.81};
  double friction = 0.4;        ///< Coulomb coefficient of every pair, in [0, 10]
  double alarm_distance_m = 0;  ///< contacts are built below this gap; 0: chosen from size and speed
  ContactMethod contact_method = ContactMethod::warped;
  bool feed_forward_forces = true;  ///< last step's forces enter the free motion (METHOD 4.2)
  /// Contact solves in a step, 1 to 20. Each further one first makes the motion exact for the forces so
  /// far with the present tangent, so that only what they still change is warped: the error of warping
  /// shrinks with every pass, for the price of a solve. Under deep crush it may not: passes end when
  /// the forces change more than in the pass before.
  int contact_passes = 1;
  ContactSolverSettings contact_solver;
  FreeMotionSettings free_motion;
  /// Fill the law and energy figures of every StepReport; not part of the times it gives.
  bool measure_laws = true;
};

enum class RigidShapeKind : std::uint8_t { plane, sphere, box };

struct RigidShape {
  RigidShapeKind kind = RigidShapeKind::plane;  ///< plane: local z = 0, solid below, normal +z
  double radius_m = 0;                          ///< sphere
  Point half_extents_m{};                       ///< box
};

/// Pose at a time; between keyframes translation is linear and rotation slerped, outside it is held.
struct Keyframe {
  double time_s = 0;
  Pose pose;
};

struct RigidBodyDescription {
  std::string name;
  RigidShape shape;
  std::vector<Keyframe> path;  ///< one keyframe: fixed; more: driven, ascending times
};

struct SoftBodyDescription {
  std::string name;
  Pose pose;
  Point velocity_m_s{};
  Point angular_velocity_rad_s{};  ///< about the centre of mass
  std::string fixed_set;           ///< held at its initial position; empty: free
};

}  // namespace souple
