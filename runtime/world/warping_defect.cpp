// SPDX-License-Identifier: MIT
// Warped contact forces move a body by R C0 R^T instead of A^-1. What that motion leaves of
// A dx = b + H^T f is its defect, an external force of which nobody knows. Its momentum and spin, which
// nothing would ever undo, are owed to the body and given back; what it did to the shape the elastic
// forces undo by themselves, and giving that back as well would do it twice: folded bodies then tremble
// for ever. In the impact of a body that is crushed on its way the defect's work may exceed all the
// energy there is; that is bounded here. Bodies that are little deformed never notice.
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

// Of the velocity owed, that a step gives back. Where contacts hold the body, forces near rest obey
// e <- q e, q = 1 - W_warped^-1 W_true, and with a share s given back z (z - 1 + s) = q ((1 - s) z - 1
// + 2 s): z = 1/2 + q/2 for one half, which is stable from q = -3 on instead of -1; all of it at once
// lets bodies that warping makes too stiff rock for ever.
constexpr double given_back = 0.5;

}  // namespace

void SoftBody::find_warping_defect() {
  rest_frame += load;
  multiply(tangent, motion, load);
  rest_frame -= load;
}

void SoftBody::give_back_momentum(double h) {
  const CorotationalModel& model = asset->model();
  if (free_nodes.size() != is_fixed.size()) return;
  for (Index node = 0; node < model.node_count(); ++node)
    node_entry(rest_frame, node) *= h / model.masses()[node];
  RigidVelocity given = rigid_velocity(model, x, rest_frame);
  owed.linear += given.linear;
  owed.angular += given.angular;
  given.linear = given_back * owed.linear;
  given.angular = given_back * owed.angular;
  owed.linear -= given.linear;
  owed.angular -= given.angular;
  for (Index node = 0; node < model.node_count(); ++node)
    node_entry(v, node) += given.at(node_entry(x, node));
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

// Of a defect found, whose contact forces moved the body by `impact_j`. Slower bodies come to rest by
// warped forces alone; taking energy from them there would keep them from it.
void World::State::judge_warping(std::uint32_t index, double impact_j) {
  const SoftBody& body = soft(index);
  BodyStep& result = body_steps[index];
  const double h = settings.time_step_s, speed = wild_motion * body.asset->longest_side_m() / h;
  const double before = body.kinetic_energy();
  if (!(before > 0.5 * body.asset->model().total_mass() * speed * speed)) return;
  double kinetic = 0;
  for (Index node = 0; node < body.asset->model().node_count(); ++node)
    kinetic += 0.5 * body.asset->model().masses()[node] * node_entry(body.motion, node).squaredNorm() /
               (h * h);
  if (std::abs(impact_j) < impact_share * kinetic) return;
  result.warping_energy_j = std::max(0.0, -body.rest_frame.dot(body.motion));
  result.is_warping_wild = result.warping_energy_j > 0.5 * before;
}

void World::State::measure_warping() {
  for (std::size_t k = 0; k < force.size(); ++k) change[k] = force[k] - applied[k];
  for_each_soft([&](std::uint32_t index) {
    BodyStep& result = body_steps[index];
    result.warping_energy_j = 0;
    result.is_warping_wild = false;
    result.is_warped =
        settings.contact_method == ContactMethod::warped && !body_contacts[index].empty();
    if (!result.is_warped) return;
    SoftBody& body = soft(index);
    body.rest_frame.setZero();
    body_contacts[index].add_forces(change, body.rest_frame);
    const double impact_j = body.rest_frame.dot(body.motion);
    body.find_warping_defect();
    judge_warping(index, impact_j);
  });
}

}  // namespace souple
