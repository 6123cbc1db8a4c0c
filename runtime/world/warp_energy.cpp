// SPDX-License-Identifier: MIT
// Warped contact forces move a body by R C0 R^T instead of A^-1. What that motion violates of
// A dx = b + H^T f acts as an external force, and in the impact of a body that is crushed on its way
// its work may exceed all the energy there is. Bounded here; bodies that are little deformed never
// notice.
#include <algorithm>
#include <cmath>

#include "runtime/world/rigid_velocity.hpp"
#include "runtime/world/world_state.hpp"

namespace souple {
namespace {

// Share of the kinetic energy that a step's change of contact forces must move to be an impact at all.
constexpr double impact_share = 0.01;

// Of its longest side, that a body moves within a step of a wild impact.
constexpr double wild_motion = 0.05;

}  // namespace

// Work of the forces `rest_frame` - A dx in the motion dx, J, with a changed sign; 0 if it takes
// energy.
double SoftBody::energy_of_warping(double h) {
  double kinetic = 0;
  for (Index node = 0; node < asset->model().node_count(); ++node)
    kinetic += 0.5 * asset->model().masses()[node] * node_entry(motion, node).squaredNorm() / (h * h);
  const double impact = rest_frame.dot(motion);
  if (std::abs(impact) < impact_share * kinetic) return 0;
  rest_frame += load;
  const double given = rest_frame.dot(motion);
  multiply(tangent, motion, rest_frame);
  return std::max(0.0, rest_frame.dot(motion) - given);
}

// Takes the energy from the velocities by which the body deforms: momentum and spin are kept.
void SoftBody::remove_kinetic_energy(double energy) {
  if (!(energy > 0)) return;
  const CorotationalModel& model = asset->model();
  const RigidVelocity rigid =
      free_nodes.size() == is_fixed.size() ? rigid_velocity(model, x, v) : RigidVelocity{};
  double deforming = 0;
  for (const Index node : free_nodes)
    deforming += 0.5 * model.masses()[node] *
                 (node_entry(v, node) - rigid.at(node_entry(x, node))).squaredNorm();
  if (!(deforming > 0)) return;
  const double share = std::sqrt(std::max(0.0, 1 - energy / deforming));
  for (const Index node : free_nodes) {
    const Vec3 whole = rigid.at(node_entry(x, node));
    node_entry(v, node) = whole + share * (node_entry(v, node) - whole);
  }
}

void World::State::measure_warping() {
  for (std::size_t k = 0; k < force.size(); ++k) change[k] = force[k] - applied[k];
  for_each_soft([&](std::uint32_t index) {
    BodyStep& result = body_steps[index];
    result.warping_energy_j = 0;
    result.is_warping_wild = false;
    if (settings.contact_method != ContactMethod::warped || body_contacts[index].empty()) return;
    SoftBody& body = soft(index);
    // Slower bodies come to rest by warped forces alone; taking energy from them there would keep them
    // from it.
    const double speed = wild_motion * body.asset->longest_side_m() / settings.time_step_s;
    const double kinetic = body.kinetic_energy();
    if (!(kinetic > 0.5 * body.asset->model().total_mass() * speed * speed)) return;
    body.rest_frame.setZero();
    body_contacts[index].add_forces(change, body.rest_frame);
    result.warping_energy_j = body.energy_of_warping(settings.time_step_s);
    result.is_warping_wild = result.warping_energy_j > 0.5 * kinetic;
  });
}

}  // namespace souple
