// SPDX-License-Identifier: MIT
// What a step is judged by, measured after it and outside its solvers.
#include <algorithm>
#include <cmath>

#include "runtime/world/world_state.hpp"

namespace souple {

void World::State::measure_body(std::uint32_t index) {
  BodyStep& result = body_steps[index];
  SoftBody& body = soft(index);
  result.kinetic_energy_j = body.kinetic_energy();
  result.elastic_energy_j = body.elastic_energy();
  result.node_depth_m = result.surface_depth_m = 0;
  Eigen::AlignedBox3d box;
  for (const Index node : body.asset->surface().nodes()) box.extend(Vec3(node_entry(body.x, node)));
  for (const auto other : rigid_indices) {
    if (!may_touch(index, other) || !body_bounds(other).intersects(box)) continue;
    const Depths depths = depths_in(body, rigid(other), rigid(other).end);
    result.node_depth_m = std::max(result.node_depth_m, depths.node);
    result.surface_depth_m = std::max(result.surface_depth_m, depths.surface);
  }
}

void World::State::measure_energy(StepReport& report) {
  Vec3 linear = Vec3::Zero(), angular = Vec3::Zero();
  for (const auto index : soft_indices) {
    report.kinetic_energy_j += body_steps[index].kinetic_energy_j;
    report.elastic_energy_j += body_steps[index].elastic_energy_j;
    report.potential_energy_j += soft(index).potential_energy(gravity);
    if (is_awake(index)) report.load_work_j += soft(index).work_of_loads();
    linear += soft(index).linear_momentum();
    angular += soft(index).angular_momentum();
  }
  for (const auto index : rigid_indices) {
    if (!rigid(index).free) continue;
    const FreeRigidState& body = *rigid(index).free;
    const Vec3 momentum = body.mass * body.velocity;
    report.kinetic_energy_j += rigid(index).kinetic_energy();
    report.potential_energy_j -= body.mass * gravity.dot(body.position);
    linear += momentum;
    angular += body.position.cross(momentum) + body.world_inertia() * body.spin;
  }
  report.linear_momentum_kg_m_s = as_point(linear);
  report.angular_momentum_kg_m2_s = as_point(angular);
  const double energy = report.kinetic_energy_j + report.elastic_energy_j + report.potential_energy_j;
  if (std::isfinite(last_energy_j)) report.lost_energy_j = last_energy_j + report.load_work_j - energy;
  last_energy_j = energy;
}

// Natural map with rho_i = 1 / (mean eigenvalue of W_ii), over ||f||; the gap is computed anew.
double World::State::contact_residual() {
  double residual2 = 0, force2 = 0;
  for (std::size_t i = 0; i < contacts.size(); ++i) contact_operator.clear_gap(i);
  for (std::size_t i = 0; i < contacts.size(); ++i)
    if (!at(force, i).isZero(0)) contact_operator.add_to_base(i, at(force, i));
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    const LocalLaw law(laws[i], contact_operator.diagonal_block(i));
    if (!law.movable()) continue;
    residual2 += law.natural_map(at(free_gap, i) + contact_operator.gap(i), at(force, i)).squaredNorm();
    force2 += at(force, i).squaredNorm();
  }
  return std::sqrt(force2 > 0 ? residual2 / force2 : residual2);
}

// max over contacts of max(|f_t| - mu f_n, -f_n), relative to the largest |f|.
double World::State::cone_violation() const {
  double largest = 0, violation = 0;
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    if (laws[i].kind != ConstraintLaw::Kind::frictional) continue;
    const Vec3 f = at(force, i);
    largest = std::max(largest, f.norm());
    violation = std::max({violation, f.tail<2>().norm() - laws[i].friction * f[0], -f[0]});
  }
  return largest > 0 ? violation / largest : 0;
}

void World::State::measure(StepReport& report) {
  for_each_soft([&](std::uint32_t index) { measure_body(index); });
  measure_energy(report);
  if (!penalty()) report.contact_residual = contact_residual();
  report.cone_violation = cone_violation();
  for (const auto index : soft_indices) {
    const BodyStep& result = body_steps[index];
    report.worst_penetration_m = std::max(report.worst_penetration_m, result.node_depth_m);
    report.worst_surface_depth_m = std::max(report.worst_surface_depth_m, result.surface_depth_m);
  }
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    const Contact& c = contacts[i];
    if (c.law.kind == ConstraintLaw::Kind::bilateral)
      report.worst_joint_error_m = std::max(report.worst_joint_error_m, at(gap, i).norm());
    else if (!is_soft(c.a.body) || (c.b.body != ContactSide::no_body && is_soft(c.b.body)))
      report.worst_penetration_m = std::max(report.worst_penetration_m, -gap[3 * i]);
  }
  report.worst_surface_depth_m = std::max(report.worst_surface_depth_m, report.worst_penetration_m);
}

}  // namespace souple
