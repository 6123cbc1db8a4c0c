// SPDX-License-Identifier: MIT
// The contact problem of a step and the correction of the motion (METHOD Alg. 13 and 14).
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "runtime/world/world_state.hpp"

namespace souple {

namespace {

// Where a contact stands in a list of keys, ascending; nothing if it is new.
std::optional<std::size_t> place_of(const ContactKey& key, const std::vector<ContactKey>& keys) {
  const auto found = std::ranges::lower_bound(keys, key);
  if (found == keys.end() || *found != key) return std::nullopt;
  return std::size_t(found - keys.begin());
}

// An impact is over within so many steps; a force that lasts has been there in all of them.
Vec3 least_of(const std::array<Vec3, 3>& course) {
  return *std::ranges::min_element(course, {}, [](const Vec3& f) { return f.squaredNorm(); });
}

bool touches(const Contact& contact, std::uint32_t body) {
  return contact.a.body == body || contact.b.body == body;
}

}  // namespace

// Forces of the contacts that persist, in their new frames: where the solver starts, and what the free
// motion already knows of them.
void World::State::recall_forces() {
  force.assign(3 * contacts.size(), 0.0);
  applied.assign(force.size(), 0.0);
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    const auto last = place_of(contacts[i].key, last_keys);
    if (!last) continue;
    Eigen::Map<Vec3>(force.data() + 3 * i) = frames[i].transpose() * last_forces[*last];
    if (settings.feed_forward_forces)
      Eigen::Map<Vec3>(applied.data() + 3 * i) = frames[i].transpose() * last_lasting[*last];
  }
}

Status World::State::build_delassus() {
  delassus.assign(9 * contacts.size() * contacts.size(), 0.0);
  for_each_soft([&](std::uint32_t index) {
    BodyContacts& body = body_contacts[index];
    if (body.empty()) return;
    if (!exact()) return body.evaluate_warped(soft(index));
    body_steps[index].sound = soft(index).factor->factorize(soft(index).tangent);
    if (body_steps[index].sound) body.evaluate_exact(soft(index));
  });
  for (const auto index : soft_indices) {
    BodyContacts& body = body_contacts[index];
    if (body.empty()) continue;
    if (!body_steps[index].sound)
      return make_issue(IssueCode::step_not_finite, "the tangent is not positive definite",
                        soft(index).name);
    if (exact())
      body.add_exact(frames, delassus);
    else
      body.add_warped(soft(index), relaxation, frames, delassus);
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
  for_each_soft([&](std::uint32_t index) {
    BodyContacts& body = body_contacts[index];
    if (body.empty()) return;
    if (exact())
      body.correct_exact(soft(index), frames, change);
    else
      body.correct_warped(soft(index), relaxation, frames, change);
  });
}

// The motion that the forces so far cause by the present tangent, without the error of warping.
Status World::State::make_motion_exact(StepReport& report) {
  for_each_soft([&](std::uint32_t index) {
    BodyStep& result = body_steps[index];
    result.solved = {.converged = true};
    if (body_contacts[index].empty()) return;
    SoftBody& body = soft(index);
    body_contacts[index].add_forces(frames, change, body.load);
    result.sound = std::isfinite(body.load.norm());
    if (result.sound)
      result.solved = body.solve_from_motion(settings.time_step_s, settings.free_motion);
  });
  applied = force;
  return report_solves(report);
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
      if (auto status = make_motion_exact(report); !status) return status;
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

// Bodies whose contact forces changed by more than a small share: in a smooth motion the change is of
// the order of h and falls below any share, in an impact it does not. Both that are wrongly taken for
// the other are harmless: what is smooth then loses an order, and what is an impulse of so small a
// share bounces by as little.
void World::State::find_struck_bodies() {
  constexpr double share = 0.05;
  for (const auto index : soft_indices) body_steps[index].struck = false;
  if (settings.integrator != Integrator::bdf2) return;
  for (const auto index : soft_indices) {
    double total = 0, changed = 0;
    for (std::size_t i = 0; i < contacts.size(); ++i) {
      if (!touches(contacts[i], index)) continue;
      const Eigen::Map<const Vec3> now(force.data() + 3 * i), before(applied.data() + 3 * i);
      total += now.squaredNorm();
      changed += (now - before).squaredNorm();
    }
    body_steps[index].struck = changed > share * share * total;
  }
}

// Forces that the next step had better not count on.
bool World::State::is_impact(std::uint32_t body) const {
  return body_steps[body].struck || body_steps[body].is_warping_wild;
}

void World::State::remember_contacts() {
  const bool stabilised = settings.feed_forward_forces && !exact();
  if (stabilised) choose_relaxation();
  std::swap(last_keys, earlier_keys);
  std::swap(last_forces, earlier_forces);
  std::swap(last_courses, earlier_courses);
  last_changes.clear();
  last_keys.clear();
  last_forces.clear();
  last_courses.clear();
  last_lasting.clear();
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    const Vec3 now = frames[i] * Eigen::Map<const Vec3>(force.data() + 3 * i);
    const auto earlier = place_of(contacts[i].key, earlier_keys);
    last_changes.push_back(earlier ? Vec3(now - earlier_forces[*earlier]) : now);
    last_keys.push_back(contacts[i].key);
    last_forces.push_back(now);
    const bool passing = is_impact(contacts[i].a.body) || is_impact(contacts[i].b.body);
    std::array<Vec3, 3> course{now, Vec3::Zero(), Vec3::Zero()};
    if (earlier) std::copy_n(earlier_courses[*earlier].begin(), 2, course.begin() + 1);
    last_courses.push_back(course);
    last_lasting.push_back(passing ? least_of(course) : now);
  }
}

}  // namespace souple
