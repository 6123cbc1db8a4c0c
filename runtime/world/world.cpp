// SPDX-License-Identifier: MIT
#include "runtime/world/world.hpp"

#include <algorithm>
#include <cmath>

#include "runtime/collision/ray_pick.hpp"
#include "runtime/world/checks.hpp"
#include "runtime/world/rigid_path.hpp"
#include "runtime/world/world_state.hpp"

namespace souple {
namespace {

static_assert(sizeof(Point) == 3 * sizeof(double));

std::span<const Point> as_points(const Eigen::VectorXd& v) {
  return {reinterpret_cast<const Point*>(v.data()), std::size_t(v.size()) / 3};
}

}  // namespace

World::World(std::unique_ptr<State> state) : state_(std::move(state)) {}
World::World(World&&) noexcept = default;
World& World::operator=(World&&) noexcept = default;
World::~World() = default;

Result<World> World::create(const WorldSettings& settings) {
  if (auto status = check_settings(settings); !status) return status.issue();
  return World(std::make_unique<State>(settings));
}

Result<BodyId> World::add_soft_body(std::shared_ptr<const SoftBodyAsset> asset,
                                    const SoftBodyDescription& description) {
  if (auto status = check_soft_body(description); !status) return status.issue();
  State& s = *state_;
  SoftBody body(std::move(asset), description.name);
  body.filter = description.filter;
  body.self_contact = description.self_contact;
  if (auto status = hold_fixed_set(body, description.fixed_set); !status) return status.issue();
  if (auto status = drive_nodes(body, description); !status) return status.issue();
  if (auto status = prepare_integrator(body, s.settings); !status) return status.issue();
  if (auto status = s.solvers.prepare(body, s.settings); !status) return status.issue();
  if (auto status = prepare_contact_method(body, s.settings, description.fixed_set); !status)
    return status.issue();
  place_soft_body(body, description, s.time);
  body.surface.refit(body.x);
  return s.add(std::make_unique<State::Body>(std::move(body)), s.soft_indices);
}

Result<BodyId> World::add_rigid_body(const RigidBodyDescription& description) {
  if (auto status = check_rigid_body(description); !status) return status.issue();
  State& s = *state_;
  if (description.free && s.settings.integrator == Integrator::quasi_static)
    return make_issue(IssueCode::static_body_not_held,
                      "a free rigid body has no equilibrium of its own", description.name);
  auto body = RigidBody::create(description, s.time);
  if (!body) return body.issue();
  return s.add(std::make_unique<State::Body>(std::move(*body)), s.rigid_indices);
}

BodyId World::State::add(std::unique_ptr<Body> body, std::vector<std::uint32_t>& indices) {
  const auto index = static_cast<std::uint32_t>(bodies.size());
  bodies.push_back(std::move(body));
  indices.push_back(index);
  contacts_of_body.resize(bodies.size());
  body_contacts.resize(bodies.size());
  rigid_contacts.resize(bodies.size());
  body_steps.resize(bodies.size());
  rest.resize(bodies.size());
  broad_phase.resize(bodies.size());
  broad_phase.set_filter(index, is_soft(index) ? soft(index).filter : rigid(index).filter);
  last_energy_j = std::numeric_limits<double>::quiet_NaN();
  return {index};
}

Result<LoadId> World::add_load(BodyId soft_body, const LoadDescription& description) {
  State& s = *state_;
  if (soft_body.index >= s.bodies.size() || !is_soft(soft_body))
    return make_issue(IssueCode::load_invalid, "loads act on soft bodies", description.name);
  SoftBody& body = s.soft(soft_body.index);
  auto load = AppliedLoad::create(description, *body.asset, body.x);
  if (!load) return load.issue();
  const auto index = static_cast<std::uint32_t>(body.loads.size());
  body.add_load(std::move(*load));
  s.wake_group(soft_body.index);
  return LoadId{soft_body.index, index};
}

Status World::set_load(LoadId load, const LoadKeyframe& value) {
  State& s = *state_;
  if (load.body >= s.bodies.size() || !is_soft({load.body}) ||
      load.index >= s.soft(load.body).loads.size())
    return make_issue(IssueCode::load_invalid, "there is no such load");
  s.wake_group(load.body);
  return s.soft(load.body).loads[load.index].set(value, s.soft(load.body).name);
}

Status World::set_pair(BodyId a, BodyId b, const PairRule& rule) {
  const std::size_t count = state_->bodies.size();
  if (a.index >= count || b.index >= count || a.index == b.index)
    return make_issue(IssueCode::world_parameter_invalid, "a pair is of two bodies of this world",
                      a.index < count ? body_name(a) : "");
  if (auto status = check_pair(rule, body_name(a) + " and " + body_name(b)); !status) return status;
  state_->pairs.set(a.index, b.index, rule);
  wake(a);
  wake(b);
  return {};
}

void World::run_jobs_with(RunJobs run_jobs) { state_->run_jobs = std::move(run_jobs); }

Result<StepReport> World::step() {
  State& s = *state_;
  StepReport report;
  PhaseClock clock;
  if (auto status = s.compute_step(report, clock); !status) {
    s.give_up();
    return status.issue();
  }
  const PhaseTimes& t = report.times;
  report.times.total_s = t.free_motion_s + t.collision_s + t.compliance_s + t.contact_solve_s +
                         t.correction_s + clock.lap();
  report.contact_count = s.contacts.size();
  report.uncovered_count = s.uncovered;
  for (std::size_t i = 0; i < s.contacts.size(); ++i)
    report.active_count += !s.at(s.force, i).isZero(0);
  for (const BodyRest& body : s.rest) report.sleeping_count += body.is_asleep;
  if (s.settings.measure_laws) s.measure(report);
  return report;
}

double World::time_s() const { return state_->time; }
std::size_t World::body_count() const { return state_->bodies.size(); }

const std::string& World::body_name(BodyId body) const {
  return std::visit([](const auto& b) -> const std::string& { return b.name; },
                    *state_->bodies[body.index]);
}

bool World::is_soft(BodyId body) const {
  return std::holds_alternative<SoftBody>(*state_->bodies[body.index]);
}

const SoftBodyAsset& World::asset(BodyId soft_body) const {
  return *state_->soft(soft_body.index).asset;
}

SolverKind World::solver(BodyId soft_body) const { return state_->soft(soft_body.index).solver_kind; }

std::span<const Point> World::positions(BodyId soft_body) const {
  return as_points(state_->soft(soft_body.index).x);
}

std::span<const Point> World::velocities(BodyId soft_body) const {
  return as_points(state_->soft(soft_body.index).v);
}

Pose World::rigid_pose(BodyId rigid_body) const {
  const RigidBody& body = state_->rigid(rigid_body.index);
  if (!body.free) return pose_at(body.path, state_->time);
  const RigidPlacement at = body.free->shape_placement();
  const Eigen::Quaterniond q(at.rotation);
  return {{q.w(), q.x(), q.y(), q.z()}, as_point(at.translation)};
}

Point World::rigid_velocity(BodyId rigid_body) const {
  const RigidBody& body = state_->rigid(rigid_body.index);
  return body.free ? as_point(body.free->velocity) : Point{};
}

Point World::rigid_angular_velocity(BodyId rigid_body) const {
  const RigidBody& body = state_->rigid(rigid_body.index);
  return body.free ? as_point(body.free->spin) : Point{};
}

Status World::set_rigid_state(BodyId rigid_body, const Pose& pose, const Point& velocity_m_s,
                              const Point& angular_velocity_rad_s) {
  State& s = *state_;
  if (rigid_body.index >= s.bodies.size() || !s.is_free_rigid(rigid_body.index))
    return make_issue(IssueCode::world_parameter_invalid, "not a free rigid body of this world");
  RigidBody& body = s.rigid(rigid_body.index);
  if (auto status = check_pose(pose, IssueCode::world_parameter_invalid, body.name); !status)
    return status;
  if (!as_vec3(velocity_m_s).allFinite() || !as_vec3(angular_velocity_rad_s).allFinite())
    return make_issue(IssueCode::world_parameter_invalid, "a velocity that is not finite", body.name);
  const RigidPlacement at = placement(pose);
  FreeRigidState& state = *body.free;
  state.orientation = Eigen::Quaterniond(at.rotation * state.body_frame.rotation);
  state.position = at.rotation * state.body_frame.translation + at.translation;
  state.velocity = as_vec3(velocity_m_s);
  state.spin = as_vec3(angular_velocity_rad_s);
  if (body.held) body.held->now = body.held->next = at;
  s.wake_group(rigid_body.index);
  s.last_energy_j = std::numeric_limits<double>::quiet_NaN();
  return {};
}

void World::wake(BodyId body) {
  if (body.index < state_->bodies.size()) state_->wake_group(body.index);
}

bool World::is_asleep(BodyId body) const { return !state_->is_awake(body.index); }

std::optional<PickHit> World::pick(const Point& origin, const Point& direction, double reach_m) const {
  const State& s = *state_;
  Ray ray{as_vec3(origin), as_vec3(direction), reach_m};
  const double length = ray.direction.norm();
  if (!ray.origin.allFinite() || !std::isfinite(length) || !(length > 0) || !(reach_m > 0)) return {};
  ray.direction /= length;
  std::optional<PickHit> nearest;
  for (std::uint32_t k = 0; k < s.bodies.size(); ++k) {
    const auto hit = s.pick_body(k, ray);
    if (!hit || (nearest && hit->distance >= nearest->distance_m)) continue;
    nearest = PickHit{{k},
                      hit->distance,
                      as_point(ray.origin + hit->distance * ray.direction),
                      as_point(hit->normal)};
    if (!s.is_soft(k)) continue;
    const Triangle& t = s.soft(k).asset->surface().triangles()[std::size_t(hit->triangle)];
    const auto corner = std::ranges::max_element(hit->weight) - hit->weight.begin();
    nearest->node = t[std::size_t(corner)];
  }
  return nearest;
}

std::optional<RayHit> World::State::pick_body(std::uint32_t index, const Ray& ray) const {
  if (is_soft(index)) {
    DeformedSurface now(soft(index).asset->surface());
    now.refit(soft(index).x);
    return souple::pick(now, ray);
  }
  const RigidBody& body = rigid(index);
  if (!body.placed) return souple::pick(body.shape, body.placement_at(time), ray);
  PlacedMesh now(*body.shape.mesh);
  now.move_to(body.placement_at(time));
  return souple::pick(now.surface(), ray);
}

Status World::set_state(BodyId soft_body, std::span<const Point> positions,
                        std::span<const Point> velocities) {
  SoftBody& body = state_->soft(soft_body.index);
  const auto count = std::size_t(body.asset->model().node_count());
  if (positions.size() != count || velocities.size() != count)
    return make_issue(IssueCode::world_parameter_invalid, "a state needs one entry per node",
                      body.name);
  for (const auto* points : {&positions, &velocities})
    for (const Point& p : *points)
      if (!as_vec3(p).allFinite())
        return make_issue(IssueCode::world_parameter_invalid, "a state that is not finite", body.name);
  for (std::size_t k = 0; k < count; ++k) {
    node_entry(body.x, Index(k)) = as_vec3(positions[k]);
    node_entry(body.v, Index(k)) = as_vec3(velocities[k]);
  }
  body.history.valid = false;
  body.owed = {};
  state_->wake_group(soft_body.index);
  state_->last_energy_j = std::numeric_limits<double>::quiet_NaN();
  return {};
}

Status World::copy_state(const World& other) {
  State& to = *state_;
  const State& from = *other.state_;
  bool same = to.soft_indices == from.soft_indices && to.rigid_indices == from.rigid_indices;
  for (std::size_t k = 0; same && k < to.soft_indices.size(); ++k)
    same = to.soft(to.soft_indices[k]).x.size() == from.soft(from.soft_indices[k]).x.size();
  for (std::size_t k = 0; same && k < to.rigid_indices.size(); ++k)
    same = bool(to.rigid(to.rigid_indices[k]).free) == bool(from.rigid(to.rigid_indices[k]).free) &&
           bool(to.rigid(to.rigid_indices[k]).held) == bool(from.rigid(to.rigid_indices[k]).held);
  if (!same)
    return make_issue(IssueCode::world_parameter_invalid, "the worlds do not hold the same bodies");
  for (const auto index : to.soft_indices) {
    to.soft(index).x = from.soft(index).x;
    to.soft(index).v = from.soft(index).v;
    to.soft(index).stabilisation = from.soft(index).stabilisation;
    to.soft(index).owed = from.soft(index).owed;
    if (to.soft(index).solver->may_recall(from.soft(index).solver->memory()))
      to.soft(index).solver->recall(from.soft(index).solver->memory());
    to.soft(index).take_history(from.soft(index), to.settings.time_step_s == from.settings.time_step_s);
  }
  to.last_energy_j = std::numeric_limits<double>::quiet_NaN();
  for (const auto index : to.rigid_indices) {
    if (to.rigid(index).free) to.rigid(index).free = from.rigid(index).free;
    if (!to.rigid(index).held) continue;
    to.rigid(index).held->now = from.rigid(index).held->now;
    to.rigid(index).held->next = from.rigid(index).held->next;
  }
  to.memory = from.memory;
  to.rest = from.rest;
  to.time = from.time;
  return {};
}

std::vector<ContactRecord> World::contacts() const {
  const State& s = *state_;
  std::vector<ContactRecord> records;
  for (std::size_t i = 0; i < s.contacts.size(); ++i) {
    const Contact& c = s.contacts[i];
    if (c.law.kind != ConstraintLaw::Kind::frictional) continue;
    records.push_back({{c.a.body},
                       {c.b.body},
                       as_point(c.point),
                       as_point(c.frame.col(0)),
                       as_point(c.frame * s.at(s.force, i)),
                       s.gap[3 * i]});
  }
  return records;
}

std::span<const ContactEvent> World::contact_events() const { return state_->events.events(); }

// A column of W is the gap that a unit force makes.
StepContactProblem World::contact_problem() const {
  State& s = *state_;
  StepContactProblem problem{s.contacts, {}, s.free_gap, s.laws, s.force};
  if (s.penalty()) return problem;
  const std::size_t count = s.contacts.size(), size = 3 * count;
  problem.delassus.assign(size * size, 0.0);
  for (std::size_t column = 0; column < size; ++column) {
    for (std::size_t i = 0; i < count; ++i) s.contact_operator.clear_gap(i);
    s.contact_operator.add_to_base(column / 3, Vec3::Unit(Eigen::Index(column % 3)));
    for (std::size_t i = 0; i < count; ++i) {
      const Vec3 gap = s.contact_operator.gap(i);
      for (std::size_t r = 0; r < 3; ++r)
        problem.delassus[(3 * i + r) * size + column] = gap[Eigen::Index(r)];
    }
  }
  return problem;
}

}  // namespace souple
