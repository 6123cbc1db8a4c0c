// SPDX-License-Identifier: MIT
#include "runtime/world/bodies.hpp"

#include <algorithm>
#include <cmath>

namespace souple {

SoftBody::SoftBody(std::shared_ptr<const SoftBodyAsset> shared, std::string body_name)
    : asset(std::move(shared)),
      name(std::move(body_name)),
      is_fixed(asset->model().node_count(), 0),
      tangent(asset->model().pattern()),
      solver(asset->model().node_count()),
      surface(asset->surface()) {
  const Eigen::Index size = 3 * Eigen::Index{asset->model().node_count()};
  for (auto* vector : {&x, &v, &motion, &load, &rest_frame}) vector->setZero(size);
  element_rotations.resize(asset->model().tet_count());
  node_rotations.resize(asset->model().node_count());
  double weight = 0;
  for (const double mass : asset->model().masses()) weight += mass * mass;
  mass_norm_ = std::sqrt(weight);
}

void SoftBody::prepare_free_motion(double h, const Vec3& gravity) {
  const CorotationalModel& model = asset->model();
  model.element_rotations(x, element_rotations);
  model.node_rotations(element_rotations, node_rotations);
  model.assemble(1 / (h * h) + model.rayleigh_mass_per_s() / h, 1 + model.rayleigh_stiffness_s() / h,
                 element_rotations, tangent);
  for (Index node = 0; node < model.node_count(); ++node)
    node_entry(load, node) = model.masses()[node] * (gravity + node_entry(v, node) / h);
  model.add_elastic_forces(x, element_rotations, load);
  hold_fixed_nodes();
}

// Fixed nodes keep an identity row, so that the solver needs no other pattern.
void SoftBody::hold_fixed_nodes() {
  if (free_nodes.size() == is_fixed.size()) return;
  const BlockPattern& pattern = asset->model().pattern();
  for (Index row = 0; row < pattern.node_count(); ++row) {
    if (is_fixed[row]) node_entry(load, row).setZero();
    for (Index b = pattern.row_begin[row]; b < pattern.row_begin[row + 1]; ++b)
      if (pattern.column[b] != row && (is_fixed[row] || is_fixed[pattern.column[b]]))
        tangent.block(b).setZero();
    if (is_fixed[row]) tangent.block(pattern.diagonal[row]).setIdentity();
  }
}

ConjugateGradientReport SoftBody::solve_free_motion(double h, const FreeMotionSettings& settings) {
  motion = h * v;
  return solve_from_motion(h, settings);
}

ConjugateGradientReport SoftBody::solve_from_motion(double h, const FreeMotionSettings& settings) {
  // At rest the load vanishes by cancellation; its size is then judged against the inertia that one
  // micrometre-per-second would have, so that the solver does not chase round-off.
  const double floor = mass_norm_ * 1e-6 / h;
  return solver.solve(tangent, load, settings.tolerance, std::max(load.norm(), floor),
                      settings.max_iterations, motion);
}

double SoftBody::kinetic_energy() const {
  double energy = 0;
  for (Index node = 0; node < asset->model().node_count(); ++node)
    energy += 0.5 * asset->model().masses()[node] * node_entry(v, node).squaredNorm();
  return energy;
}

double SoftBody::elastic_energy() {
  asset->model().element_rotations(x, element_rotations);
  return asset->model().elastic_energy(x, element_rotations);
}

double SoftBody::potential_energy(const Vec3& gravity) const {
  double energy = 0;
  for (Index node = 0; node < asset->model().node_count(); ++node)
    energy -= asset->model().masses()[node] * gravity.dot(node_entry(x, node));
  return energy;
}

double SoftBody::largest_speed() const {
  double largest = 0;
  for (Index node = 0; node < asset->model().node_count(); ++node)
    largest = std::max(largest, node_entry(v, node).squaredNorm());
  return std::sqrt(largest);
}

Pose RigidBody::pose_at(double time_s) const {
  const auto after = std::ranges::upper_bound(path, time_s, {}, &Keyframe::time_s);
  if (after == path.begin()) return path.front().pose;
  if (after == path.end()) return path.back().pose;
  const Keyframe &from = *(after - 1), &to = *after;
  const double fraction = (time_s - from.time_s) / (to.time_s - from.time_s);
  const auto quaternion = [](const Pose& p) {
    return Eigen::Quaterniond(p.rotation[0], p.rotation[1], p.rotation[2], p.rotation[3]).normalized();
  };
  const Eigen::Quaterniond q = quaternion(from.pose).slerp(fraction, quaternion(to.pose));
  const Vec3 translation =
      (1 - fraction) * as_vec3(from.pose.translation) + fraction * as_vec3(to.pose.translation);
  return {{q.w(), q.x(), q.y(), q.z()}, as_point(translation)};
}

}  // namespace souple
