// SPDX-License-Identifier: MIT
#include "runtime/world/bodies.hpp"

#include <algorithm>
#include <cmath>

namespace souple {

SoftBody::SoftBody(std::shared_ptr<const SoftBodyAsset> shared, std::string body_name)
    : asset(std::move(shared)),
      name(std::move(body_name)),
      is_fixed(asset->model().node_count(), 0),
      gradients(asset->model().make_corner_vectors()),
      corner_forces(asset->model().make_corner_vectors()),
      tangent(asset->model().pattern()),
      surface(asset->surface()) {
  const Eigen::Index size = 3 * Eigen::Index{asset->model().node_count()};
  for (auto* vector : {&x, &v, &motion, &load, &rest_frame}) vector->setZero(size);
  element_rotations.resize(asset->model().tet_count());
  node_rotations.resize(asset->model().node_count());
  double weight = 0;
  for (const double mass : asset->model().masses()) weight += mass * mass;
  mass_norm_ = std::sqrt(weight);
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

void SoftBody::add_load(AppliedLoad added) {
  loads.push_back(std::move(added));
  applied_load_.setZero(x.size());
}

void SoftBody::drive(std::vector<DrivenNodes> parts) {
  driven = std::move(parts);
  if (driven.empty()) return;
  prescribed.setZero(x.size());
  driven_pull_.setZero(x.size());
}

// Of a world with another step or integrator the past is of no use.
void SoftBody::take_history(const SoftBody& other, bool same_step) {
  history.valid = same_step && other.history.valid && history.motion.size() > 0;
  if (!history.valid) return;
  history.motion = other.history.motion;
  history.velocity = other.history.velocity;
}

bool SoftBody::may_rest() const {
  return driven.empty() &&
         std::ranges::none_of(loads, [](const AppliedLoad& one) { return one.changes(); });
}

void SoftBody::stop() {
  v.setZero();
  motion.setZero();
  owed = {};
  history.valid = false;
}

double SoftBody::work_of_loads() const {
  return applied_load_.size() > 0 ? applied_load_.dot(motion) : 0;
}

Vec3 SoftBody::linear_momentum() const {
  Vec3 momentum = Vec3::Zero();
  for (Index node = 0; node < asset->model().node_count(); ++node)
    momentum += asset->model().masses()[node] * node_entry(v, node);
  return momentum;
}

Vec3 SoftBody::angular_momentum() const {
  Vec3 momentum = Vec3::Zero();
  for (Index node = 0; node < asset->model().node_count(); ++node)
    momentum +=
        asset->model().masses()[node] * Vec3(node_entry(x, node)).cross(Vec3(node_entry(v, node)));
  return momentum;
}

double SoftBody::largest_speed() const {
  double largest = 0;
  for (Index node = 0; node < asset->model().node_count(); ++node)
    largest = std::max(largest, node_entry(v, node).squaredNorm());
  return std::sqrt(largest);
}

Vec3 SoftBody::mean_velocity() const {
  Vec3 sum = Vec3::Zero();
  for (const Index node : asset->surface().nodes()) sum += node_entry(v, node);
  return sum / double(std::max<std::size_t>(1, asset->surface().nodes().size()));
}

double SoftBody::largest_deviation(const Vec3& velocity) const {
  double largest = 0;
  for (const Index node : asset->surface().nodes())
    largest = std::max(largest, (node_entry(v, node) - velocity).squaredNorm());
  return std::sqrt(largest);
}

}  // namespace souple
