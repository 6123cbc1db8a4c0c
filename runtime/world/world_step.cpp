// SPDX-License-Identifier: MIT
// The phases of a step in their order (METHOD Alg. 11 and 14): detection, free motion, contact problem,
// correction. What is done for every body by itself runs as jobs of the application; results are put
// together in the order of the bodies, so that they are the same bits however the jobs ran.
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "runtime/world/world_state.hpp"

namespace souple {

Status World::State::compute_step(StepReport& report, PhaseClock& clock) {
  begin_step();
  find_contacts();
  ask_ahead();
  report.times.collision_s = clock.lap();
  recall_forces();
  if (penalty()) apply_penalty();
  if (auto status = free_motion(report); !status) return status;
  add_swept_contacts();
  discard_distant();
  report.times.free_motion_s = clock.lap();
  if (penalty()) {
    end_penalty();
  } else {
    if (auto status = check_ready(); !status) return status;
    if (!contacts.empty())
      if (auto status = solve_contacts(report, clock); !status) return status;
  }
  return commit();
}

void World::State::begin_soft(std::uint32_t index) { soft(index).prescribe_motion(rule()); }

void World::State::begin_step() {
  awake_soft.clear();
  for (const auto index : soft_indices)
    if (is_awake(index)) awake_soft.push_back(index);
  for (const auto index : awake_soft) begin_soft(index);
  for (const auto index : rigid_indices)
    if (is_awake(index)) rigid(index).begin_step(time, settings.time_step_s);
}

void World::State::forget_contacts() {
  contacts.clear();
  laws.clear();
  for (auto* list : {&free_gap, &force, &gap, &applied, &included, &change, &shift}) list->clear();
  events.clear();
}

// The state stays; of BDF2's history what was begun in this step is forgotten with it.
void World::State::give_up() {
  forget_contacts();
  for (const auto index : soft_indices)
    if (soft(index).history.begun) soft(index).history.valid = false;
}

void World::State::move_rigid_bodies() {
  for_each_free_rigid([&](std::uint32_t index) {
    if (rigid(index).held)
      rigid(index).follow_hand(settings.time_step_s);
    else
      rigid(index).move_freely(settings.time_step_s, gravity);
  });
  push_rigid_bodies(applied);
}

Status World::State::free_motion(StepReport& report) {
  move_rigid_bodies();
  for_each_soft([&](std::uint32_t index) {
    SoftBody& body = soft(index);
    body.prepare_free_motion(rule());
    if (body.lacks_history(rule())) {
      body_contacts[index].add_forces(applied, body.begin_history());
      body.start_history(rule(), settings.free_motion);
    }
    body_contacts[index].add_forces(applied, body.load);
    body.add_inertia(rule());
    BodyStep& result = body_steps[index];
    result.sound = std::isfinite(body.load.norm());
    if (result.sound) result.solved = body.solve_free_motion(rule(), settings.free_motion);
  });
  return report_solves(report);
}

Status World::State::report_solves(StepReport& report) const {
  for (const auto index : awake_soft) {
    const BodyStep& result = body_steps[index];
    if (!result.sound)
      return make_issue(IssueCode::step_not_finite, "the forces of a step are not finite",
                        soft(index).name);
    report.free_motion_iterations += result.solved.iterations;
    report.free_motion_residual =
        std::max(report.free_motion_residual, result.solved.relative_residual);
    if (result.solved.converged) continue;
    ++report.unconverged_count;
    if (auto status = judge_unconverged(soft(index), result.solved); !status) return status;
  }
  return {};
}

// A residual that is not finite is no iterate at all.
Status World::State::judge_unconverged(const SoftBody& body, const SolveReport& solved) const {
  if (!std::isfinite(solved.relative_residual))
    return make_issue(IssueCode::step_not_finite, "the equations of a step are not finite", body.name);
  if (settings.free_motion.unconverged == UnconvergedStep::keep_best) return {};
  char text[160];
  std::snprintf(text, sizeof text,
                "%s has a relative residual of %.3g after %d iterations, asked for %.3g",
                std::string(solver_name(body.solver_kind)).c_str(), solved.relative_residual,
                solved.iterations, settings.free_motion.tolerance);
  return make_issue(IssueCode::solver_not_converged, text, body.name);
}

// Takes over the motion only if all of it is finite.
Status World::State::commit() {
  for (const auto index : awake_soft)
    if (!soft(index).motion.allFinite())
      return make_issue(IssueCode::step_not_finite, "the motion of a step is not finite",
                        soft(index).name);
  for (const auto index : rigid_indices)
    if (is_movable(index) && !(rigid(index).free->shift + rigid(index).free->turn).allFinite())
      return make_issue(IssueCode::step_not_finite, "the motion of a step is not finite",
                        rigid(index).name);
  find_struck_bodies();
  measure_warping();
  for (const auto index : awake_soft) {
    soft(index).take_motion(rule(), body_steps[index].struck);
    // The past that BDF2 remembers would take a velocity that its motion does not show away again.
    if (body_steps[index].is_warped && settings.integrator == Integrator::implicit_euler)
      soft(index).give_back_momentum(settings.time_step_s);
    soft(index).remove_kinetic_energy(body_steps[index].warping_energy_j);
  }
  for_each_free_rigid([&](std::uint32_t index) { rigid(index).take_motion(settings.time_step_s); });
  for (Handle& handle : pins.handles) handle.now = handle.next;
  remember_contacts();
  time += settings.time_step_s;
  put_to_sleep();
  return {};
}

}  // namespace souple
