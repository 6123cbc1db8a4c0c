// SPDX-License-Identifier: MIT
// What a world holds, and the phases of its step. Internal to the world.
#pragma once
#include <array>
#include <chrono>
#include <functional>
#include <limits>
#include <memory>
#include <variant>
#include <vector>

#include "runtime/collision/broad_phase.hpp"
#include "runtime/collision/ray_pick.hpp"
#include "runtime/contact/accelerated_gauss_seidel.hpp"
#include "runtime/world/active_core.hpp"
#include "runtime/world/contact_detection.hpp"
#include "runtime/world/contact_events.hpp"
#include "runtime/world/contact_memory.hpp"
#include "runtime/world/contact_operator.hpp"
#include "runtime/world/contact_space.hpp"
#include "runtime/world/islands.hpp"
#include "runtime/world/jobs.hpp"
#include "runtime/world/pair_rules.hpp"
#include "runtime/world/pins.hpp"
#include "runtime/world/solver_share.hpp"
#include "runtime/world/step_report.hpp"
#include "runtime/world/tool_problem.hpp"
#include "runtime/world/world.hpp"

namespace souple {

class PhaseClock {
 public:
  /// Seconds since the last call.
  double lap() {
    const auto now = std::chrono::steady_clock::now();
    const double seconds = std::chrono::duration<double>(now - last_).count();
    last_ = now;
    return seconds;
  }

 private:
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

/// What the jobs of a step leave for what follows them.
struct BodyStep {
  SolveReport solved;
  bool sound = true;              ///< forces finite, tangent positive definite
  bool has_new_contacts = false;  ///< since the motion was last corrected
  bool struck = false;            ///< contacts changed the motion by an impulse; BDF2 only
  bool is_warped = false;         ///< contact forces moved it by the warped compliance
  double warping_energy_j = 0;    ///< that the warped correction gave and the step takes back
  bool is_warping_wild = false;   ///< it gave more than half the kinetic energy before
  double kinetic_energy_j = 0, elastic_energy_j = 0, node_depth_m = 0, surface_depth_m = 0;
};

/// Of the solver of one island.
struct IslandWork {
  AcceleratedWork solver;
  ActiveCore core;
  std::vector<double> force;
  std::vector<ConstraintLaw> laws;
  ContactSolveReport report;
};

/// Of tool_problem.
struct ToolScratch {
  std::vector<std::uint32_t> contacts;  ///< those of the problem, in its order
  StepContactOperator::GatherWork gather;
};

/// Whether a body rests.
struct BodyRest {
  double quiet_s = 0;  ///< how long it has been slower than the limit
  bool is_asleep = false;
  std::uint32_t group = 0;  ///< of those that fell asleep together
};

struct World::State {
  using Body = WorldBody;
  using BodyMotion = souple::BodyMotion;

  explicit State(const WorldSettings& s) : settings(s), gravity(as_vec3(s.gravity_m_s2)) {}

  WorldSettings settings;
  Vec3 gravity;
  double time = 0;
  RunJobs run_jobs;  ///< empty: one after another
  std::vector<std::unique_ptr<Body>> bodies;
  std::vector<std::uint32_t> soft_indices, rigid_indices;
  SolverShare solvers;
  PairRules pairs;
  Pins pins;

  // One step; memory kept from step to step.
  std::vector<std::uint32_t> awake_soft;
  std::vector<BodyRest> rest;               ///< by body index
  std::vector<std::uint32_t> sleep_groups;  ///< scratch
  BroadPhase broad_phase;
  PairList touching;
  std::vector<Contact> contacts;  ///< ascending by key
  std::vector<ConstraintLaw> laws;
  std::vector<std::vector<std::uint32_t>> contacts_of_body;  ///< by body index
  std::vector<BodyContacts> body_contacts;                   ///< by body index; rigid ones unused
  std::vector<RigidContacts> rigid_contacts;                 ///< by body index; soft ones unused
  std::vector<BodyStep> body_steps;                          ///< by body index
  StepContactOperator contact_operator;
  Islands islands;
  std::vector<IslandWork> island_work;
  /// Near at the start, but the free motion keeps them apart.
  std::vector<Contact> put_off;
  /// 3 per contact, in its frame. `applied`: forces in the load that the motion was solved for;
  /// `included`: those in the motion, corrections too; `change`: what a correction adds; `shift`,
  /// one per contact: what was taken from the normal free gap (restitution, deep overlaps).
  std::vector<double> free_gap, force, gap, applied, included, change, shift;
  std::vector<double> scratch_rows;
  std::vector<std::uint32_t> order;  ///< scratch
  ToolScratch tool_scratch;
  ContactMemories memory, earlier;  ///< of the last step; scratch
  ContactEvents events;
  std::size_t uncovered = 0;  ///< contacts of this step outside the region of a compliance
  double last_energy_j = std::numeric_limits<double>::quiet_NaN();  ///< NaN: not measured

  bool is_soft(std::uint32_t index) const { return std::holds_alternative<SoftBody>(*bodies[index]); }
  SoftBody& soft(std::uint32_t index) { return std::get<SoftBody>(*bodies[index]); }
  const SoftBody& soft(std::uint32_t index) const { return std::get<SoftBody>(*bodies[index]); }
  RigidBody& rigid(std::uint32_t index) { return std::get<RigidBody>(*bodies[index]); }
  const RigidBody& rigid(std::uint32_t index) const { return std::get<RigidBody>(*bodies[index]); }
  bool exact() const { return settings.contact_method == ContactMethod::exact; }
  bool penalty() const { return settings.contact_method == ContactMethod::penalty; }
  bool is_awake(std::uint32_t index) const { return !rest[index].is_asleep; }
  bool is_free_rigid(std::uint32_t index) const { return !is_soft(index) && rigid(index).free; }
  /// Whether contact forces move it in this step.
  bool is_movable(std::uint32_t index) const {
    return is_awake(index) && (is_soft(index) || rigid(index).free);
  }
  StepRule rule() const {
    return {settings.integrator, settings.rotation_method, settings.time_step_s, time, gravity};
  }
  PairRule pair(std::uint32_t a, std::uint32_t b) const {
    return pairs.of(a, b, {settings.friction, true, 0});
  }
  Eigen::Map<const Vec3> at(const std::vector<double>& rows, std::size_t contact) const {
    return Eigen::Map<const Vec3>(rows.data() + 3 * contact);
  }

  /// job(k) for k below `count`, as jobs of the application. Allocates nothing.
  template <class Job>
  void run(std::size_t count, Job&& job) {
    if (!run_jobs || count < 2)
      for (std::size_t k = 0; k < count; ++k) job(k);
    else
      run_jobs(count, std::cref(job));
  }
  /// job(index) for every soft body that is awake.
  template <class Job>
  void for_each_soft(Job&& job) {
    const auto one = [&](std::size_t k) { job(awake_soft[k]); };
    run(awake_soft.size(), one);
  }
  /// visit(index) for every free rigid body that is awake.
  template <class Visit>
  void for_each_free_rigid(Visit&& visit) {
    for (const std::uint32_t index : rigid_indices)
      if (is_movable(index)) visit(index);
  }

  // The step (world_step.cpp).
  BodyId add(std::unique_ptr<Body> body, std::vector<std::uint32_t>& indices);
  Status compute_step(StepReport& report, PhaseClock& clock);
  void begin_step();
  void begin_soft(std::uint32_t index);
  Status free_motion(StepReport& report);
  void move_rigid_bodies();
  Status report_solves(StepReport& report) const;
  Status judge_unconverged(const SoftBody& body, const SolveReport& solved) const;
  Status commit();
  void give_up();  ///< after a step that could not be computed
  void forget_contacts();

  // Which contacts there are (find_contacts.cpp).
  void find_contacts();
  void find_touching_pairs();
  double body_size(std::uint32_t index) const;
  BodyMotion body_motion(std::uint32_t index, const Eigen::AlignedBox3d& region) const;
  double relative_speed(std::uint32_t a, std::uint32_t b) const;
  Eigen::AlignedBox3d body_bounds(std::uint32_t index) const;
  double alarm_distance(std::uint32_t a, std::uint32_t b) const;
  double smaller_size(const ContactKey& key) const;
  double margin_of_touch(std::uint32_t a, std::uint32_t b) const;
  double look_ahead(std::uint32_t a, std::uint32_t b) const;
  bool may_touch(std::uint32_t a, std::uint32_t b) const;
  Eigen::AlignedBox3d movable_region() const;
  double reach(std::uint32_t index, const Eigen::AlignedBox3d& movable) const;
  BodyMotion free_motion_of(std::uint32_t index, const Eigen::AlignedBox3d& region) const;
  double free_approach(std::uint32_t a, std::uint32_t b) const;
  void detect_pair(PairContacts& pair);
  void describe_pair(PairContacts& pair) const;
  void add_swept_contacts();
  void add_pin_contacts();
  void complete(Contact& contact) const;
  bool is_covered(const Contact& contact) const;
  void leave_out_uncovered();
  double normal_motion(const Contact& contact) const;
  void discard_distant();
  void take_back_closed();
  void sweep_pair(PairContacts& found, double alarm, double least_depth);
  std::optional<ContactKey> key_if_missing(const Contact& contact) const;
  void add_crossing(bool first_look);
  void order_contacts();
  void spread_new_contacts();
  bool add_missing(bool first_look);
  void describe_contacts();
  void ask_ahead() const;
  Status check_ready() const;

  // Rest (sleeping.cpp).
  void wake_group(std::uint32_t index);
  bool wake_touched();
  void put_to_sleep();
  bool is_active(std::uint32_t index) const;
  bool is_quiet(std::uint32_t index) const;
  bool sleeps_on(std::uint32_t a, std::uint32_t b) const;

  std::optional<RayHit> pick_body(std::uint32_t index, const Ray& ray) const;

  // Joints and grabs (pins.cpp).
  Status check_joint(const JointDescription& description) const;
  Status add_pins(const JointDescription& description, std::uint32_t joint);
  Status add_grab_pins(const GrabDescription& description, std::uint32_t grab);
  Result<PinPoint> pin_to(std::uint32_t index, const Vec3& point, double reach);
  std::vector<Index> nodes_near(const SoftBody& body, const GrabDescription& description) const;
  Vec3 where(const PinPoint& point) const;

  // The contact problem (contact_phase.cpp).
  void recall_forces();
  Status build_delassus();
  void build_free_gap();
  double restitution_of(std::size_t contact) const;
  void shift_free_gaps();
  double approach_speed(const Contact& contact) const;
  Vec3 velocity_of(const ContactSide& side) const;
  Vec3 motion_of(const ContactSide& side) const;
  void solve_islands(StepReport& report);
  void solve_island(std::size_t island);
  void correct();
  Status make_motion_exact(StepReport& report);
  Status solve_pass(StepReport& report, PhaseClock& clock);
  double change_norm() const;  ///< of the forces, in the last pass, N
  double force_norm() const;
  Status solve_contacts(StepReport& report, PhaseClock& clock);
  void push_rigid_bodies(const std::vector<double>& forces);
  void apply_penalty();  ///< penalty.cpp
  void end_penalty();
  double mass_at(const Contact& contact) const;
  void choose_relaxation(std::uint32_t index);
  void find_struck_bodies();
  bool is_impact(std::uint32_t body) const;
  void remember_contacts();
  void measure_warping();
  void judge_warping(std::uint32_t index, double impact_j);

  /// Over all that the next step depends on, in one order; see snapshot.cpp.
  template <class Stream>
  bool walk_state(Stream& stream);

  // What a hand may feel between steps (tool_problem.cpp).
  bool is_held(BodyId body) const;
  std::size_t collect_tool_contacts(std::span<const BodyId> tool, std::size_t capacity);
  void describe_tool_contact(std::size_t contact, std::span<const BodyId> tool, ToolContact& to) const;
  void fill_gaps(ToolProblem& problem) const;

  // What a step is judged by (measure_step.cpp).
  void measure_body(std::uint32_t index);
  void measure_energy(StepReport& report);
  double contact_residual();
  double cone_violation() const;
  void measure(StepReport& report);
};

}  // namespace souple
