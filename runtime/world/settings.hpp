// SPDX-License-Identifier: MIT
// Plain parameters of a world: no behaviour, defaults that work, SI units.
#pragma once
#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "formats/core/mesh.hpp"
#include "formats/core/solver_kind.hpp"
#include "runtime/fem/rotation_method.hpp"

namespace souple {

class RigidMesh;

/// Rigid placement: x_world = rotation x_local + translation.
struct Pose {
  std::array<double, 4> rotation{1, 0, 0, 0};  ///< unit quaternion w, x, y, z
  Point translation{};                         ///< m
};

/// Where the compliance of the contacts comes from.
enum class ContactMethod : std::uint8_t {
  warped,  ///< C = R C0 R^T from the precomputed rest compliance (METHOD 4.2)
  exact,   ///< columns of A^-1 solved at every step with the current tangent (eq. 4.16): the reference
  /// A baseline (METHOD 4.2.2): springs against what has already penetrated, in the free motion.
  /// Neither law holds, and nothing is coupled.
  penalty,
};

/// How positions and velocities go on in time (METHOD 2). Each has its own system matrix
/// A = a_M M + a_K K, and so its own compliance (METHOD 4.2).
enum class Integrator : std::uint8_t {
  implicit_euler,  ///< first order, damps: a_M = 1/h^2 + alpha/h, a_K = 1 + beta/h
  /// Second order between impacts, damps far less: a_M = 9/(4 h^2) + 3 alpha/(2 h),
  /// a_K = 1 + 3 beta/(2 h), which is the matrix of an implicit Euler step of 2 h / 3.
  bdf2,
  /// No inertia: every step goes to the equilibrium of the linearised body, A = K. Every soft body
  /// needs three fixed nodes that are not on one line, and a static compliance.
  quasi_static,
  /// A baseline only: forces of the start of the step, then positions by the new velocities, A = M/h^2.
  /// Refused beyond its stability limit, and with warped contacts.
  explicit_euler,
};

/// Ends when the natural map and the change of the forces in a sweep, relative to the forces, fall
/// below `tolerance`.
struct ContactSolverSettings {
  double tolerance = 1e-9;
  int max_sweeps = 1000;
  /// Goes on until no frictional contact of the problem is left deeper than this, m; 0: not asked.
  /// Beside an impact the forces of what merely rests are small, and so is their part of the residual.
  double penetration_m = 0;
};

enum class UnconvergedStep : std::uint8_t {
  keep_best,  ///< the step goes on with the best iterate; its report tells the residual
  refuse,     ///< issue solver_not_converged, the state is kept
};

/// A dx = b: solved to ||b - A dx|| <= tolerance ||b||, whatever the solver.
struct FreeMotionSettings {
  SolverKind solver = SolverKind::automatic;
  double tolerance = 1e-8;
  int max_iterations = 1000;
  UnconvergedStep unconverged = UnconvergedStep::keep_best;
};

struct WorldSettings {
  double time_step_s = 0.01;
  Integrator integrator = Integrator::implicit_euler;
  /// Of the elements, in forces and tangent. All but `polar` are for comparison: their forces carry a
  /// moment, and energy and momentum are not what they should be.
  RotationMethod rotation_method = RotationMethod::polar;
  Point gravity_m_s2{0, 0, -9.81};
  double friction = 0.4;        ///< Coulomb coefficient of pairs without a PairRule, in [0, 10]
  double alarm_distance_m = 0;  ///< contacts are built below this gap; 0: chosen from size and speed
  ContactMethod contact_method = ContactMethod::warped;
  bool feed_forward_forces = true;  ///< last step's forces enter the free motion (METHOD 4.2)
  /// Contact solves in a step, 1 to 20. Each further one first makes the motion exact for the forces so
  /// far with the present tangent, so that only what they still change is warped: the error of warping
  /// shrinks with every pass, for the price of a solve. Passes end early when the forces change by less
  /// than a thousandth, as at rest; or by more than in the pass before, as under deep crush.
  int contact_passes = 1;
  /// Penalty method only: force over penetration, N/m of each contact; 0: m / h^2 of the lighter side.
  double penalty_stiffness_n_m = 0;
  /// Bodies that touch each other sleep once all of them have been slower than `sleep_speed` for so
  /// long: they cost nothing until something touches them, and keep their contact forces. 0: never.
  double sleep_after_s = 0;
  double sleep_speed = 1e-3;  ///< in sides of the body per second
  ContactSolverSettings contact_solver;
  FreeMotionSettings free_motion;
  /// Fill the law and energy figures of every StepReport; not part of the times it gives.
  bool measure_laws = true;
};

/// What holds between two bodies; see World::set_pair.
struct PairRule {
  double friction = 0.4;   ///< Coulomb coefficient, in [0, 10]
  bool collides = true;    ///< false: they pass through each other
  double restitution = 0;  ///< speed after an impact over that before it, in [0, 1]
};

/// Who may touch whom: two bodies collide if each one's groups meet the other's mask.
struct CollisionFilter {
  std::uint32_t groups = 1;
  std::uint32_t mask = ~std::uint32_t{0};
};

enum class RigidShapeKind : std::uint8_t { plane, sphere, box, capsule, mesh };

struct RigidShape {
  RigidShapeKind kind = RigidShapeKind::plane;  ///< plane: local z = 0, solid below, normal +z
  double radius_m = 0;                          ///< sphere, capsule
  Point half_extents_m{};                       ///< box
  double half_length_m = 0;                     ///< capsule: of the segment on the local z axis
  std::shared_ptr<const RigidMesh> mesh;        ///< mesh: a closed surface
};

/// Pose at a time; between keyframes translation is linear and rotation slerped, outside it is held.
struct Keyframe {
  double time_s = 0;
  Pose pose;
};

/// A rigid body that moves by the forces on it. Its centre of mass and principal axes are those of its
/// shape, filled evenly; a plane has none.
struct FreeRigidMotion {
  double mass_kg = 0;  ///< 0: from the density
  double density_kg_m3 = 1000;
  Point velocity_m_s{};            ///< of the centre of mass
  Point angular_velocity_rad_s{};  ///< in world axes
};

/// A rigid body without mass that a hand holds: a spring and damper pull it to a handle, about a point
/// of its shape's frame. Nothing else holds it: free of contact it is where the handle is, once the
/// damper lets it, and what it touches feels the spring.
struct HandleCoupling {
  double stiffness_n_m = 2000;
  double turn_stiffness_nm_rad = 20;
  double damping_n_s_m = 0;
  double turn_damping_nm_s_rad = 0;
  Point centre_m{};
  /// Contacts are kept in the problem of a step that are farther open by so much: what the hand may
  /// close before the next one.
  double look_ahead_m = 0;
};

struct RigidBodyDescription {
  std::string name;
  RigidShape shape;
  std::vector<Keyframe> path;            ///< one keyframe: fixed; more: driven, ascending times
  std::optional<FreeRigidMotion> free;   ///< starts at the pose of the one keyframe, which it may leave
  std::optional<HandleCoupling> handle;  ///< held by a hand, which begins at the one keyframe
  CollisionFilter filter;
};

/// Nodes that are moved along a rigid path: node k is at pose(t) X_k, X_k its rest position.
struct DrivenSet {
  std::string name;            ///< a set of the asset; its nodes belong to the fixed set as well
  std::vector<Keyframe> path;  ///< as of a rigid body, the pose being that of the rest frame
};

struct SoftBodyDescription {
  std::string name;
  Pose pose;
  Point velocity_m_s{};
  Point angular_velocity_rad_s{};  ///< about the centre of mass
  std::string fixed_set;           ///< held at its initial position unless driven; empty: free
  std::vector<DrivenSet> driven;   ///< parts of the fixed set, or all of it
  CollisionFilter filter;
  bool self_contact = false;  ///< its surface may touch itself
};

}  // namespace souple
