// SPDX-License-Identifier: MIT
#include "runtime/world/checks.hpp"

#include <cmath>
#include <initializer_list>

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

Status check_pose(const Pose& pose, const std::string& where) {
  double norm2 = 0;
  for (const double c : pose.rotation) norm2 += c * c;
  if (!(std::abs(norm2 - 1) < 1e-3)) return refuse("the rotation is not a unit quaternion", where);
  if (!within(pose.translation, largest_length)) return refuse("the position is out of range", where);
  return {};
}

}  // namespace

Status check_settings(const WorldSettings& s) {
  if (!in_range(s.time_step_s, 1e-7, 10))
    return refuse("time step " + std::to_string(s.time_step_s) + " s is outside [1e-7, 10]",
                  "time_step_s");
  if (!within(s.gravity_m_s2, largest_rate)) return refuse("gravity is out of range", "gravity");
  if (!in_range(s.friction, 0, largest_friction))
    return refuse("friction " + std::to_string(s.friction) + " is outside [0, 10]", "friction");
  if (!in_range(s.alarm_distance_m, 0, largest_length))
    return refuse("the alarm distance is out of range", "alarm_distance_m");
  if (!in_range(s.contact_passes, 1, 20))
    return refuse("contact passes must be in [1, 20]", "contact_passes");
  if (!in_range(s.contact_solver.tolerance, 0, 1) || !in_range(s.contact_solver.max_sweeps, 1, 1e6))
    return refuse("tolerance must be in [0, 1] and sweeps in [1, 1e6]", "contact solver");
  if (!in_range(s.free_motion.tolerance, 0, 1) || !in_range(s.free_motion.max_iterations, 1, 1e6))
    return refuse("tolerance must be in [0, 1] and iterations in [1, 1e6]", "free motion solver");
  return {};
}

Status check_soft_body(const SoftBodyDescription& d) {
  if (auto status = check_pose(d.pose, d.name); !status) return status;
  if (!within(d.velocity_m_s, largest_rate) || !within(d.angular_velocity_rad_s, largest_rate))
    return refuse("a velocity is out of range", d.name);
  return {};
}

Status check_rigid_body(const RigidBodyDescription& d) {
  if (d.path.empty()) return refuse("a rigid body needs at least one pose", d.name);
  for (std::size_t k = 0; k < d.path.size(); ++k) {
    if (auto status = check_pose(d.path[k].pose, d.name); !status) return status;
    if (!std::isfinite(d.path[k].time_s) || (k > 0 && !(d.path[k].time_s > d.path[k - 1].time_s)))
      return refuse("the times of the path do not ascend", d.name);
  }
  if (d.shape.kind == RigidShapeKind::sphere && !in_range(d.shape.radius_m, 1e-9, largest_length))
    return refuse("the radius is out of range", d.name);
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

Status prepare_contact_method(SoftBody& body, const WorldSettings& settings,
                              const std::string& fixed_set) {
  const CorotationalModel& model = body.asset->model();
  const double h = settings.time_step_s;
  if (settings.contact_method == ContactMethod::exact) {
    body.factor.emplace();
    body.factor->analyze(&model.pattern(), body.free_nodes);
    body.work.setZero(2 * body.factor->size());
    return {};
  }
  const double mass_factor = 1 / (h * h) + model.rayleigh_mass_per_s() / h;
  const double stiffness_factor = 1 + model.rayleigh_stiffness_s() / h;
  body.compliance = body.asset->find_compliance(mass_factor, stiffness_factor, fixed_set);
  if (!body.compliance) {
    std::string held;
    for (const auto& c : body.asset->compliances())
      held += (held.empty() ? "" : ", ") + c.header.name + " (time step " +
              std::to_string(c.header.time_step_s) + " s, fixed \"" + c.header.fixed_set + "\")";
    return make_issue(IssueCode::scene_no_matching_compliance,
                      "no compliance for time step " + std::to_string(h) + " s and fixed set \"" +
                          fixed_set + "\"; the asset holds " + (held.empty() ? "none" : held),
                      body.name);
  }
  body.compliance_scale = body.compliance->header.stiffness_factor / stiffness_factor;
  body.extension_work.resize(body.compliance->extension.work_size());
  return {};
}

void place_soft_body(SoftBody& body, const SoftBodyDescription& d) {
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
}

}  // namespace souple
