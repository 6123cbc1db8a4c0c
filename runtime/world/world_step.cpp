// SPDX-License-Identifier: MIT
// The phases of a step in their order (METHOD Alg. 11 and 14): detection, free motion, contact problem,
// correction; then the measurement of the laws.
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "runtime/world/world_state.hpp"

namespace souple {
namespace {

// Share of the body's longest side that the automatic alarm distance adds to what a step can travel.
constexpr double alarm_share = 0.01;

// Where a contact stands in a list of keys, ascending; nothing if it is new.
std::optional<std::size_t> place_of(const ContactKey& key, const std::vector<ContactKey>& keys) {
  const auto found = std::ranges::lower_bound(keys, key);
  if (found == keys.end() || *found != key) return std::nullopt;
  return std::size_t(found - keys.begin());
}

}  // namespace

Status World::State::compute_step(StepReport& report, PhaseClock& clock) {
  place_rigid_bodies();
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
    rigid_steps[index] = {&rigid(index), placement(rigid(index).pose_at(time)),
                          placement(rigid(index).pose_at(time + settings.time_step_s))};
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
  contacts.clear();
  if (soft_indices.size() > 1)
    for (const auto index : soft_indices) soft(index).surface.refit(soft(index).x);
  for (const auto a : soft_indices) {
    for (const auto b : rigid_indices) {
      const double speed = rigid_speed(rigid_steps[b], soft(a));
      detect_soft_rigid(a, soft(a), b, rigid_steps[b],
                        {alarm_distance(soft(a), speed), settings.friction}, contacts);
    }
    for (const auto b : soft_indices)
      if (a != b)
        detect_soft_soft(a, soft(a), b, soft(b),
                         {alarm_distance(soft(a), soft(b).largest_speed()), settings.friction},
                         contacts);
  }
  std::ranges::sort(contacts, {}, &Contact::key);
  leave_out_uncovered();
  describe_contacts();
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

// Forces of the contacts that persist, in their new frames: where the solver starts, and what the free
// motion already knows.
void World::State::recall_forces() {
  force.assign(3 * contacts.size(), 0.0);
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    const auto last = place_of(contacts[i].key, last_keys);
    if (last) Eigen::Map<Vec3>(force.data() + 3 * i) = frames[i].transpose() * last_forces[*last];
  }
  applied.assign(force.size(), 0.0);
  if (settings.feed_forward_forces) applied = force;
}

Status World::State::free_motion(StepReport& report) {
  for (const auto index : soft_indices) {
    SoftBody& body = soft(index);
    body.prepare_free_motion(settings.time_step_s, gravity);
    body_contacts[index].add_forces(frames, applied, body.load);
    if (!std::isfinite(body.load.norm()))
      return make_issue(IssueCode::step_not_finite, "the forces of a step are not finite", body.name);
    const auto solved = body.solve_free_motion(settings.time_step_s, settings.free_motion);
    report.free_motion_iterations += solved.iterations;
    report.free_motion_residual = std::max(report.free_motion_residual, solved.relative_residual);
  }
  return {};
}

// How far a contact opens along its normal in the free motion, m.
double World::State::normal_motion(std::size_t contact) const {
  const Contact& c = contacts[contact];
  Vec3 motion = -c.driven_motion;
  for (const auto& [side, sign] : {std::pair(&c.a, 1.0), std::pair(&c.b, -1.0)})
    for (std::size_t k = 0; k < std::size_t(side->count); ++k)
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

Status World::State::build_delassus() {
  delassus.assign(9 * contacts.size() * contacts.size(), 0.0);
  for (const auto index : soft_indices) {
    BodyContacts& body = body_contacts[index];
    if (body.empty()) continue;
    if (exact()) {
      if (!soft(index).factor->factorize(soft(index).tangent))
        return make_issue(IssueCode::step_not_finite, "the tangent is not positive definite",
                          soft(index).name);
      body.evaluate_exact(soft(index));
      body.add_exact(frames, delassus);
    } else {
      body.evaluate_warped(soft(index));
      body.add_warped(soft(index), relaxation, frames, delassus);
    }
  }
  mirror_delassus(contacts.size(), delassus);
  return {};
}

// The gap that no contact force would leave: q = gap + H dx - W f_applied.
void World::State::build_free_gap() {
  const std::size_t size = 3 * contacts.size();
  free_gap.assign(size, 0.0);
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    Eigen::Map<Vec3> g(free_gap.data() + 3 * i);
    g = -(frames[i].transpose() * contacts[i].driven_motion);
    g[0] += contacts[i].gap;
  }
  for (const auto index : soft_indices)
    body_contacts[index].add_motion(frames, soft(index).motion, free_gap);
  for (std::size_t k = 0; k < size; ++k) {
    if (applied[k] == 0) continue;
    for (std::size_t row = 0; row < size; ++row) free_gap[row] -= applied[k] * delassus[k * size + row];
  }
}

void World::State::correct() {
  change.resize(force.size());
  for (std::size_t k = 0; k < force.size(); ++k) change[k] = force[k] - applied[k];
  for (const auto index : soft_indices) {
    BodyContacts& body = body_contacts[index];
    if (body.empty()) continue;
    if (exact())
      body.correct_exact(soft(index), frames, change);
    else
      body.correct_warped(soft(index), relaxation, frames, change);
  }
}

// The motion that the forces so far cause by the present tangent, without the error of warping.
void World::State::make_motion_exact(StepReport& report) {
  for (const auto index : soft_indices) {
    if (body_contacts[index].empty()) continue;
    SoftBody& body = soft(index);
    body_contacts[index].add_forces(frames, change, body.load);
    const auto solved = body.solve_from_motion(settings.time_step_s, settings.free_motion);
    report.free_motion_iterations += solved.iterations;
    report.free_motion_residual = std::max(report.free_motion_residual, solved.relative_residual);
  }
  applied = force;
}

double World::State::change_norm() const {
  return Eigen::Map<const Eigen::VectorXd>(change.data(), Eigen::Index(change.size())).norm();
}

Status World::State::solve_contacts(StepReport& report, PhaseClock& clock) {
  if (auto status = build_delassus(); !status) return status;
  gap.resize(3 * contacts.size());
  double last_change = std::numeric_limits<double>::infinity();
  for (int pass = 0; pass < settings.contact_passes; ++pass) {
    if (pass > 0) {
      make_motion_exact(report);
      report.times.free_motion_s += clock.lap();
    }
    build_free_gap();
    report.times.compliance_s += clock.lap();
    report.contact_sweeps +=
        solve_frictional_contact(problem(), settings.contact_solver, force, gap).sweeps;
    report.times.contact_solve_s += clock.lap();
    correct();
    report.times.correction_s += clock.lap();
    // Where the true compliance is more than twice the warped one, passes overshoot.
    if (pass > 0 && change_norm() > last_change) break;
    last_change = pass > 0 ? change_norm() : last_change;
  }
  return {};
}

// Near rest the forces obey e <- (1 - W_warped^-1 W_true) e from step to step, which grows where
// warping makes a folded body more than twice too stiff. The last two changes of the forces show the
// factor; the warped compliance is then made softer by as much as takes it to zero. Only what changes
// is affected: at rest the forces stay exact. While the forces still change much, as in an impact,
// nothing is relaxed.
void World::State::choose_relaxation() {
  constexpr double near_rest = 0.1, overshoot = -1.05, fading = 0.98, softest = 10;
  double product = 0, last2 = 0, force2 = 0;
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    force2 += Eigen::Map<const Vec3>(force.data() + 3 * i).squaredNorm();
    const auto last = place_of(contacts[i].key, last_keys);
    if (!last) continue;
    const Vec3 changed = frames[i] * Eigen::Map<const Vec3>(force.data() + 3 * i) - last_forces[*last];
    product += changed.dot(last_changes[*last]);
    last2 += last_changes[*last].squaredNorm();
  }
  if (last2 > near_rest * near_rest * force2) {
    relaxation = 1;
    growing_steps = 0;
    return;
  }
  if (!(last2 > 0)) return;
  // One step of growth is also what a body shows that is just being loaded; three in a row are not.
  const double factor = product / last2;
  growing_steps = factor < overshoot ? growing_steps + 1 : 0;
  relaxation = growing_steps >= 3 ? std::min(softest, relaxation * (1 - factor))
                                  : std::max(1.0, fading * relaxation);
}

void World::State::remember_contacts() {
  const bool stabilised = settings.feed_forward_forces && !exact();
  if (stabilised) choose_relaxation();
  std::swap(last_keys, earlier_keys);
  std::swap(last_forces, earlier_forces);
  last_changes.clear();
  last_keys.clear();
  last_forces.clear();
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    const Vec3 now = frames[i] * Eigen::Map<const Vec3>(force.data() + 3 * i);
    const auto earlier = place_of(contacts[i].key, earlier_keys);
    last_changes.push_back(earlier ? Vec3(now - earlier_forces[*earlier]) : now);
    last_keys.push_back(contacts[i].key);
    last_forces.push_back(now);
  }
}

// Takes over the motion only if all of it is finite.
Status World::State::commit() {
  for (const auto index : soft_indices)
    if (!soft(index).motion.allFinite())
      return make_issue(IssueCode::step_not_finite, "the motion of a step is not finite",
                        soft(index).name);
  for (const auto index : soft_indices) {
    SoftBody& body = soft(index);
    body.x += body.motion;
    body.v = body.motion / settings.time_step_s;
  }
  remember_contacts();
  time += settings.time_step_s;
  return {};
}

void World::State::measure(StepReport& report) {
  report.contact_residual = contacts.empty() ? 0 : natural_map_residual(problem(), force);
  report.cone_violation = cone_violation(friction, force);
  for (const auto index : soft_indices) {
    SoftBody& body = soft(index);
    report.kinetic_energy_j += body.kinetic_energy();
    report.elastic_energy_j += body.elastic_energy();
    report.potential_energy_j += body.potential_energy(gravity);
    for (const auto other : rigid_indices) {
      const RigidStep& step = rigid_steps[other];
      report.worst_penetration_m =
          std::max(report.worst_penetration_m, node_depth(body, step.body->shape, step.end));
      report.worst_surface_depth_m =
          std::max(report.worst_surface_depth_m, surface_depth(body, step.body->shape, step.end));
    }
  }
  for (std::size_t i = 0; i < contacts.size(); ++i)
    if (contacts[i].b.count > 0)
      report.worst_penetration_m = std::max(report.worst_penetration_m, -gap[3 * i]);
  report.worst_surface_depth_m = std::max(report.worst_surface_depth_m, report.worst_penetration_m);
}

}  // namespace souple
