// SPDX-License-Identifier: MIT
#include "runtime/world/contact_space.hpp"

#include <algorithm>
#include <numeric>

namespace souple {

void BodyContacts::collect(std::uint32_t index, const SoftBody& body, std::span<const Contact> contacts,
                           std::span<const std::uint32_t> own) {
  touches_.clear();
  nodes_.clear();
  contacts_.clear();
  frames_.clear();
  for (const std::uint32_t i : own) {
    const auto local = static_cast<Index>(contacts_.size());
    const std::size_t before = touches_.size();
    for (const auto& [side, sign] : {std::pair(&contacts[i].a, 1.0), std::pair(&contacts[i].b, -1.0)}) {
      if (side->body != index) continue;
      for (int k = 0; k < side->count; ++k) {
        const Index node = side->node[std::size_t(k)];
        if (body.is_fixed[node] || side->weight[std::size_t(k)] == 0) continue;
        touches_.push_back({local, node, sign * side->weight[std::size_t(k)]});
        nodes_.push_back(node);
      }
    }
    if (touches_.size() == before) continue;
    contacts_.push_back(i);
    frames_.push_back(contacts[i].frame);
  }
  std::ranges::sort(nodes_);
  nodes_.erase(std::unique(nodes_.begin(), nodes_.end()), nodes_.end());
  for (Touch& touch : touches_)
    touch.node = static_cast<Index>(std::ranges::lower_bound(nodes_, touch.node) - nodes_.begin());
  rows_.clear();
  if (body.compliance)
    for (const Index node : nodes_) rows_.push_back(body.compliance->row_of_node[node]);
}

bool BodyContacts::ready(const SoftBody& body) const {
  const RestCompliance& rest = *body.compliance->rest;
  return rest.ready(rows_) && rest.ready_to_apply(rows_);
}

void BodyContacts::evaluate_warped(const SoftBody& body) {
  rotations_.clear();
  for (const Index node : nodes_) rotations_.push_back(body.node_rotations[node]);
  blocks_.update(*body.compliance->rest, rows_);
}

namespace {

bool is_free(const SoftBody& body) { return body.free_nodes.size() == body.is_fixed.size(); }

// 1 / a_M of the system that the body's compliance inverts.
double rigid_factor(const SoftBody& body) {
  return body.compliance_scale / body.compliance->header.mass_factor;
}

}  // namespace

// C <- r C - (r - 1) C_rigid: stays positive semi-definite, and keeps the momentum of a free body.
void BodyContacts::build_warped(const SoftBody& body, double relaxation) {
  block_.resize(contacts_.size());
  const ContactGeometry geometry{touches_, frames_, rotations_};
  add_to_delassus(geometry, {blocks_.values(), blocks_.stride(), blocks_.slots()},
                  relaxation * body.compliance_scale, block_.values(), warped_work_);
  if (relaxation != 1 && is_free(body)) {
    points_.clear();
    for (const Index node : nodes_)
      points_.emplace_back(as_vec3(body.asset->model().rest_positions()[std::size_t(node)]));
    add_rigid_to_delassus(geometry, body.asset->rigid_modes(), points_,
                          (1 - relaxation) * rigid_factor(body), block_.values(), exact_work_);
  }
  block_.finish();
}

// The same operator on the correction of all nodes, in the rest frame.
void BodyContacts::relax_motion(SoftBody& body, double relaxation) const {
  body.rest_frame *= relaxation;
  if (!is_free(body)) return;
  const auto rest = body.asset->model().rest_positions();
  const RigidModes& modes = body.asset->rigid_modes();
  Vec3 force = Vec3::Zero(), moment = Vec3::Zero();
  for (std::size_t k = 0; k < loaded_nodes_.size(); ++k) {
    const Eigen::Map<const Vec3> f(rest_force_.data() + 3 * k);
    force += f;
    moment += (as_vec3(rest[std::size_t(loaded_nodes_[k])]) - modes.centre()).cross(f);
  }
  // rest_force_ already carries the compliance's scale.
  const double factor = (relaxation - 1) / body.compliance->header.mass_factor;
  const Vec3 shift = factor * modes.inverse_mass() * force;
  const Vec3 turn = factor * (modes.inverse_inertia() * moment);
  for (Index node = 0; node < body.asset->model().node_count(); ++node)
    node_entry(body.rest_frame, node) -=
        shift + turn.cross(as_vec3(rest[std::size_t(node)]) - modes.centre());
}

void BodyContacts::evaluate_exact(const SoftBody& body) {
  const std::size_t size = 3 * nodes_.size();
  rows_.clear();
  for (const Index node : nodes_)
    rows_.push_back(Index(std::ranges::lower_bound(body.free_nodes, node) - body.free_nodes.begin()));
  if (body.inverse_number == evaluated_inverse_ && rows_ == evaluated_rows_) return;
  evaluated_inverse_ = body.inverse_number;
  evaluated_rows_ = rows_;
  compliance_.resize(size * size);
  body.inverse->inverse_block(rows_, compliance_, inverse_work_);
}

void BodyContacts::build_exact() {
  block_.resize(contacts_.size());
  rotations_.assign(nodes_.size(), Mat3::Identity());
  identity_.resize(nodes_.size());
  std::iota(identity_.begin(), identity_.end(), Index{0});
  add_to_delassus<double>({touches_, frames_, rotations_},
                          {compliance_.data(), 3 * nodes_.size(), identity_}, 1, block_.values(),
                          exact_work_);
  block_.finish();
}

// In the world, on the node of the touch.
Vec3 BodyContacts::world_force(const Touch& touch, std::span<const double> force) const {
  const auto local = std::size_t(touch.contact);
  return touch.weight *
         (frames_[local] * Eigen::Map<const Vec3>(force.data() + 3 * std::size_t(contacts_[local])));
}

void BodyContacts::add_forces(std::span<const double> force, Eigen::VectorXd& load) const {
  for (const Touch& touch : touches_)
    node_entry(load, nodes_[std::size_t(touch.node)]) += world_force(touch, force);
}

void BodyContacts::add_motion(const Eigen::VectorXd& motion, std::span<double> gap) const {
  for (const Touch& touch : touches_) {
    const auto local = std::size_t(touch.contact);
    Eigen::Map<Vec3>(gap.data() + 3 * std::size_t(contacts_[local])) +=
        touch.weight *
        (frames_[local].transpose() * node_entry(motion, nodes_[std::size_t(touch.node)]));
  }
}

// Forces on the contact nodes in the rest frame; false if none carries any.
bool BodyContacts::collect_rest_forces(const SoftBody& body, std::span<const double> force) {
  node_force_.assign(3 * nodes_.size(), 0.0);
  for (const Touch& touch : touches_)
    Eigen::Map<Vec3>(node_force_.data() + 3 * touch.node) +=
        body.compliance_scale *
        (rotations_[std::size_t(touch.node)].transpose() * world_force(touch, force));
  loaded_nodes_.clear();
  loaded_rows_.clear();
  rest_force_.clear();
  for (std::size_t k = 0; k < nodes_.size(); ++k) {
    const double* f = node_force_.data() + 3 * k;
    if (f[0] == 0 && f[1] == 0 && f[2] == 0) continue;
    loaded_nodes_.push_back(nodes_[k]);
    loaded_rows_.push_back(rows_[k]);
    rest_force_.insert(rest_force_.end(), f, f + 3);
  }
  return !loaded_rows_.empty();
}

void BodyContacts::correct_warped(SoftBody& body, double relaxation, std::span<const double> force) {
  if (!collect_rest_forces(body, force)) return;
  const BodyCompliance& compliance = *body.compliance;
  rest_motion_.resize(3 * std::size_t(compliance.rest->row_count()));
  compliance.rest->apply(loaded_rows_, rest_force_, rest_motion_, compliance_work_);
  body.rest_frame.setZero();
  for (std::size_t row = 0; row < compliance.nodes.size(); ++row)
    node_entry(body.rest_frame, compliance.nodes[row]) =
        Eigen::Map<const Vec3>(rest_motion_.data() + 3 * row);
  compliance.extension.apply(body.rest_frame, body.extension_work);
  if (relaxation != 1) relax_motion(body, relaxation);
  for (Index node = 0; node < body.asset->model().node_count(); ++node)
    node_entry(body.motion, node).noalias() +=
        body.node_rotations[node] * node_entry(body.rest_frame, node);
}

void BodyContacts::correct_exact(SoftBody& body, std::span<const double> force) const {
  body.rest_frame.setZero();
  add_forces(force, body.rest_frame);
  const Eigen::Index unknowns = body.inverse->size();
  auto column = body.work.head(unknowns);
  for (std::size_t k = 0; k < body.free_nodes.size(); ++k)
    column.segment<3>(3 * Eigen::Index(k)) = node_entry(body.rest_frame, body.free_nodes[k]);
  body.inverse->solve(column, body.work.segment(unknowns, unknowns));
  for (std::size_t k = 0; k < body.free_nodes.size(); ++k)
    node_entry(body.motion, body.free_nodes[k]) += column.segment<3>(3 * Eigen::Index(k));
}

}  // namespace souple
