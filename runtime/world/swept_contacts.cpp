// SPDX-License-Identifier: MIT
// Contacts that the alarm distance does not show: what meets on its way through a step.
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "runtime/world/world_state.hpp"

namespace souple {
namespace {

// Of the smaller body's longest side: what may end inside another body until the next step finds it.
constexpr double depth_left = 3e-4;

// Of the same: what is closer at the start touches, has no sure direction, and is held by what is near.
constexpr double touches = 3e-5;

// Cosine between the normals of contacts that keep the same half space free.
constexpr double same_plane = 0.97;

// Contacts of a vertex or edge with the same body on another plane are numbered from here.
constexpr Index first_twin = -100;

}  // namespace

// Mean motion in this step, and how far that of any point may be from it, m.
World::State::BodyMotion World::State::free_motion_of(std::uint32_t index,
                                                      const Eigen::AlignedBox3d& region) const {
  const double h = settings.time_step_s;
  if (!is_soft(index)) {
    const RigidBody& body = rigid(index);
    if (body.free) return {body.free->shift, body.free->turn.norm() * std::sqrt(3.0) * body.size};
    const BodyMotion rate = body.motion_in(region, h);
    return {h * rate.velocity, h * rate.deviation};
  }
  const SoftBody& body = soft(index);
  Vec3 mean = Vec3::Zero();
  for (const Index node : body.asset->surface().nodes()) mean += node_entry(body.motion, node);
  mean /= double(body.asset->surface().nodes().size());
  double farthest = 0;
  for (const Index node : body.asset->surface().nodes())
    farthest = std::max(farthest, (node_entry(body.motion, node) - mean).squaredNorm());
  return {mean, std::sqrt(farthest)};
}

double World::State::free_approach(std::uint32_t a, std::uint32_t b) const {
  const BodyMotion one = free_motion_of(a, body_bounds(b)), two = free_motion_of(b, body_bounds(a));
  return (one.velocity - two.velocity).norm() + one.deviation + two.deviation;
}

// What meets in the motion so far though it is `alarm` apart at the start, and is `least_depth` past
// each other at the end, into `found`.
void World::State::sweep_pair(PairContacts& found, double alarm, double least_depth) {
  const double kept = std::exchange(found.alarm_distance_m, alarm);
  found.contacts.clear();
  find_swept(*bodies[found.a], *bodies[found.b], least_depth, found);
  found.alarm_distance_m = kept;
  describe_pair(found);
  for (Contact& contact : found.contacts) complete(contact);
}

// What the free motion would carry through another body though it began farther away than contacts are
// looked for.
void World::State::add_swept_contacts() {
  run(touching.size(), [&](std::size_t k) {
    PairContacts& found = touching[k];
    found.contacts.clear();
    if (found.a == found.b || !is_awake(found.a) || !is_awake(found.b)) return;
    if (free_approach(found.a, found.b) > found.alarm_distance_m)
      sweep_pair(found, found.alarm_distance_m, -std::numeric_limits<double>::infinity());
  });
  const std::size_t before = contacts.size();
  for (std::size_t k = 0; k < touching.size(); ++k)
    for (const Contact& contact : touching[k].contacts) {
      const auto end = contacts.begin() + std::ptrdiff_t(before);
      const auto known =
          std::ranges::lower_bound(contacts.begin(), end, contact.key, {}, &Contact::key);
      if (known != end && known->key == contact.key) continue;
      if (is_covered(contact))
        contacts.push_back(contact);
      else
        ++uncovered;
    }
  if (contacts.size() > before) order_contacts();
}

// Its place among the contacts if nothing keeps that half space free. Two edges have one; what else
// touches in several places is numbered.
std::optional<ContactKey> World::State::key_if_missing(const Contact& contact) const {
  ContactKey key = contact.key;
  bool is_taken = false;
  Index number = first_twin;
  for (const std::uint32_t i : contacts_of_body[key.body_a]) {
    const ContactKey& other = contacts[i].key;
    if (other.feature_a != key.feature_a || other.body_a != key.body_a || other.body_b != key.body_b)
      continue;
    if (contacts[i].frame.col(0).dot(contact.frame.col(0)) > same_plane) return {};
    is_taken = is_taken || other.feature_b == key.feature_b;
    number = std::min(number, other.feature_b - 1);
  }
  if (is_taken && contact.a.count == 2) return {};
  if (is_taken) key.feature_b = number;
  return key;
}

// What the corrected motion carries through another body past the planes of its contacts: beyond the
// silhouette of what was nearest at the start another face waits. Pairs whose bodies have got no
// contact since the last look move as they did then.
void World::State::add_crossing(bool first_look) {
  run(touching.size(), [&](std::size_t k) {
    PairContacts& found = touching[k];
    found.contacts.clear();
    if (found.a == found.b || !is_awake(found.a) || !is_awake(found.b)) return;
    if (!has_surface(*bodies[found.a]) && !has_surface(*bodies[found.b])) return;
    if (!first_look && !body_steps[found.a].has_new_contacts && !body_steps[found.b].has_new_contacts)
      return;
    const double size = smaller_size({found.a, 0, found.b, 0}), least_depth = depth_left * size;
    if (free_approach(found.a, found.b) > margin_of_touch(found.a, found.b))
      sweep_pair(found, touches * size, least_depth);
    std::erase_if(found.contacts, [&](Contact& contact) {
      if (contact.key.feature_a < 0 || contact.gap + normal_motion(contact) > -least_depth) return true;
      const auto key = key_if_missing(contact);
      if (key) contact.key = *key;
      return !key || !is_covered(contact);
    });
  });
  for (std::size_t k = 0; k < touching.size(); ++k)
    contacts.insert(contacts.end(), touching[k].contacts.begin(), touching[k].contacts.end());
}

}  // namespace souple
