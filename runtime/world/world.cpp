// SPDX-License-Identifier: MIT
#include "runtime/world/world.hpp"

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
  if (auto status = hold_fixed_set(body, description.fixed_set); !status) return status.issue();
  if (auto status = drive_nodes(body, description); !status) return status.issue();
  if (auto status = prepare_integrator(body, s.settings); !status) return status.issue();
  if (auto status = prepare_contact_method(body, s.settings, description.fixed_set); !status)
    return status.issue();
  if (auto status = s.solvers.prepare(body, s.settings); !status) return status.issue();
  place_soft_body(body, description, s.time);
  return s.add(std::make_unique<State::Body>(std::move(body)), s.soft_indices);
}

Result<BodyId> World::add_rigid_body(const RigidBodyDescription& description) {
  if (auto status = check_rigid_body(description); !status) return status.issue();
  State& s = *state_;
  return s.add(
      std::make_unique<State::Body>(RigidBody{description.name, description.shape, description.path}),
      s.rigid_indices);
}

BodyId World::State::add(std::unique_ptr<Body> body, std::vector<std::uint32_t>& indices) {
  const auto index = static_cast<std::uint32_t>(bodies.size());
  bodies.push_back(std::move(body));
  indices.push_back(index);
  body_contacts.resize(bodies.size());
  body_steps.resize(bodies.size());
  rigid_steps.resize(bodies.size());
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
  return LoadId{soft_body.index, index};
}

Status World::set_load(LoadId load, const LoadKeyframe& value) {
  State& s = *state_;
  if (load.body >= s.bodies.size() || !is_soft({load.body}) ||
      load.index >= s.soft(load.body).loads.size())
    return make_issue(IssueCode::load_invalid, "there is no such load");
  return s.soft(load.body).loads[load.index].set(value, s.soft(load.body).name);
}

Status World::set_pair(BodyId a, BodyId b, const PairRule& rule) {
  const std::size_t count = state_->bodies.size();
  if (a.index >= count || b.index >= count || a.index == b.index)
    return make_issue(IssueCode::world_parameter_invalid, "a pair is of two bodies of this world",
                      a.index < count ? body_name(a) : "");
  if (auto status = check_pair(rule, body_name(a) + " and " + body_name(b)); !status) return status;
  state_->pairs.set(a.index, b.index, rule);
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
  for (std::size_t i = 0; i < s.contacts.size(); ++i) report.active_count += s.force[3 * i] > 0;
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
  return pose_at(state_->rigid(rigid_body.index).path, state_->time);
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
  state_->last_energy_j = std::numeric_limits<double>::quiet_NaN();
  return {};
}

Status World::copy_state(const World& other) {
  State& to = *state_;
  const State& from = *other.state_;
  bool same = to.soft_indices == from.soft_indices && to.rigid_indices == from.rigid_indices;
  for (std::size_t k = 0; same && k < to.soft_indices.size(); ++k)
    same = to.soft(to.soft_indices[k]).x.size() == from.soft(from.soft_indices[k]).x.size();
  if (!same)
    return make_issue(IssueCode::world_parameter_invalid, "the worlds do not hold the same bodies");
  for (const auto index : to.soft_indices) {
    to.soft(index).x = from.soft(index).x;
    to.soft(index).v = from.soft(index).v;
    if (to.soft(index).solver->may_recall(from.soft(index).solver->memory()))
      to.soft(index).solver->recall(from.soft(index).solver->memory());
    to.soft(index).take_history(from.soft(index), to.settings.time_step_s == from.settings.time_step_s);
  }
  to.last_energy_j = std::numeric_limits<double>::quiet_NaN();
  to.last_keys = from.last_keys;
  to.last_forces = from.last_forces;
  to.last_changes = from.last_changes;
  to.last_courses = from.last_courses;
  to.last_lasting = from.last_lasting;
  to.growing_steps = from.growing_steps;
  to.relaxation = to.exact() ? 1 : from.relaxation;
  to.time = from.time;
  return {};
}

std::vector<ContactRecord> World::contacts() const {
  const State& s = *state_;
  std::vector<ContactRecord> records;
  for (std::size_t i = 0; i < s.contacts.size(); ++i) {
    const Contact& c = s.contacts[i];
    const Vec3 f = s.frames[i] * Eigen::Map<const Vec3>(s.force.data() + 3 * i);
    records.push_back({{c.a.body},
                       {c.b.body},
                       as_point(c.point),
                       as_point(c.frame.col(0)),
                       as_point(f),
                       s.gap[3 * i]});
  }
  return records;
}

ContactProblemView World::contact_problem() const {
  const State& s = *state_;
  return {s.contacts, s.delassus, s.free_gap, s.friction, s.force};
}

}  // namespace souple
