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
  bodies_ = 0;
}

void StepContactOperator::link(std::size_t contact, const Link& link) {
  Links& links = links_[contact];
  (links[0].soft || links[0].rigid ? links[1] : links[0]) = link;
}

void StepContactOperator::add(BodyContacts& body) {
  for (std::size_t k = 0; k < body.contacts().size(); ++k)
    link(body.contacts()[k], {&body.block(), nullptr, k, bodies_});
  ++bodies_;
}

void StepContactOperator::add(RigidContacts& body) {
  for (std::size_t k = 0; k < body.contacts().size(); ++k)
    link(body.contacts()[k], {nullptr, &body, k, bodies_});
  ++bodies_;
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

std::size_t StepContactOperator::rows_touched(std::size_t i) const {
  std::size_t rows = 0;
  for (const Link& link : links_[i])
    if (link.soft) rows += link.soft->columns().stride();
  return rows;
}

void StepContactOperator::gather(std::span<const std::uint32_t> contacts, PaddedColumns& to,
                                 GatherWork& work) const {
  auto& members = work.members;
  members.clear();
  for (std::size_t k = 0; k < contacts.size(); ++k)
    for (const Link& link : links_[contacts[k]])
      if (link.soft || link.rigid) members.push_back({link, std::uint32_t(k)});
  const auto body = [](const GatherWork::Member& m) { return std::pair(m.link.body, m.place); };
  std::ranges::sort(members, {}, body);
  for (auto first = members.begin(); first != members.end();) {
    const auto last = std::find_if(first, members.end(), [&](const GatherWork::Member& m) {
      return m.link.body != first->link.body;
    });
    if (first->link.soft)
      gather_soft({first, last}, to);
    else
      gather_rigid({first, last}, to, work);
    first = last;
  }
}

void StepContactOperator::gather_soft(Members members, PaddedColumns& to) {
  const PaddedColumns& from = members.front().link.soft->columns();
  for (const GatherWork::Member& column : members)
    for (std::size_t c = 0; c < 3; ++c) {
      const float* source = from.column(3 * column.link.local + c);
      float* target = to.column(3 * std::size_t(column.place) + c);
      for (const GatherWork::Member& row : members) {
        const float* entry = source + 3 * row.link.local;
        float* sum = target + 3 * std::size_t(row.place);
        for (std::size_t r = 0; r < 3; ++r) sum[r] += entry[r];
      }
    }
}

// W += J C J^T, J the six columns of the body's motion.
void StepContactOperator::gather_rigid(Members members, PaddedColumns& to, GatherWork& work) {
  const RigidContacts& body = *members.front().link.rigid;
  const std::size_t stride = to.stride();
  work.motion.assign(6 * stride, 0.0F);
  work.influence.assign(6 * stride, 0.0F);
  for (const GatherWork::Member& member : members) {
    const Mat3 line = body.jacobian_of_shift(member.link.local);
    const Mat3 turn = body.jacobian_of_turn(member.link.local);
    const Mat3 by_line = body.shift_compliance() * line, by_turn = turn * body.turn_compliance();
    const std::size_t row = 3 * std::size_t(member.place);
    for (Eigen::Index r = 0; r < 3; ++r)
      for (Eigen::Index c = 0; c < 3; ++c) {
        const std::size_t at = std::size_t(c) * stride + row + std::size_t(r);
        work.motion[at] = float(line(r, c));
        work.motion[at + 3 * stride] = float(turn(r, c));
        work.influence[at] = float(by_line(r, c));
        work.influence[at + 3 * stride] = float(by_turn(r, c));
      }
  }
  for (const GatherWork::Member& member : members) {
    const std::size_t first = 3 * std::size_t(member.place);
    for (std::size_t column = first; column < first + 3; ++column) {
      float* target = to.column(column);
      for (std::size_t m = 0; m < 6; ++m) {
        const float* motion = work.motion.data() + m * stride;
        const float factor = work.influence[m * stride + column];
        for (std::size_t r = 0; r < stride; ++r) target[r] += factor * motion[r];
      }
    }
  }
}

void IslandOperator::start(std::span<const double> force) {
  for (const std::uint32_t i : contacts_) all_.clear_gap(i);
  for (std::size_t i = 0; i < contacts_.size(); ++i) {
    const Vec3 f(force[3 * i], force[3 * i + 1], force[3 * i + 2]);
    if (f != Vec3::Zero()) all_.add_to_base(contacts_[i], f);
  }
}

}  // namespace souple
