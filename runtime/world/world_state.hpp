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

#include "runtime/contact/frictional_contact.hpp"
#include "runtime/world/contact_detection.hpp"
#include "runtime/world/contact_space.hpp"
#include "runtime/world/jobs.hpp"
#include "runtime/world/pair_rules.hpp"
#include "runtime/world/solver_share.hpp"
#include "runtime/world/step_report.hpp"
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
  std::vector<Contact> found;
  SolveReport solved;
  bool sound = true;             ///< forces finite, tangent positive definite
  bool struck = false;           ///< contacts changed the motion by an impulse; BDF2 only
  double warping_energy_j = 0;   ///< that the warped correction gave and the step takes back
  bool is_warping_wild = false;  ///< it gave more than half the kinetic energy before
  double kinetic_energy_j = 0, elastic_energy_j = 0, node_depth_m = 0, surface_depth_m = 0;
};

struct World::State {
  using Body = std::variant<SoftBody, RigidBody>;

  explicit State(const WorldSettings& s) : settings(s), gravity(as_vec3(s.gravity_m_s2)) {}

  WorldSettings settings;
  Vec3 gravity;
  double time = 0;
  RunJobs run_jobs;  ///< empty: one after another
  std::vector<std::unique_ptr<Body>> bodies;
  std::vector<std::uint32_t> soft_indices, rigid_indices;
  SolverShare solvers;
  PairRules pairs;

  // One step; memory kept from step to step.
  std::vector<RigidStep> rigid_steps;  ///< by body index; soft ones unused
  std::vector<Contact> contacts;
  std::vector<Mat3> frames;
  std::vector<BodyContacts> body_contacts;  ///< by body index; rigid ones unused
  std::vector<BodyStep> body_steps;         ///< by body index; rigid ones unused
  std::vector<double> delassus, free_gap, friction, force, gap, applied, change;
  // The contacts of the last step, ascending by key, their forces on body A and
  // how these changed in the step, in world coordinates.
  std::vector<ContactKey> last_keys;
  std::vector<Vec3> last_forces, last_changes;
  /// Of every such contact the forces of the last steps, the latest first, and what of them is not part
  /// of an impact: what the free motion of the next step may count on.
  std::vector<std::array<Vec3, 3>> last_courses;
  std::vector<Vec3> last_lasting;
  std::vector<ContactKey> earlier_keys;  ///< scratch
  std::vector<Vec3> earlier_forces;
  std::vector<std::array<Vec3, 3>> earlier_courses;
  std::size_t uncovered = 0;  ///< contacts of this step outside the region of a compliance
  int growing_steps = 0;      ///< steps in a row in which the forces overshot more and more
  double relaxation = 1;      ///< >= 1: multiplies the warped compliance, see choose_relaxation
  double last_energy_j = std::numeric_limits<double>::quiet_NaN();  ///< NaN: not measured

  SoftBody& soft(std::uint32_t index) { return std::get<SoftBody>(*bodies[index]); }
  const SoftBody& soft(std::uint32_t index) const { return std::get<SoftBody>(*bodies[index]); }
  const RigidBody& rigid(std::uint32_t index) const { return std::get<RigidBody>(*bodies[index]); }
  bool exact() const { return settings.contact_method == ContactMethod::exact; }
  FrictionalContactProblem problem() const { return {contacts.size(), delassus, free_gap, friction}; }

  StepRule rule() const {
    return {settings.integrator, settings.rotation_method, settings.time_step_s, time, gravity};
  }

  /// job(index) for every soft body, as jobs of the application. Allocates nothing.
  template <class Job>
  void for_each_soft(Job&& job) {
    const auto one = [&](std::size_t k) { job(soft_indices[k]); };
    if (!run_jobs || soft_indices.size() < 2)
      for (std::size_t k = 0; k < soft_indices.size(); ++k) one(k);
    else
      run_jobs(soft_indices.size(), std::cref(one));
  }

  BodyId add(std::unique_ptr<Body> body, std::vector<std::uint32_t>& indices);
  Status compute_step(StepReport& report, PhaseClock& clock);
  void place_rigid_bodies();
  double alarm_distance(const SoftBody& soft_body, double other_speed) const;
  double rigid_speed(const RigidStep& step, const SoftBody& soft_body) const;
  void detect();
  void detect_of(std::uint32_t body, std::vector<Contact>& found) const;
  void add_driven_motion(Contact& contact) const;
  void leave_out_uncovered();
  void describe_contacts();
  void ask_ahead() const;
  Status check_ready() const;
  void forget_contacts();
  void recall_forces();
  Status free_motion(StepReport& report);
  Status report_solves(StepReport& report) const;
  Status judge_unconverged(const SoftBody& body, const SolveReport& solved) const;
  PairRule pair(std::uint32_t a, std::uint32_t b) const {
    return pairs.of(a, b, {settings.friction, true});
  }
  double normal_motion(std::size_t contact) const;
  void discard_distant();
  Status build_delassus();
  void build_free_gap();
  void correct();
  Status make_motion_exact(StepReport& report);
  double change_norm() const;  ///< of the forces, in the last pass, N
  Status solve_contacts(StepReport& report, PhaseClock& clock);
  void choose_relaxation();
  void remember_contacts();
  void find_struck_bodies();
  void measure_warping();
  bool is_impact(std::uint32_t body) const;
  Status commit();
  /// Over all that the next step depends on, in one order; see snapshot.cpp.
  template <class Stream>
  bool walk_state(Stream& stream);
  void give_up();  ///< after a step that could not be computed
  void measure_body(std::uint32_t index);
  void measure_energy(StepReport& report);
  void measure(StepReport& report);
};

}  // namespace souple
