// SPDX-License-Identifier: MIT
// Bodies at rest: all that touch each other fall asleep together and are woken together.
#include <algorithm>

#include "runtime/world/world_state.hpp"

namespace souple {
namespace {

// Of the distance at which contacts are looked for: as near as this is a touch.
constexpr double share_of_touch = 0.1;

}  // namespace

// Whether it moves in this step, or may.
bool World::State::is_active(std::uint32_t index) const {
  if (is_movable(index)) return true;
  if (is_soft(index) || rigid(index).free) return false;
  const RigidBody& body = rigid(index);
  return body.start.rotation != body.end.rotation || body.start.translation != body.end.translation;
}

// Whether nothing can happen between the two, since one sleeps and the other does not move.
bool World::State::sleeps_on(std::uint32_t a, std::uint32_t b) const {
  const auto asleep = [&](std::uint32_t k) { return k < rest.size() && rest[k].is_asleep; };
  const auto still = [&](std::uint32_t k) { return k >= rest.size() || !is_active(k); };
  return (asleep(a) || asleep(b)) && still(a) && still(b);
}

void World::State::wake_group(std::uint32_t index) {
  if (is_awake(index)) return;
  const std::uint32_t group = rest[index].group;
  for (std::uint32_t k = 0; k < bodies.size(); ++k) {
    if (!rest[k].is_asleep || rest[k].group != group) continue;
    rest[k] = {};
    if (!is_soft(k)) {
      rigid(k).begin_step(time, settings.time_step_s);
      continue;
    }
    awake_soft.insert(std::ranges::lower_bound(awake_soft, k), k);
    begin_soft(k);
    soft(k).surface.refit(soft(k).x);
  }
}

// What sleeps and is touched by something that moves; true if there was any.
bool World::State::wake_touched() {
  bool woke = false;
  for (std::size_t k = 0; k < touching.size(); ++k) {
    const PairContacts& found = touching[k];
    if (is_awake(found.a) == is_awake(found.b)) continue;
    const std::uint32_t asleep = is_awake(found.a) ? found.b : found.a;
    const double reach = share_of_touch * margin_of_touch(found.a, found.b) +
                         settings.time_step_s * relative_speed(found.a, found.b);
    if (std::ranges::none_of(found.contacts, [&](const Contact& c) { return c.gap < reach; })) continue;
    wake_group(asleep);
    woke = true;
  }
  return woke;
}

bool World::State::is_quiet(std::uint32_t index) const {
  const double limit = settings.sleep_speed * body_size(index);
  if (!is_soft(index) && rigid(index).held) return false;  // what a hand holds has to be felt
  if (is_soft(index)) return soft(index).may_rest() && soft(index).largest_speed() < limit;
  const BodyMotion motion = rigid(index).motion_in(body_bounds(index), settings.time_step_s);
  return motion.velocity.norm() + motion.deviation < limit;
}

// A group sleeps once all of it has been quiet for long enough, and is not held by what moves.
void World::State::put_to_sleep() {
  if (!(settings.sleep_after_s > 0)) return;
  for (std::uint32_t k = 0; k < bodies.size(); ++k)
    if (is_movable(k)) rest[k].quiet_s = is_quiet(k) ? rest[k].quiet_s + settings.time_step_s : 0;
  islands.build(contacts, bodies.size(), [&](std::uint32_t index) { return is_movable(index); });
  for (const Contact& c : contacts)
    for (const std::uint32_t k : {c.a.body, c.b.body})
      if (k == ContactSide::no_body || (!is_movable(k) && is_active(k)))
        rest[islands.root(is_movable(c.a.body) ? c.a.body : c.b.body)].quiet_s = 0;
  std::vector<std::uint32_t>& groups = sleep_groups;
  groups.clear();
  for (std::uint32_t k = 0; k < bodies.size(); ++k)
    if (is_movable(k)) {
      auto& root = rest[islands.root(k)].quiet_s;
      root = std::min(root, rest[k].quiet_s);
      groups.push_back(k);
    }
  for (const std::uint32_t k : groups) rest[k].group = islands.root(k);
  for (const std::uint32_t k : groups) {
    if (rest[rest[k].group].quiet_s < settings.sleep_after_s) continue;
    rest[k].is_asleep = true;
    if (is_soft(k))
      soft(k).stop();
    else
      rigid(k).stop();
    body_steps[k].kinetic_energy_j = 0;
  }
}

}  // namespace souple
