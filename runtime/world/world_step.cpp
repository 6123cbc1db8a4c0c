// SPDX-License-Identifier: MIT
// The phases of a step in their order (METHOD Alg. 11 and 14): detection, free motion, contact problem,
// correction. What is done for every body by itself runs as jobs of the application; results are put
// together in the order of the bodies, so that they are the same bits however the jobs ran.
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "runtime/world/rigid_path.hpp"
#include "runtime/world/world_state.hpp"

namespace souple {
namespace {

// Share of the body's longest side that the automatic alarm distance adds to what a step can travel.
constexpr double alarm_share = 0.01;

}  // namespace

Status World::State::compute_step(StepReport& report, PhaseClock& clock) {
  place_rigid_bodies();
  for (const auto index : soft_indices) soft(index).prescribe_motion(rule());
  detect();
  ask_ahead();
  report.times.collision_s = clock.lap();
  recall_forces();
  if (auto status = free_motion(report); !status) return status;
  discard_distant();
  if (auto status = check_ready(); !status) return status;
  report.times.free_motion_s = clock.lap();
  if (!contacts.empty())
    if (auto status = solve_contacts(report, clock); !status) return status;
  return commit();
}

void World::State::place_rigid_bodies() {
  for (const auto index : rigid_indices)
    rigid_steps[index] = {&rigid(index), placement(pose_at(rigid(index).path, time)),
                          placement(pose_at(rigid(index).path, time + settings.time_step_s))};
}

// Below this gap two bodies may meet within the step.
double World::State::alarm_distance(const SoftBody& soft_body, double other_speed) const {
  if (settings.alarm_distance_m > 0) return settings.alarm_distance_m;
  const double h = settings.time_step_s;
  return alarm_share * soft_body.asset->longest_side_m() + gravity.norm() * h * h +
         2 * h * (soft_body.largest_speed() + other_speed);
}

double World::State::rigid_speed(const RigidStep& step, const SoftBody& soft_body) const {
  Eigen::AlignedBox3d box;
  for (const Index node : soft_body.asset->surface().nodes())
    box.extend(Vec3(node_entry(soft_body.x, node)));
  double motion = 0;
  for (int k = 0; k < 8; ++k)
    motion = std::max(motion, step.motion_of(box.corner(Eigen::AlignedBox3d::CornerType(k))).norm());
  return motion / settings.time_step_s;
}

void World::State::detect() {
  if (soft_indices.size() > 1)
    for_each_soft([&](std::uint32_t index) { soft(index).surface.refit(soft(index).x); });
  for_each_soft([&](std::uint32_t index) { detect_of(index, body_steps[index].found); });
  contacts.clear();
  for (const auto index : soft_indices) {
    const auto& found = body_steps[index].found;
    contacts.insert(contacts.end(), found.begin(), found.end());
  }
  for (Contact& contact : contacts) add_driven_motion(contact);
  std::ranges::sort(contacts, {}, &Contact::key);
  leave_out_uncovered();
  describe_contacts();
}

// Contacts of the nodes of one body with all others.
void World::State::detect_of(std::uint32_t a, std::vector<Contact>& found) const {
  found.clear();
  for (const auto b : rigid_indices) {
    const PairRule rule = pair(a, b);
    if (!rule.collides) continue;
    const double speed = rigid_speed(rigid_steps[b], soft(a));
    detect_soft_rigid(a, soft(a), b, rigid_steps[b], {alarm_distance(soft(a), speed), rule.friction},
                      found);
  }
  for (const auto b : soft_indices) {
    if (a == b) continue;
    const PairRule rule = pair(a, b);
    if (rule.collides)
      detect_soft_soft(a, soft(a), b, soft(b),
                       {alarm_distance(soft(a), soft(b).largest_speed()), rule.friction}, found);
  }
}

// Driven nodes of soft bodies move a contact as a rigid body's points do.
void World::State::add_driven_motion(Contact& contact) const {
  for (const auto& [side, sign] : {std::pair(&contact.a, -1.0), std::pair(&contact.b, 1.0)})
    for (std::size_t k = 0; k < std::size_t(side->count); ++k)
      if (const SoftBody& body = soft(side->body); !body.driven.empty())
        contact.driven_motion += sign * side->weight[k] * node_entry(body.prescribed, side->node[k]);
}

// A compliance may be limited to the region of a body that is meant to be touched.
void World::State::leave_out_uncovered() {
  const auto is_covered = [&](const ContactSide& side) {
    if (side.count == 0 || !soft(side.body).compliance) return true;
    for (std::size_t k = 0; k < std::size_t(side.count); ++k)
      if (!soft(side.body).is_fixed[std::size_t(side.node[k])] &&
          soft(side.body).compliance->row_of_node[std::size_t(side.node[k])] < 0)
        return false;
    return true;
  };
  uncovered =
      std::erase_if(contacts, [&](const Contact& c) { return !is_covered(c.a) || !is_covered(c.b); });
}

// All that may touch soon is asked for, so that a streaming source can fetch it in time.
void World::State::ask_ahead() const {
  if (exact()) return;
  for (const auto index : soft_indices)
    if (!body_contacts[index].empty()) (void)body_contacts[index].ready(soft(index));
}

Status World::State::check_ready() const {
  if (exact()) return {};
  for (const auto index : soft_indices)
    if (!body_contacts[index].empty() && !body_contacts[index].ready(soft(index)))
      return make_issue(IssueCode::compliance_not_loaded,
                        "a body touches with nodes whose compliance has not been read yet",
                        soft(index).name);
  return {};
}

void World::State::forget_contacts() {
  contacts.clear();
  frames.clear();
  for (auto* list : {&delassus, &free_gap, &friction, &force, &gap, &applied, &change}) list->clear();
}

// The state stays; of BDF2's history what was begun in this step is forgotten with it.
void World::State::give_up() {
  forget_contacts();
  for (const auto index : soft_indices)
    if (soft(index).history.begun) soft(index).history.valid = false;
}

// What follows from the list of contacts.
void World::State::describe_contacts() {
  frames.clear();
  friction.clear();
  for (const Contact& contact : contacts) {
    frames.push_back(contact.frame);
    friction.push_back(contact.friction);
  }
  for (const auto index : soft_indices) body_contacts[index].collect(index, soft(index), contacts);
}

Status World::State::free_motion(StepReport& report) {
  for_each_soft([&](std::uint32_t index) {
    SoftBody& body = soft(index);
    body.prepare_free_motion(rule());
    if (body.lacks_history(rule())) {
      body_contacts[index].add_forces(frames, applied, body.begin_history());
      body.start_history(rule(), settings.free_motion);
    }
    body_contacts[index].add_forces(frames, applied, body.load);
    body.add_inertia(rule());
    BodyStep& result = body_steps[index];
    result.sound = std::isfinite(body.load.norm());
    if (result.sound) result.solved = body.solve_free_motion(rule(), settings.free_motion);
  });
  return report_solves(report);
}

Status World::State::report_solves(StepReport& report) const {
  for (const auto index : soft_indices) {
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

// How far a contact opens along its normal in the free motion, m.
double World::State::normal_motion(std::size_t contact) const {
  const Contact& c = contacts[contact];
  Vec3 motion = -c.driven_motion;
  for (const auto& [side, sign] : {std::pair(&c.a, 1.0), std::pair(&c.b, -1.0)})
    for (std::size_t k = 0; k < std::size_t(side->count); ++k)
      if (!soft(side->body).is_fixed[std::size_t(side->node[k])])
        motion += sign * side->weight[k] * node_entry(soft(side->body).motion, side->node[k]);
  return c.frame.col(0).dot(motion);
}

// The alarm distance covers whatever a step may bring; after the free motion most of those contacts are
// known to stay apart. Kept are those that carry force, and those that end so near that the correction
// may close them: stopping a body changes the motion of a step by about as much as the body moved.
void World::State::discard_distant() {
  double moved = 0;
  if (!contacts.empty())
    for (const auto index : soft_indices)
      moved = std::max(moved, settings.time_step_s * soft(index).largest_speed());
  std::size_t kept = 0;
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    const double margin = settings.alarm_distance_m > 0
                              ? settings.alarm_distance_m
                              : alarm_share * soft(contacts[i].a.body).asset->longest_side_m() + moved;
    const Eigen::Map<const Vec3> carried(force.data() + 3 * i);
    if (carried.isZero(0) && contacts[i].gap + normal_motion(i) > margin) continue;
    contacts[kept] = contacts[i];
    for (std::size_t k = 0; k < 3; ++k) {
      force[3 * kept + k] = force[3 * i + k];
      applied[3 * kept + k] = applied[3 * i + k];
    }
    ++kept;
  }
  if (kept == contacts.size()) return;
  contacts.erase(contacts.begin() + std::ptrdiff_t(kept), contacts.end());
  force.resize(3 * kept);
  applied.resize(3 * kept);
  describe_contacts();
}

// Takes over the motion only if all of it is finite.
Status World::State::commit() {
  for (const auto index : soft_indices)
    if (!soft(index).motion.allFinite())
      return make_issue(IssueCode::step_not_finite, "the motion of a step is not finite",
                        soft(index).name);
  find_struck_bodies();
  measure_warping();
  for (const auto index : soft_indices) {
    soft(index).take_motion(rule(), body_steps[index].struck);
    soft(index).remove_kinetic_energy(body_steps[index].warping_energy_j);
  }
  remember_contacts();
  time += settings.time_step_s;
  return {};
}

}  // namespace souple
