// SPDX-License-Identifier: MIT
#include "runtime/world/checks.hpp"

#include <Eigen/Eigenvalues>
#include <cmath>
#include <initializer_list>

#include "runtime/collision/rigid_distance.hpp"
#include "runtime/world/explicit_limit.hpp"
#include "runtime/world/integrator.hpp"
#include "runtime/world/rigid_path.hpp"

namespace souple {
namespace {

constexpr double largest_length = 1e6;  // m: beyond, doubles no longer resolve contact gaps
constexpr double largest_rate = 1e6;    // m/s, m/s2, rad/s
constexpr double largest_friction = 10;

Status refuse(const std::string& what, const std::string& where) {
  return make_issue(IssueCode::world_parameter_invalid, what, where);
}

bool within(const Point& p, double limit) {
  for (const double c : p)
    if (!(std::abs(c) <= limit)) return false;
  return true;
}

bool in_range(double value, double low, double high) { return value >= low && value <= high; }

// The system that a world asks a compliance for.
std::string describe(const WorldSettings& settings) {
  const std::string h = std::to_string(settings.time_step_s) + " s";
  switch (settings.integrator) {
    case Integrator::bdf2:
      return "BDF2 with time step " + h +
             " (implicit Euler: " + std::to_string(euler_step_of_bdf2(settings.time_step_s)) + " s)";
    case Integrator::quasi_static:
      return "a quasi-static body";
    default:
      return "time step " + h;
  }
}

}  // namespace

Status check_pair(const PairRule& rule, const std::string& where) {
  if (!in_range(rule.friction, 0, largest_friction))
    return refuse("friction " + std::to_string(rule.friction) + " is outside [0, 10]", where);
  if (in_range(rule.restitution, 0, 1)) return {};
  return refuse("restitution " + std::to_string(rule.restitution) + " is outside [0, 1]", where);
}

Status check_settings(const WorldSettings& s) {
  if (!in_range(s.time_step_s, 1e-7, 10))
    return refuse("time step " + std::to_string(s.time_step_s) + " s is outside [1e-7, 10]",
                  "time_step_s");
  if (s.integrator == Integrator::explicit_euler && s.contact_method == ContactMethod::warped)
    return make_issue(IssueCode::world_parameter_invalid,
                      "no compliance can be stored for the explicit integrator", "contact_method",
                      "Use the exact contact method: it costs nothing here, A is diagonal.");
  if (!within(s.gravity_m_s2, largest_rate)) return refuse("gravity is out of range", "gravity");
  if (!in_range(s.friction, 0, largest_friction))
    return refuse("friction " + std::to_string(s.friction) + " is outside [0, 10]", "friction");
  if (!in_range(s.alarm_distance_m, 0, largest_length))
    return refuse("the alarm distance is out of range", "alarm_distance_m");
  if (!in_range(s.contact_passes, 1, 20))
    return refuse("contact passes must be in [1, 20]", "contact_passes");
  if (!in_range(s.penalty_stiffness_n_m, 0, 1e12))
    return refuse("the penalty stiffness is out of range", "penalty_stiffness_n_m");
  if (!in_range(s.sleep_after_s, 0, 1e6) || !in_range(s.sleep_speed, 0, 1e3))
    return refuse("sleep_after_s must be in [0, 1e6] and sleep_speed in [0, 1e3]", "sleep");
  if (!in_range(s.contact_solver.tolerance, 0, 1) || !in_range(s.contact_solver.max_sweeps, 1, 1e6))
    return refuse("tolerance must be in [0, 1] and sweeps in [1, 1e6]", "contact solver");
  if (!in_range(s.contact_solver.penetration_m, 0, 1e6))
    return refuse("penetration_m must be in [0, 1e6]", "contact solver");
  if (!in_range(s.free_motion.tolerance, 0, 1) || !in_range(s.free_motion.max_iterations, 1, 1e6))
    return refuse("tolerance must be in [0, 1] and iterations in [1, 1e6]", "free motion solver");
  return {};
}

Status check_soft_body(const SoftBodyDescription& d) {
  if (auto status = check_pose(d.pose, IssueCode::world_parameter_invalid, d.name); !status)
    return status;
  if (!within(d.velocity_m_s, largest_rate) || !within(d.angular_velocity_rad_s, largest_rate))
    return refuse("a velocity is out of range", d.name);
  return {};
}

namespace {

Status check_handle(const RigidBodyDescription& d) {
  constexpr double stiffest = 1e9;
  const HandleCoupling& c = *d.handle;
  if (d.free || d.path.size() != 1)
    return refuse("a held body has the one pose where its hand begins, and does not move freely",
                  d.name);
  if (d.shape.kind == RigidShapeKind::plane) return refuse("no hand holds a plane", d.name);
  if (!(c.stiffness_n_m > 0 && c.stiffness_n_m <= stiffest) ||
      !(c.turn_stiffness_nm_rad > 0 && c.turn_stiffness_nm_rad <= stiffest))
    return refuse("the stiffness of a coupling must be in (0, 1e9]", d.name);
  if (!in_range(c.damping_n_s_m, 0, stiffest) || !in_range(c.turn_damping_nm_s_rad, 0, stiffest))
    return refuse("the damping of a coupling must be in [0, 1e9]", d.name);
  if (!within(c.centre_m, largest_length) || !in_range(c.look_ahead_m, 0, largest_length))
    return refuse("the centre or the look-ahead of a coupling is out of range", d.name);
  return {};
}

}  // namespace

Status check_rigid_body(const RigidBodyDescription& d) {
  if (auto status = check_path(d.path, IssueCode::world_parameter_invalid, d.name); !status)
    return status;
  const bool round = d.shape.kind == RigidShapeKind::sphere || d.shape.kind == RigidShapeKind::capsule;
  if (round && !in_range(d.shape.radius_m, 1e-9, largest_length))
    return refuse("the radius is out of range", d.name);
  if (d.shape.kind == RigidShapeKind::capsule && !in_range(d.shape.half_length_m, 0, largest_length))
    return refuse("the half length is out of range", d.name);
  if ((d.shape.kind == RigidShapeKind::mesh) != bool(d.shape.mesh))
    return refuse("a mesh is given for the shape that is one, and no other", d.name);
  if (d.free) {
    if (d.path.size() != 1) return refuse("a free body has the one pose where it starts", d.name);
    if (!in_range(d.free->mass_kg, 0, 1e12) || !in_range(d.free->density_kg_m3, 1e-9, 1e12))
      return refuse("a mass or density is out of range", d.name);
    if (!within(d.free->velocity_m_s, largest_rate) ||
        !within(d.free->angular_velocity_rad_s, largest_rate))
      return refuse("a velocity is out of range", d.name);
  }
  if (d.handle) {
    if (auto status = check_handle(d); !status) return status;
  }
  if (d.shape.kind == RigidShapeKind::box)
    for (const double half : d.shape.half_extents_m)
      if (!in_range(half, 1e-9, largest_length)) return refuse("a half extent is out of range", d.name);
  return {};
}

Status hold_fixed_set(SoftBody& body, const std::string& fixed_set) {
  if (!fixed_set.empty()) {
    const FixedSet* set = body.asset->find_fixed_set(fixed_set);
    if (!set)
      return make_issue(IssueCode::fixed_set_invalid,
                        "the asset has no fixed set \"" + fixed_set + "\"", body.name);
    for (const Index node : set->nodes) body.is_fixed[node] = 1;
  }
  for (std::size_t node = 0; node < body.is_fixed.size(); ++node)
    if (!body.is_fixed[node]) body.free_nodes.push_back(static_cast<Index>(node));
  return {};
}

Status drive_nodes(SoftBody& body, const SoftBodyDescription& description) {
  auto parts = find_driven_nodes(description, *body.asset, body.is_fixed);
  if (!parts) return parts.issue();
  body.drive(std::move(*parts));
  return {};
}

namespace {

// Whether the fixed nodes stop every rigid motion: three of them that are not on one line.
bool is_held(const SoftBody& body) {
  Mat3 spread = Mat3::Zero();
  Vec3 mean = Vec3::Zero();
  double count = 0;
  const auto rest = body.asset->model().rest_positions();
  const auto for_fixed = [&](auto&& visit) {
    for (std::size_t node = 0; node < rest.size(); ++node)
      if (body.is_fixed[node]) visit(Vec3(as_vec3(rest[node])));
  };
  for_fixed([&](const Vec3& p) { mean += p, ++count; });
  if (count < 3) return false;
  mean /= count;
  for_fixed([&](const Vec3& p) { spread += (p - mean) * (p - mean).transpose(); });
  const Vec3 extents = Eigen::SelfAdjointEigenSolver<Mat3>(spread).eigenvalues();
  constexpr double thinnest = 1e-6;  // of a line's width over its length, squared below
  return extents[1] > thinnest * thinnest * extents[2];
}

}  // namespace

Status prepare_integrator(SoftBody& body, const WorldSettings& settings) {
  if (settings.integrator == Integrator::bdf2)
    for (auto* vector :
         {&body.history.motion, &body.history.velocity, &body.history.free_motion, &body.history.load})
      vector->setZero(body.x.size());
  if (settings.integrator == Integrator::quasi_static && !is_held(body))
    return make_issue(IssueCode::static_body_not_held,
                      "fewer than three of its nodes, or only nodes on a line, are fixed", body.name);
  if (settings.integrator != Integrator::explicit_euler) return {};
  const double limit = explicit_step_limit(body.asset->model());
  if (settings.time_step_s < limit) return {};
  return make_issue(IssueCode::explicit_step_too_long,
                    "the step of " + std::to_string(settings.time_step_s) +
                        " s is not below the limit of " + std::to_string(limit) + " s",
                    body.name);
}

Status prepare_contact_method(SoftBody& body, const WorldSettings& settings,
                              const std::string& fixed_set) {
  const CorotationalModel& model = body.asset->model();
  const double h = settings.time_step_s;
  if (settings.contact_method == ContactMethod::penalty) return {};
  if (settings.contact_method == ContactMethod::exact) {
    body.work.setZero(6 * Eigen::Index(body.free_nodes.size()));
    if (body.solver->factor()) return {};
    body.factor.emplace();
    body.factor->analyze(model.pattern(), model.rest_positions(), body.free_nodes);
    return {};
  }
  const SystemFactors factors =
      system_factors(settings.integrator, h, model.rayleigh_mass_per_s(), model.rayleigh_stiffness_s());
  body.compliance = body.asset->find_compliance(factors.mass, factors.stiffness, fixed_set);
  if (!body.compliance) {
    std::string held;
    for (const auto& c : body.asset->compliances())
      held += (held.empty() ? "" : ", ") + c.header.name + " (time step " +
              std::to_string(c.header.time_step_s) + " s, fixed \"" + c.header.fixed_set + "\")";
    return make_issue(IssueCode::scene_no_matching_compliance,
                      "no compliance for " + describe(settings) + " and fixed set \"" + fixed_set +
                          "\"; the asset holds " + (held.empty() ? "none" : held),
                      body.name);
  }
  body.compliance_scale = body.compliance->header.stiffness_factor / factors.stiffness;
  body.extension_work.resize(body.compliance->extension.work_size());
  return {};
}

void place_soft_body(SoftBody& body, const SoftBodyDescription& d, double time_s) {
  const CorotationalModel& model = body.asset->model();
  const RigidPlacement at = placement(d.pose);
  Vec3 centre = Vec3::Zero();
  for (Index node = 0; node < model.node_count(); ++node) {
    node_entry(body.x, node) = at.rotation * as_vec3(model.rest_positions()[node]) + at.translation;
    centre += model.masses()[node] / model.total_mass() * node_entry(body.x, node);
  }
  for (const Index node : body.free_nodes)
    node_entry(body.v, node) =
        as_vec3(d.velocity_m_s) +
        as_vec3(d.angular_velocity_rad_s).cross(node_entry(body.x, node) - centre);
  for (const DrivenNodes& part : body.driven) part.place(time_s, model.rest_positions(), body.x);
}

}  // namespace souple
