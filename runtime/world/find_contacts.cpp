// SPDX-License-Identifier: MIT
// Which contacts a step has: pairs of bodies that may meet in it, the features of theirs that are near,
// joints and grabs.
#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

#include "runtime/world/world_state.hpp"

namespace souple {
namespace {

// Share of a body's longest side that the automatic alarm distance adds to what a step can travel.
constexpr double alarm_share = 0.01;

// Of the smaller body's longest side: what a step may travel within the alarm distance.
constexpr double fastest_part = 0.025;

}  // namespace

// Longest side, m.
double World::State::body_size(std::uint32_t index) const {
  return is_soft(index) ? soft(index).asset->longest_side_m() : rigid(index).longest_side();
}

// Mean velocity, and how far that of any of its points in `region` may be from it, m/s.
World::State::BodyMotion World::State::body_motion(std::uint32_t index,
                                                   const Eigen::AlignedBox3d& region) const {
  if (!is_awake(index)) return {};
  if (!is_soft(index)) return rigid(index).motion_in(region, settings.time_step_s);
  const SoftBody& body = soft(index);
  return {body.mean_velocity(), body.largest_deviation(body.mean_velocity())};
}

double World::State::relative_speed(std::uint32_t a, std::uint32_t b) const {
  if (a == b) return 2 * body_motion(a, body_bounds(a)).deviation;
  const BodyMotion one = body_motion(a, body_bounds(b)), two = body_motion(b, body_bounds(a));
  return (one.velocity - two.velocity).norm() + one.deviation + two.deviation;
}

Eigen::AlignedBox3d World::State::body_bounds(std::uint32_t index) const {
  return is_soft(index) ? soft(index).surface.bounds() : rigid(index).bounds();
}

// Below this gap two bodies may meet within the step. A contact keeps a half space free, which far from
// where they meet is too much: what travels farther is left to the swept tests.
double World::State::alarm_distance(std::uint32_t a, std::uint32_t b) const {
  if (settings.alarm_distance_m > 0) return settings.alarm_distance_m;
  const double h = settings.time_step_s;
  return margin_of_touch(a, b) + look_ahead(a, b) + gravity.norm() * h * h +
         std::min(h * relative_speed(a, b), fastest_part * smaller_size({a, 0, b, 0}));
}

// Longest side of the smaller of the bodies that forces move: a floor has any size. m.
double World::State::smaller_size(const ContactKey& key) const {
  double size = std::numeric_limits<double>::infinity();
  for (const std::uint32_t index : {key.body_a, key.body_b})
    if (index != ContactSide::no_body && (is_soft(index) || rigid(index).free))
      size = std::min(size, body_size(index));
  return size;
}

// What counts as near.
double World::State::margin_of_touch(std::uint32_t a, std::uint32_t b) const {
  return alarm_share * smaller_size({a, 0, b, 0});
}

// What a hand that holds one of them may close before the next step, m.
double World::State::look_ahead(std::uint32_t a, std::uint32_t b) const {
  double distance = 0;
  for (const std::uint32_t k : {a, b})
    if (k < bodies.size() && !is_soft(k) && rigid(k).held)
      distance = std::max(distance, rigid(k).held->coupling.look_ahead_m);
  return distance;
}

// Whether the two can touch and forces would move at least one of them; `a` == `b`: itself.
bool World::State::may_touch(std::uint32_t a, std::uint32_t b) const {
  if (a == b) return is_soft(a) && soft(a).self_contact;
  const auto moved_by_forces = [&](std::uint32_t k) { return is_soft(k) || rigid(k).free; };
  return (moved_by_forces(a) || moved_by_forces(b)) && pair(a, b).collides;
}

Eigen::AlignedBox3d World::State::movable_region() const {
  Eigen::AlignedBox3d region;
  for (std::uint32_t k = 0; k < bodies.size(); ++k)
    if (is_soft(k) || rigid(k).free) region.extend(body_bounds(k));
  return region;
}

// How far a body may be from another that it touches within the step.
double World::State::reach(std::uint32_t index, const Eigen::AlignedBox3d& movable) const {
  if (settings.alarm_distance_m > 0) return settings.alarm_distance_m;
  const double h = settings.time_step_s;
  const BodyMotion motion = body_motion(index, movable);
  return alarm_share * body_size(index) + look_ahead(index, index) + gravity.norm() * h * h +
         h * (motion.velocity.norm() + motion.deviation);
}

// All pairs whose boxes come near each other in the step.
void World::State::find_touching_pairs() {
  const Eigen::AlignedBox3d movable = movable_region();
  const auto count = std::uint32_t(bodies.size());
  for (std::uint32_t k = 0; k < count; ++k) {
    const Vec3 around = Vec3::Constant(reach(k, movable));
    const Eigen::AlignedBox3d box = body_bounds(k);
    broad_phase.set_box(k, {box.min() - around, box.max() + around});
  }
  touching.clear();
  const auto add = [&](std::uint32_t a, std::uint32_t b) {
    if (!may_touch(a, b) || sleeps_on(a, b)) return;
    PairContacts& pair = touching.add();
    pair.a = a;
    pair.b = b;
    pair.alarm_distance_m = alarm_distance(a, b);
  };
  for (const auto& [a, b] : broad_phase.find_pairs()) add(a, b);
  for (const auto index : awake_soft) add(index, index);
}

void World::State::detect_pair(PairContacts& found) {
  find_near(*bodies[found.a], *bodies[found.b], found);
  describe_pair(found);
}

void World::State::describe_pair(PairContacts& found) const {
  const PairRule rule = pair(found.a, found.b);
  for (Contact& contact : found.contacts) {
    contact.law = {ConstraintLaw::Kind::frictional, rule.friction};
    contact.restitution = rule.restitution;
  }
}

// Bodies that are asleep are woken by what comes near, and then have pairs of their own.
void World::State::find_contacts() {
  for_each_soft([&](std::uint32_t index) { soft(index).surface.refit(soft(index).x); });
  const auto detect = [&](std::size_t k) { detect_pair(touching[k]); };
  do {
    find_touching_pairs();
    run(touching.size(), detect);
  } while (wake_touched());
  contacts.clear();
  for (std::size_t k = 0; k < touching.size(); ++k) {
    const PairContacts& found = touching[k];
    if (is_awake(found.a) && is_awake(found.b))
      contacts.insert(contacts.end(), found.contacts.begin(), found.contacts.end());
  }
  add_pin_contacts();
  for (Contact& contact : contacts) complete(contact);
  std::ranges::sort(contacts, {}, &Contact::key);
  leave_out_uncovered();
  describe_contacts();
}

// Where the bodies are touched, and how those move that forces do not.
void World::State::complete(Contact& c) const {
  const Vec3 point_a = c.point + c.gap * c.frame.col(0);
  for (const auto& [side, sign, point] :
       {std::tuple(&c.a, -1.0, point_a), std::tuple(&c.b, 1.0, c.point)}) {
    if (side->body == ContactSide::no_body) continue;
    if (is_soft(side->body)) {
      // Driven nodes of soft bodies move a contact as a rigid body's points do.
      const SoftBody& body = soft(side->body);
      for (std::size_t k = 0; k < std::size_t(side->count) && !body.driven.empty(); ++k)
        c.driven_motion += sign * side->weight[k] * node_entry(body.prescribed, side->node[k]);
    } else if (rigid(side->body).free) {
      side->arm = point - rigid(side->body).free->position;
    } else {
      c.driven_motion += sign * rigid(side->body).driven_motion_of(point);
    }
  }
}

// A compliance may be limited to the region of a body that is meant to be touched.
bool World::State::is_covered(const Contact& contact) const {
  const auto has_compliance = [&](const ContactSide& side) {
    if (side.count == 0 || !soft(side.body).compliance) return true;
    for (std::size_t k = 0; k < std::size_t(side.count); ++k)
      if (!soft(side.body).is_fixed[std::size_t(side.node[k])] &&
          soft(side.body).compliance->row_of_node[std::size_t(side.node[k])] < 0)
        return false;
    return true;
  };
  return has_compliance(contact.a) && has_compliance(contact.b);
}

void World::State::leave_out_uncovered() {
  uncovered = std::erase_if(contacts, [&](const Contact& c) { return !is_covered(c); });
}

// What follows from the list of contacts.
void World::State::describe_contacts() {
  laws.clear();
  for (auto& list : contacts_of_body) list.clear();
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    const Contact& c = contacts[i];
    laws.push_back(c.law);
    if (c.a.body != ContactSide::no_body) contacts_of_body[c.a.body].push_back(std::uint32_t(i));
    if (c.b.body != ContactSide::no_body && c.b.body != c.a.body)
      contacts_of_body[c.b.body].push_back(std::uint32_t(i));
  }
  for_each_soft([&](std::uint32_t index) {
    body_contacts[index].collect(index, soft(index), contacts, contacts_of_body[index]);
  });
}

// All that may touch soon is asked for, so that a streaming source can fetch it in time.
void World::State::ask_ahead() const {
  if (settings.contact_method != ContactMethod::warped) return;
  for (const auto index : awake_soft)
    if (!body_contacts[index].empty()) (void)body_contacts[index].ready(soft(index));
}

Status World::State::check_ready() const {
  if (settings.contact_method != ContactMethod::warped) return {};
  for (const auto index : awake_soft)
    if (!body_contacts[index].empty() && !body_contacts[index].ready(soft(index)))
      return make_issue(IssueCode::compliance_not_loaded,
                        "a body touches with nodes whose compliance has not been read yet",
                        soft(index).name);
  return {};
}

}  // namespace souple
