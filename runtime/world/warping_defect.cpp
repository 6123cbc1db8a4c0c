// SPDX-License-Identifier: MIT
// Warped contact forces move a body by R C0 R^T instead of A^-1. What that motion leaves of
// A dx = b + H^T f is its defect: it acts as an external force of which nobody knows. Given back in the
// next step it neither makes nor takes momentum, and a body whose contacts come and go rests where the
// exact motion has it. In the impact of a body that is crushed on its way the defect's work may exceed
// all the energy there is; that is bounded here. Bodies that are little deformed never notice.
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

// Of the defect, that the next step gives back. Inertia remembers all of it; an elastic force that has
// pulled the body back by then has undone it already, and all of it would be too much.
constexpr double given_back = 0.8;

// Contact forces that change by more than this share of themselves are an impact, whose defect comes
// too late a step after.
constexpr double steady_change = 0.4;

}  // namespace

void SoftBody::measure_warping_defect() {
  multiply(tangent, motion, warping_defect);
  warping_defect = load + rest_frame - warping_defect;
  for (Index node = 0; node < asset->model().node_count(); ++node)
    if (is_fixed[node]) node_entry(warping_defect, node).setZero();
}

double SoftBody::energy_of_warping(double h) const {
  double kinetic = 0;
  for (Index node = 0; node < asset->model().node_count(); ++node)
    kinetic += 0.5 * asset->model().masses()[node] * node_entry(motion, node).squaredNorm() / (h * h);
  if (std::abs(rest_frame.dot(motion)) < impact_share * kinetic) return 0;
  return std::max(0.0, -warping_defect.dot(motion));
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

// Slower bodies come to rest by warped forces alone; taking energy from them there would keep them from
// it.
void World::State::judge_warping(std::uint32_t index) {
  SoftBody& body = soft(index);
  BodyStep& result = body_steps[index];
  const double speed = wild_motion * body.asset->longest_side_m() / settings.time_step_s;
  const double kinetic = body.kinetic_energy();
  if (!(kinetic > 0.5 * body.asset->model().total_mass() * speed * speed)) return;
  result.warping_energy_j = body.energy_of_warping(settings.time_step_s);
  result.is_warping_wild = result.warping_energy_j > 0.5 * kinetic;
}

// Only inertia passes a defect on; without forces fed forward every step would be an impact.
bool World::State::gives_defect_back(std::uint32_t index) const {
  const bool has_inertia =
      settings.integrator == Integrator::implicit_euler || settings.integrator == Integrator::bdf2;
  return has_inertia && settings.feed_forward_forces && !body_steps[index].is_warping_wild &&
         changed_share(index) <= steady_change * steady_change;
}

void World::State::measure_warping() {
  for (std::size_t k = 0; k < force.size(); ++k) change[k] = force[k] - applied[k];
  for_each_soft([&](std::uint32_t index) {
    SoftBody& body = soft(index);
    body_steps[index].warping_energy_j = 0;
    body_steps[index].is_warping_wild = false;
    body.warping_defect.setZero();
    if (settings.contact_method != ContactMethod::warped || body_contacts[index].empty()) return;
    body.rest_frame.setZero();
    body_contacts[index].add_forces(change, body.rest_frame);
    body.measure_warping_defect();
    judge_warping(index);
    body.warping_defect *= gives_defect_back(index) ? given_back : 0;
  });
}

}  // namespace souple
