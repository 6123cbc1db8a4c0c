// SPDX-License-Identifier: MIT
// The contact problem of a step and the correction of the motion (METHOD Alg. 13 and 14).
#include <algorithm>
#include <cmath>
#include <limits>

#include "runtime/world/world_state.hpp"

namespace souple {

namespace {

// An impact is over within so many steps; a force that lasts has been there in all of them.
Vec3 least_of(const std::array<Vec3, 3>& course) {
  return *std::ranges::min_element(course, {}, [](const Vec3& f) { return f.squaredNorm(); });
}

}  // namespace

// Forces of the contacts that persist, in their new frames: where the solver starts, and what the free
// motion already knows of them.
void World::State::recall_forces() {
  force.assign(3 * contacts.size(), 0.0);
  applied.assign(force.size(), 0.0);
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    const ContactMemory* last = memory.find(contacts[i].key);
    if (!last) continue;
    Eigen::Map<Vec3>(force.data() + 3 * i) = contacts[i].frame.transpose() * last->force;
    if (settings.feed_forward_forces)
      Eigen::Map<Vec3>(applied.data() + 3 * i) = contacts[i].frame.transpose() * last->lasting;
  }
}

Status World::State::build_delassus() {
  for_each_soft([&](std::uint32_t index) {
    BodyContacts& own = body_contacts[index];
    SoftBody& body = soft(index);
    if (own.empty()) return;
    if (!exact()) {
      own.evaluate_warped(body);
      own.build_warped(body, body.stabilisation.relaxation);
      return;
    }
    body_steps[index].sound = body.make_inverse();
    if (!body_steps[index].sound) return;
    own.evaluate_exact(body);
    own.build_exact();
  });
  islands.build(contacts, bodies.size(), [&](std::uint32_t index) { return is_movable(index); });
  contact_operator.begin(contacts.size());
  for (const auto index : awake_soft) {
    if (!body_steps[index].sound)
      return make_issue(IssueCode::step_not_finite, "the tangent is not positive definite",
                        soft(index).name);
    contact_operator.add(body_contacts[index]);
  }
  for_each_free_rigid([&](std::uint32_t index) {
    rigid_contacts[index].collect(index, rigid(index), contacts, contacts_of_body[index]);
    contact_operator.add(rigid_contacts[index]);
  });
  return {};
}

// The gap that no contact force would leave: q = gap + H dx - W f, f the forces whose motion dx holds.
void World::State::build_free_gap() {
  free_gap.assign(3 * contacts.size(), 0.0);
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    const Contact& c = contacts[i];
    Eigen::Map<Vec3> g(free_gap.data() + 3 * i);
    g = -(c.frame.transpose() * c.driven_motion) + Vec3(c.gap, c.offset[0], c.offset[1]);
    for (const auto& [side, sign] : {std::pair(&c.a, 1.0), std::pair(&c.b, -1.0)})
      if (side->body != ContactSide::no_body && side->count == 0 && is_movable(side->body))
        g += sign * (c.frame.transpose() * rigid(side->body).free->motion_of(side->arm));
  }
  for (const auto index : awake_soft) body_contacts[index].add_motion(soft(index).motion, free_gap);
  for (std::size_t i = 0; i < contacts.size(); ++i) contact_operator.clear_gap(i);
  for (std::size_t i = 0; i < contacts.size(); ++i)
    if (!at(included, i).isZero(0)) contact_operator.add_to_base(i, at(included, i));
  for (std::size_t i = 0; i < contacts.size(); ++i)
    Eigen::Map<Vec3>(free_gap.data() + 3 * i) -= contact_operator.gap(i);
  shift_free_gaps();
}

Vec3 World::State::velocity_of(const ContactSide& side) const {
  Vec3 velocity = Vec3::Zero();
  if (side.body == ContactSide::no_body) return velocity;
  if (side.count == 0 && rigid(side.body).free)
    return rigid(side.body).free->velocity + rigid(side.body).free->spin.cross(side.arm);
  for (std::size_t k = 0; k < std::size_t(side.count); ++k)
    velocity += side.weight[k] * node_entry(soft(side.body).v, side.node[k]);
  return velocity;
}

// At the start of the step, m/s.
double World::State::approach_speed(const Contact& c) const {
  const Vec3 relative = velocity_of(c.a) - velocity_of(c.b) - c.driven_motion / settings.time_step_s;
  return -c.frame.col(0).dot(relative);
}

// Newton's law of impact: a contact that would close in this step has to open by e times the speed with
// which it approached, from where it is. Slower than what weight gives in two steps is no impact: what
// rests would be shaken.
double World::State::restitution_of(std::size_t contact) const {
  const Contact& c = contacts[contact];
  if (c.restitution == 0 || free_gap[3 * contact] >= 0) return 0;
  const double h = settings.time_step_s, speed = approach_speed(c);
  return speed > 2 * h * gravity.norm() ? std::max(c.gap, 0.0) + c.restitution * h * speed : 0;
}

// What the law is not asked for in this step: a bounce more, or less of a deep overlap. All of that at
// once would throw the bodies apart by depth / h; it is undone at a bounded speed.
void World::State::shift_free_gaps() {
  constexpr double sides_per_second = 1;
  shift.assign(contacts.size(), 0.0);
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    const Contact& c = contacts[i];
    if (c.law.kind != ConstraintLaw::Kind::frictional) continue;
    const double recovered = sides_per_second * settings.time_step_s * smaller_size(c.key);
    shift[i] = c.gap < -recovered ? c.gap + recovered : restitution_of(i);
    free_gap[3 * i] -= shift[i];
  }
}

namespace {

// Natural map over the norm of the forces.
template <ContactOperator Operator>
double law_residual(const Operator& rows, const std::vector<LocalLaw>& laws,
                    std::span<const double> force) {
  double residual2 = 0, force2 = 0;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (!laws[i].movable()) continue;
    const Eigen::Map<const Vec3> f(&force[3 * i]);
    residual2 += laws[i].natural_map(rows.gap(i), f).squaredNorm();
    force2 += f.squaredNorm();
  }
  return std::sqrt(force2 > 0 ? residual2 / force2 : residual2);
}

// Both goals as one number that has to fall to the tolerance.
template <ContactOperator Operator>
double unsolved_part(const Operator& rows, const std::vector<LocalLaw>& laws,
                     std::span<const double> force, const ContactSolverSettings& settings) {
  const double residual = law_residual(rows, laws, force);
  if (settings.penetration_m == 0) return residual;
  double deepest = 0;
  for (std::size_t i = 0; i < rows.size(); ++i)
    if (laws[i].movable() && !laws[i].bilateral()) deepest = std::max(deepest, -rows.gap(i)[0]);
  return std::max(residual, settings.tolerance * deepest / settings.penetration_m);
}

constexpr int most_plain_sweeps = 48;

// Warm starts take a few plain sweeps; what is left after many is worth the acceleration: tall stacks,
// chains of joints, mass ratios.
template <ContactOperator Operator>
ContactSolveReport solve_rows(Operator& rows, std::span<const ConstraintLaw> laws,
                              const ContactSolverSettings& settings, std::span<double> force,
                              AcceleratedWork& solver, int plain_sweeps) {
  ContactSolverSettings plain = settings;
  plain.max_sweeps = std::min(plain.max_sweeps, plain_sweeps);
  const ContactSolveReport first = solve_by_gauss_seidel(rows, laws, plain, force, solver.sweeps);
  if (first.converged || settings.max_sweeps <= plain_sweeps) return first;
  ContactSolverSettings rest_of_them = settings;
  rest_of_them.max_sweeps -= plain_sweeps;
  ContactSolveReport report = solve_by_accelerated_gauss_seidel(
      rows, laws, rest_of_them, force, solver,
      [&](const Operator& op, std::span<const double> trial) {
        return unsolved_part(op, solver.sweeps.laws, trial, settings);
      },
      [] { return false; });
  report.sweeps += first.sweeps;
  return report;
}

// Sweeps over all contacts find which ones bear forces, and verify; those between are over these alone.
// A core that is not solved by half of the sweeps left is chosen anew, for as long as there are any.
ContactSolveReport solve_by_core(IslandOperator& rows, const ContactSolverSettings& settings,
                                 IslandWork& work) {
  constexpr int most_rounds = 8, finding_sweeps = 8;
  int sweeps = 0;
  ContactSolverSettings rest = settings;
  const auto count = [&](ContactSolveReport report) {
    sweeps += report.sweeps;
    rest.max_sweeps = settings.max_sweeps - sweeps;
    report.sweeps = sweeps;
    return report;
  };
  for (int round = 0; round < most_rounds && rest.max_sweeps > finding_sweeps; ++round) {
    ContactSolverSettings finding = rest;
    finding.max_sweeps = finding_sweeps;
    ContactSolveReport found =
        count(solve_by_gauss_seidel(rows, work.laws, finding, work.force, work.solver.sweeps));
    if (found.converged) return found;
    found.residual = unsolved_part(rows, work.solver.sweeps.laws, work.force, settings);
    found.converged = round > 0 && found.residual <= settings.tolerance;
    if (found.converged) return found;
    ActiveCore& core = work.core;
    if (!core.take(rows, work.laws, work.force)) break;
    ContactSolverSettings half = rest;
    half.max_sweeps /= 2;
    count(solve_rows(core.rows(), core.laws(), half, core.force(), core.solver(), most_plain_sweeps));
    core.give_back(work.force);
  }
  return count(
      solve_rows(rows, work.laws, rest, work.force, work.solver, most_plain_sweeps - finding_sweeps));
}

}  // namespace

void World::State::solve_island(std::size_t island) {
  IslandWork& work = island_work[island];
  const auto own = islands.contacts(island);
  work.force.resize(3 * own.size());
  work.laws.clear();
  for (std::size_t k = 0; k < own.size(); ++k) {
    std::copy_n(force.begin() + std::ptrdiff_t(3 * own[k]), 3,
                work.force.begin() + std::ptrdiff_t(3 * k));
    work.laws.push_back(laws[own[k]]);
  }
  IslandOperator rows(contact_operator, own, free_gap);
  work.report = solve_by_core(rows, settings.contact_solver, work);
  for (std::size_t k = 0; k < own.size(); ++k) {
    std::copy_n(work.force.begin() + std::ptrdiff_t(3 * k), 3,
                force.begin() + std::ptrdiff_t(3 * own[k]));
    Eigen::Map<Vec3> u(gap.data() + 3 * own[k]);
    u = rows.gap(k);
    u[0] += shift[own[k]];
  }
}

// Bodies that do not touch never meet in one problem.
void World::State::solve_islands(StepReport& report) {
  if (island_work.size() < islands.count()) island_work.resize(islands.count());
  const auto job = [&](std::size_t island) { solve_island(island); };
  run(islands.count(), job);
  int sweeps = 0;
  for (std::size_t k = 0; k < islands.count(); ++k)
    sweeps = std::max(sweeps, island_work[k].report.sweeps);
  report.contact_sweeps += sweeps;
}

// Forces on free rigid bodies, 3 per contact in its frame.
void World::State::push_rigid_bodies(const std::vector<double>& forces) {
  for_each_free_rigid([&](std::uint32_t index) {
    for (const std::uint32_t i : contacts_of_body[index]) {
      const Vec3 f = contacts[i].frame * at(forces, i);
      if (contacts[i].a.body == index) rigid(index).push(f, contacts[i].a.arm);
      if (contacts[i].b.body == index) rigid(index).push(-f, contacts[i].b.arm);
    }
  });
}

void World::State::correct() {
  change.resize(force.size());
  for (std::size_t k = 0; k < force.size(); ++k) change[k] = force[k] - included[k];
  included = force;
  for_each_soft([&](std::uint32_t index) {
    BodyContacts& own = body_contacts[index];
    if (own.empty()) return;
    if (exact())
      own.correct_exact(soft(index), change);
    else
      own.correct_warped(soft(index), soft(index).stabilisation.relaxation, change);
  });
  push_rigid_bodies(change);
}

// The motion that the forces so far cause by the present tangent, without the error of warping.
Status World::State::make_motion_exact(StepReport& report) {
  for (std::size_t k = 0; k < force.size(); ++k) change[k] = force[k] - applied[k];
  for_each_soft([&](std::uint32_t index) {
    BodyStep& result = body_steps[index];
    result.solved = {.converged = true};
    if (body_contacts[index].empty()) return;
    SoftBody& body = soft(index);
    body_contacts[index].add_forces(change, body.load);
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

double World::State::force_norm() const {
  return Eigen::Map<const Eigen::VectorXd>(force.data(), Eigen::Index(force.size())).norm();
}

// One contact solve; more where its correction closes contacts that were put off.
Status World::State::solve_pass(StepReport& report, PhaseClock& clock) {
  constexpr int most_rounds = 4;
  for (int round = 0; round < most_rounds; ++round) {
    if (round > 0) {
      if (!add_missing(round == 1)) break;
      if (auto status = check_ready(); !status) return status;
      if (auto status = build_delassus(); !status) return status;
    }
    gap.resize(3 * contacts.size());
    build_free_gap();
    report.times.compliance_s += clock.lap();
    solve_islands(report);
    report.times.contact_solve_s += clock.lap();
    correct();
    report.times.correction_s += clock.lap();
  }
  return {};
}

Status World::State::solve_contacts(StepReport& report, PhaseClock& clock) {
  if (auto status = build_delassus(); !status) return status;
  included = applied;
  constexpr double settled = 1e-3;  // of the forces: warping errs by a share of their change alone
  double last_change = std::numeric_limits<double>::infinity();
  for (int pass = 0; pass < settings.contact_passes; ++pass) {
    if (pass > 0) {
      if (auto status = make_motion_exact(report); !status) return status;
      report.times.free_motion_s += clock.lap();
    }
    if (auto status = solve_pass(report, clock); !status) return status;
    // Where the true compliance is more than twice the warped one, passes overshoot.
    if (change_norm() <= settled * force_norm() || (pass > 0 && change_norm() > last_change)) break;
    last_change = pass > 0 ? change_norm() : last_change;
  }
  report.island_count = islands.count();
  return {};
}

// Near rest the forces obey e <- (1 - W_warped^-1 W_true) e from step to step, which grows where
// warping makes a folded body more than twice too stiff. The last two changes of its forces show the
// factor; its warped compliance is then made softer by as much as takes it to zero. Only what changes
// is affected: at rest the forces stay exact. While the forces still change much, as in an impact,
// nothing is relaxed.
void World::State::choose_relaxation(std::uint32_t index) {
  constexpr double near_rest = 0.1, overshoot = -1.05, fading = 0.98, softest = 10;
  Stabilisation& s = soft(index).stabilisation;
  double product = 0, last2 = 0, force2 = 0;
  for (const std::uint32_t i : contacts_of_body[index]) {
    force2 += at(force, i).squaredNorm();
    const ContactMemory* last = memory.find(contacts[i].key);
    if (!last) continue;
    const Vec3 changed = contacts[i].frame * at(force, i) - last->force;
    product += changed.dot(last->change);
    last2 += last->change.squaredNorm();
  }
  if (last2 > near_rest * near_rest * force2) {
    s = {};
    return;
  }
  if (!(last2 > 0)) return;
  // One step of growth is also what a body shows that is just being loaded; three in a row are not.
  const double factor = product / last2;
  s.growing_steps = factor < overshoot ? s.growing_steps + 1 : 0;
  s.relaxation = s.growing_steps >= 3 ? std::min(softest, s.relaxation * (1 - factor))
                                      : std::max(1.0, fading * s.relaxation);
}

// Bodies whose contact forces changed by more than a small share: in a smooth motion the change is of
// the order of h and falls below any share, in an impact it does not. Both that are wrongly taken for
// the other are harmless: what is smooth then loses an order, and what is an impulse of so small a
// share bounces by as little.
void World::State::find_struck_bodies() {
  constexpr double share = 0.05;
  for (const auto index : awake_soft) {
    BodyStep& result = body_steps[index];
    result.struck = false;
    if (settings.integrator != Integrator::bdf2) continue;
    double total = 0, changed = 0;
    for (const std::uint32_t i : contacts_of_body[index]) {
      total += at(force, i).squaredNorm();
      changed += (at(force, i) - at(applied, i)).squaredNorm();
    }
    result.struck = changed > share * share * total;
  }
}

// Forces that the next step had better not count on.
bool World::State::is_impact(std::uint32_t body) const {
  return body != ContactSide::no_body && (body_steps[body].struck || body_steps[body].is_warping_wild);
}

void World::State::remember_contacts() {
  if (settings.feed_forward_forces && settings.contact_method == ContactMethod::warped)
    for (const auto index : awake_soft) choose_relaxation(index);
  std::swap(memory, earlier);
  auto& now = memory.entries();
  now.clear();
  for (const ContactMemory& m : earlier.entries())
    if (sleeps_on(m.key.body_a, m.key.body_b)) now.push_back(m);
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    const Contact& c = contacts[i];
    const ContactMemory* before = earlier.find(c.key);
    ContactMemory m{.key = c.key, .force = c.frame * at(force, i)};
    m.change = before ? Vec3(m.force - before->force) : m.force;
    m.course[0] = m.force;
    if (before) std::copy_n(before->course.begin(), 2, m.course.begin() + 1);
    m.lasting = is_impact(c.a.body) || is_impact(c.b.body) ? least_of(m.course) : m.force;
    now.push_back(m);
  }
  std::ranges::sort(now, {}, &ContactMemory::key);
  events.update(contacts, force, [&](std::uint32_t a, std::uint32_t b) { return sleeps_on(a, b); });
}

}  // namespace souple
