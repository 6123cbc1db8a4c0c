// SPDX-License-Identifier: MIT
// What a step is judged by, measured after it and outside its solvers.
#include <algorithm>

#include "runtime/world/world_state.hpp"

namespace souple {

void World::State::measure_body(std::uint32_t index) {
  BodyStep& result = body_steps[index];
  SoftBody& body = soft(index);
  result.kinetic_energy_j = body.kinetic_energy();
  result.elastic_energy_j = body.elastic_energy();
  result.node_depth_m = result.surface_depth_m = 0;
  for (const auto other : rigid_indices) {
    const RigidStep& step = rigid_steps[other];
    result.node_depth_m = std::max(result.node_depth_m, node_depth(body, step.body->shape, step.end));
    result.surface_depth_m =
        std::max(result.surface_depth_m, surface_depth(body, step.body->shape, step.end));
  }
}

void World::State::measure_energy(StepReport& report) {
  Vec3 linear = Vec3::Zero(), angular = Vec3::Zero();
  for (const auto index : soft_indices) {
    report.kinetic_energy_j += body_steps[index].kinetic_energy_j;
    report.elastic_energy_j += body_steps[index].elastic_energy_j;
    report.potential_energy_j += soft(index).potential_energy(gravity);
    report.load_work_j += soft(index).work_of_loads();
    linear += soft(index).linear_momentum();
    angular += soft(index).angular_momentum();
  }
  report.linear_momentum_kg_m_s = as_point(linear);
  report.angular_momentum_kg_m2_s = as_point(angular);
  const double energy = report.kinetic_energy_j + report.elastic_energy_j + report.potential_energy_j;
  if (std::isfinite(last_energy_j)) report.lost_energy_j = last_energy_j + report.load_work_j - energy;
  last_energy_j = energy;
}

void World::State::measure(StepReport& report) {
  for_each_soft([&](std::uint32_t index) { measure_body(index); });
  measure_energy(report);
  report.contact_residual = contacts.empty() ? 0 : natural_map_residual(problem(), force);
  report.cone_violation = cone_violation(friction, force);
  for (const auto index : soft_indices) {
    const BodyStep& result = body_steps[index];
    report.worst_penetration_m = std::max(report.worst_penetration_m, result.node_depth_m);
    report.worst_surface_depth_m = std::max(report.worst_surface_depth_m, result.surface_depth_m);
  }
  for (std::size_t i = 0; i < contacts.size(); ++i)
    if (contacts[i].b.count > 0)
      report.worst_penetration_m = std::max(report.worst_penetration_m, -gap[3 * i]);
  report.worst_surface_depth_m = std::max(report.worst_surface_depth_m, report.worst_penetration_m);
}

}  // namespace souple
