// SPDX-License-Identifier: MIT
#include "runtime/world/contact_operator.hpp"

#include <algorithm>

#include "runtime/fem/cross_matrix.hpp"

namespace souple {

void RigidContacts::collect(std::uint32_t index, const RigidBody& body,
                            std::span<const Contact> contacts, std::span<const std::uint32_t> own) {
  contacts_.assign(own.begin(), own.end());
  levers_.clear();
  for (const std::uint32_t i : own) {
    const bool is_a = contacts[i].a.body == index;
    levers_.push_back(
        {(is_a ? 1.0 : -1.0) * contacts[i].frame, is_a ? contacts[i].a.arm : contacts[i].b.arm});
  }
  shift_compliance_ = body.free->shift_compliance;
  turn_compliance_ = body.free->turn_compliance;
  clear_gap();
}

// Gap per rotation vector: F^T (turn x arm).
Mat3 RigidContacts::jacobian_of_turn(const Lever& lever) const {
  return -lever.frame.transpose() * cross_matrix(lever.arm);
}

Mat3 RigidContacts::diagonal_block(std::size_t local) const {
  const Mat3 turn = jacobian_of_turn(levers_[local]);
  return shift_compliance_ * Mat3::Identity() + turn * turn_compliance_ * turn.transpose();
}

void RigidContacts::clear_gap() {
  shift_.setZero();
  turn_.setZero();
}

Vec3 RigidContacts::gap(std::size_t local) const {
  const Lever& lever = levers_[local];
  return lever.frame.transpose() * (shift_ + turn_.cross(lever.arm));
}

void RigidContacts::add_influence(std::size_t local, const Vec3& change) {
  const Lever& lever = levers_[local];
  const Vec3 force = lever.frame * change;
  shift_ += shift_compliance_ * force;
  turn_ += turn_compliance_ * lever.arm.cross(force);
}

void StepContactOperator::begin(std::size_t contact_count) {
  links_.clear();
  links_.resize(contact_count);
}

void StepContactOperator::link(std::size_t contact, const Link& link) {
  Links& links = links_[contact];
  (links[0].soft || links[0].rigid ? links[1] : links[0]) = link;
}

void StepContactOperator::add(BodyContacts& body) {
  for (std::size_t k = 0; k < body.contacts().size(); ++k)
    link(body.contacts()[k], {&body.block(), nullptr, k});
}

void StepContactOperator::add(RigidContacts& body) {
  for (std::size_t k = 0; k < body.contacts().size(); ++k)
    link(body.contacts()[k], {nullptr, &body, k});
}

Mat3 StepContactOperator::diagonal_block(std::size_t i) const {
  Mat3 block = Mat3::Zero();
  for_links(i, [&](const auto& body, std::size_t local) { block += body.diagonal_block(local); });
  return block;
}

void StepContactOperator::clear_gap(std::size_t i) {
  for_links(i, [](auto& body, std::size_t) { body.clear_gap(); });
}

Vec3 StepContactOperator::gap(std::size_t i) const {
  Vec3 sum = Vec3::Zero();
  for_links(i, [&](const auto& body, std::size_t local) { sum += body.gap(local); });
  return sum;
}

void StepContactOperator::add_influence(std::size_t i, const Vec3& change) {
  for_links(i, [&](auto& body, std::size_t local) { body.add_influence(local, change); });
}

void StepContactOperator::add_to_base(std::size_t i, const Vec3& force) {
  for_links(i, [&](auto& body, std::size_t local) { body.add_to_base(local, force); });
}

void IslandOperator::start(std::span<const double> force) {
  for (const std::uint32_t i : contacts_) all_.clear_gap(i);
  for (std::size_t i = 0; i < contacts_.size(); ++i) {
    const Vec3 f(force[3 * i], force[3 * i + 1], force[3 * i + 2]);
    if (f != Vec3::Zero()) all_.add_to_base(contacts_[i], f);
  }
}

}  // namespace souple
