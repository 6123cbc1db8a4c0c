// SPDX-License-Identifier: MIT
#pragma once
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "formats/core/mesh.hpp"
#include "formats/core/result.hpp"
#include "runtime/world/constraints.hpp"
#include "runtime/world/contact_events.hpp"
#include "runtime/world/jobs.hpp"
#include "runtime/world/loads.hpp"
#include "runtime/world/settings.hpp"
#include "runtime/world/step_report.hpp"

namespace souple {

class SoftBodyAsset;
struct StepContactProblem;
struct ToolProblem;

/// One contact after a step, in world coordinates. The force acts on body A; -force on body B.
struct ContactRecord {
  BodyId body_a, body_b;  ///< the same in self-contact
  Point point_m{};
  Point normal{};  ///< unit, from B to A
  Point force_n{};
  double gap_m = 0;  ///< after the step; < 0 penetrates
};

/// Where a ray meets a body first.
struct PickHit {
  BodyId body;
  double distance_m = 0;
  Point point_m{};
  Point normal{};          ///< outward
  std::int32_t node = -1;  ///< of a soft body: the nearest corner of the triangle that is hit
};

/// Several bodies in one contact problem, stepped together (METHOD Alg. 11).
class World {
 public:
  /// Issue world_parameter_invalid.
  static Result<World> create(const WorldSettings& settings);
  World(World&&) noexcept;
  World& operator=(World&&) noexcept;
  ~World();

  /// The asset is shared and const; the body is a cheap instance of it.
  /// Issues: world_parameter_invalid, fixed_set_invalid, driven_nodes_invalid, static_body_not_held,
  /// explicit_step_too_long, scene_no_matching_compliance, solver_not_possible,
  /// asset_multigrid_invalid.
  Result<BodyId> add_soft_body(std::shared_ptr<const SoftBodyAsset> asset,
                               const SoftBodyDescription& description);
  Result<BodyId> add_rigid_body(const RigidBodyDescription& description);

  /// A force on a soft body beside gravity, from the next step on. Issue load_invalid.
  Result<LoadId> add_load(BodyId soft_body, const LoadDescription& description);
  /// Replaces the course of a load by a value that it keeps (of a keyframe all but the time): N or Pa,
  /// the pressure of a pressure. Allocates nothing. Issue load_invalid, the load unchanged.
  Status set_load(LoadId load, const LoadKeyframe& value);

  /// Friction between two bodies, and whether they collide, from the next step on; the order does not
  /// matter. Issue world_parameter_invalid, nothing changed.
  Status set_pair(BodyId a, BodyId b, const PairRule& rule);

  /// Bodies held together in the contact problem, by points (METHOD 4.2). Issue joint_invalid: bodies,
  /// a point that no body is near, an axis or arm that is no length, nodes outside the region of a
  /// compliance, neither of them movable.
  Result<JointId> add_joint(const JointDescription& description);
  /// Takes hold of a body. Issue joint_invalid as above.
  Result<GrabId> grab(const GrabDescription& description);
  /// Where the handle is to be at the end of the next step; it starts at the identity. Issue
  /// world_parameter_invalid: no such grab, a pose that is none.
  Status move_grab(GrabId grab, const Pose& pose);
  Status release(GrabId grab);

  /// Where the hand that holds a body (HandleCoupling) is at the end of the next step. Allocates
  /// nothing. Issue world_parameter_invalid: no such body, a pose that is none; nothing has moved then.
  Status move_handle(BodyId held_body, const Pose& pose);
  /// Of the last step: the contacts of all that the held bodies of a tool touch, directly or through
  /// others, as many as `problem` has room for. Allocates nothing. Issue world_parameter_invalid: not
  /// held bodies of this world, or too many.
  Status tool_problem(std::span<const BodyId> tool, ToolProblem& problem) const;

  /// A ray from `origin` along `direction`, at most `reach_m` long, of any length. Nothing hit, or a
  /// direction that is none: nothing.
  std::optional<PickHit> pick(const Point& origin, const Point& direction, double reach_m) const;

  /// Wakes the body and all that it touches.
  void wake(BodyId body);
  bool is_asleep(BodyId body) const;

  /// Bodies are stepped as jobs of the application, with the same results; empty: one after another.
  void run_jobs_with(RunJobs run_jobs);

  /// One time step. Allocates nothing once the largest contact count has been seen. On an issue
  /// (step_not_finite, compliance_not_loaded) the state is that before the step; there are then no
  /// contacts to be read.
  Result<StepReport> step();

  double time_s() const;
  std::size_t body_count() const;
  const std::string& body_name(BodyId body) const;
  bool is_soft(BodyId body) const;
  const SoftBodyAsset& asset(BodyId soft_body) const;

  /// What solves the steps of this body; never automatic. Where the choice was left to the body,
  /// multigrid_pcg stands in while it takes less work.
  SolverKind solver(BodyId soft_body) const;
  std::span<const Point> positions(BodyId soft_body) const;   ///< m, all nodes of the finest level
  std::span<const Point> velocities(BodyId soft_body) const;  ///< m/s
  Pose rigid_pose(BodyId rigid_body) const;
  /// Of a rigid body's centre of mass; of a driven or fixed one zero.
  Point rigid_velocity(BodyId rigid_body) const;          ///< m/s
  Point rigid_angular_velocity(BodyId rigid_body) const;  ///< rad/s, world axes
  /// Replaces the state of a free rigid body, or puts a held one and its hand there, past all that lies
  /// between. Issue world_parameter_invalid.
  Status set_rigid_state(BodyId rigid_body, const Pose& pose, const Point& velocity_m_s,
                         const Point& angular_velocity_rad_s);
  /// Replaces the state of a soft body. Issue world_parameter_invalid (sizes, finiteness).
  Status set_state(BodyId soft_body, std::span<const Point> positions,
                   std::span<const Point> velocities);

  /// Takes over time, positions, velocities and contact forces of a world with the same bodies, which
  /// may have other settings: the same history, another method. Issue world_parameter_invalid,
  /// unchanged.
  Status copy_state(const World& other);

  /// Positions, velocities, contact forces, time and what solvers have learnt, as bytes: after restore
  /// the steps have the same bits. What the application has set (bodies, loads, pairs, jobs) is not
  /// part of it. Both allocate.
  std::vector<std::byte> snapshot() const;
  /// Of this world, or one made in the same way. There are no contacts to be read until the next step.
  /// Issue snapshot_invalid, nothing changed.
  Status restore(std::span<const std::byte> snapshot);

  std::vector<ContactRecord> contacts() const;  ///< of the last step; allocates
  /// Pairs of bodies that began, kept or ended to press on each other in the last step.
  std::span<const ContactEvent> contact_events() const;
  /// The contact problem of the last step (W, free gap, laws, forces, frames), made for the asking: W
  /// of all contacts is dense here, and is never so in a step.
  StepContactProblem contact_problem() const;

 private:
  struct State;
  explicit World(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace souple
