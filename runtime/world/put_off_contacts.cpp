// SPDX-License-Identifier: MIT
// Which of the contacts that are near have to be solved for: those that the motion of the step closes.
#include <algorithm>
#include <numeric>

#include "runtime/world/world_state.hpp"

namespace souple {

// Of a side in the free motion, where forces move it, m.
Vec3 World::State::motion_of(const ContactSide& side) const {
  Vec3 motion = Vec3::Zero();
  if (side.body == ContactSide::no_body || !is_movable(side.body)) return motion;
  if (!is_soft(side.body)) return rigid(side.body).free->motion_of(side.arm);
  for (std::size_t k = 0; k < std::size_t(side.count); ++k)
    if (!soft(side.body).is_fixed[std::size_t(side.node[k])])
      motion += side.weight[k] * node_entry(soft(side.body).motion, side.node[k]);
  return motion;
}

// How far a contact opens along its normal in the free motion, m.
double World::State::normal_motion(const Contact& c) const {
  return c.frame.col(0).dot(motion_of(c.a) - motion_of(c.b) - c.driven_motion);
}

// The alarm distance covers whatever a step may bring; after the free motion most of those contacts are
// known to stay apart. Kept are those that carry force, and those that end near. Should the correction
// close one of the others, it is taken back (take_back_closed).
void World::State::discard_distant() {
  put_off.clear();
  std::size_t kept = 0;
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    const Contact& c = contacts[i];
    const bool is_pin = c.law.kind == ConstraintLaw::Kind::bilateral;
    if (!is_pin && at(force, i).isZero(0) &&
        c.gap + normal_motion(c) >
            margin_of_touch(c.key.body_a, c.key.body_b) + look_ahead(c.key.body_a, c.key.body_b)) {
      put_off.push_back(c);
      continue;
    }
    contacts[kept] = c;
    for (std::size_t k = 0; k < 3; ++k) {
      force[3 * kept + k] = force[3 * i + k];
      applied[3 * kept + k] = applied[3 * i + k];
    }
    ++kept;
  }
  if (put_off.empty()) return;
  contacts.resize(kept);
  force.resize(3 * kept);
  applied.resize(3 * kept);
  describe_contacts();
}

// Contacts that were put off and that the motion so far closes, back among the others without a force.
void World::State::take_back_closed() {
  std::erase_if(put_off, [&](const Contact& c) {
    if (c.gap + normal_motion(c) >= 0) return false;
    contacts.push_back(c);
    return true;
  });
}

// Contacts that were appended take their places among the others, without a force.
void World::State::order_contacts() {
  order.resize(contacts.size());
  std::iota(order.begin(), order.end(), 0u);
  std::ranges::sort(order, {}, [&](std::uint32_t i) { return contacts[i].key; });
  for (auto* rows : {&force, &applied, &included}) {
    rows->resize(3 * contacts.size(), 0.0);
    scratch_rows.resize(rows->size());
    for (std::size_t k = 0; k < order.size(); ++k)
      Eigen::Map<Vec3>(scratch_rows.data() + 3 * k) = at(*rows, order[k]);
    std::swap(*rows, scratch_rows);
  }
  std::ranges::sort(contacts, {}, &Contact::key);
  describe_contacts();
}

// A new contact changes the forces in all of its island, and with them how all of its bodies move.
void World::State::spread_new_contacts() {
  const auto for_sides = [&](std::uint32_t contact, auto&& visit) {
    for (const ContactSide* side : {&contacts[contact].a, &contacts[contact].b})
      if (side->body != ContactSide::no_body) visit(body_steps[side->body]);
  };
  for (std::size_t k = 0; k < islands.count(); ++k) {
    bool has_new = false;
    for (const std::uint32_t i : islands.contacts(k))
      for_sides(i, [&](const BodyStep& step) { has_new = has_new || step.has_new_contacts; });
    if (!has_new) continue;
    for (const std::uint32_t i : islands.contacts(k))
      for_sides(i, [](BodyStep& step) { step.has_new_contacts = true; });
  }
}

// Contacts that the motion so far calls for, without a force; false if there are none.
bool World::State::add_missing(bool first_look) {
  const std::size_t before = contacts.size();
  take_back_closed();
  spread_new_contacts();
  add_crossing(first_look);
  for (BodyStep& step : body_steps) step.has_new_contacts = false;
  for (std::size_t i = before; i < contacts.size(); ++i)
    for (const ContactSide* side : {&contacts[i].a, &contacts[i].b})
      if (side->body != ContactSide::no_body) body_steps[side->body].has_new_contacts = true;
  if (contacts.size() == before) return false;
  order_contacts();
  return true;
}

}  // namespace souple
