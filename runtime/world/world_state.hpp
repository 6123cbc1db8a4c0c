// SPDX-License-Identifier: MIT
// What a world holds, and the phases of its step. Internal to the world.
#pragma once
#include <chrono>
#include <memory>
#include <variant>
#include <vector>

#include "runtime/contact/frictional_contact.hpp"
#include "runtime/world/contact_detection.hpp"
#include "runtime/world/contact_space.hpp"
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

struct World::State {
  using Body = std::variant<SoftBody, RigidBody>;

  explicit State(const WorldSettings& s) : settings(s), gravity(as_vec3(s.gravity_m_s2)) {}

  WorldSettings settings;
  Vec3 gravity;
  double time = 0;
  std::vector<std::unique_ptr<Body>> bodies;
  std::vector<std::uint32_t> soft_indices, rigid_indices;

  // One step; memory kept from step to step.
  std::vector<RigidStep> rigid_steps;  ///< by body index; soft ones unused
  std::vector<Contact> contacts;
  std::vector<Mat3> frames;
  std::vector<BodyContacts> body_contacts;  ///< by body index; rigid ones unused
  std::vector<double> delassus, free_gap, friction, force, gap, applied, change;
  // The contacts of the last step, ascending by key, their forces on body A and
  // how these changed in the step, in world coordinates.
  std::vector<ContactKey> last_keys;
  std::vector<Vec3> last_forces, last_changes;
  std::vector<ContactKey> earlier_keys;  ///< scratch
  std::vector<Vec3> earlier_forces;
  std::size_t uncovered = 0;  ///< contacts of this step outside the region of a compliance
  int growing_steps = 0;      ///< steps in a row in which the forces overshot more and more
  double relaxation = 1;      ///< >= 1: multiplies the warped compliance, see choose_relaxation

  SoftBody& soft(std::uint32_t index) { return std::get<SoftBody>(*bodies[index]); }
  const SoftBody& soft(std::uint32_t index) const { return std::get<SoftBody>(*bodies[index]); }
  const RigidBody& rigid(std::uint32_t index) const { return std::get<RigidBody>(*bodies[index]); }
  bool exact() const { return settings.contact_method == ContactMethod::exact; }
  FrictionalContactProblem problem() const { return {contacts.size(), delassus, free_gap, friction}; }

  Status compute_step(StepReport& report, PhaseClock& clock);
  void place_rigid_bodies();
  double alarm_distance(const SoftBody& soft_body, double other_speed) const;
  double rigid_speed(const RigidStep& step, const SoftBody& soft_body) const;
  void detect();
  void leave_out_uncovered();
  void describe_contacts();
  void ask_ahead() const;
  Status check_ready() const;
  void forget_contacts();
  void recall_forces();
  Status free_motion(StepReport& report);
  double normal_motion(std::size_t contact) const;
  void discard_distant();
  Status build_delassus();
  void build_free_gap();
  void correct();
  void make_motion_exact(StepReport& report);
  double change_norm() const;  ///< of the forces, in the last pass, N
  Status solve_contacts(StepReport& report, PhaseClock& clock);
  void choose_relaxation();
  void remember_contacts();
  Status commit();
  void measure(StepReport& report);
};

}  // namespace souple
