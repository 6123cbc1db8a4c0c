// SPDX-License-Identifier: MIT
// Which contacts a step has: pairs of bodies that may meet in it, the features of theirs that are near,
// joints and grabs; and which of them the free motion leaves to be solved for.
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <tuple>

#include "runtime/world/world_state.hpp"

namespace souple {
namespace {

// Share of a body's longest side that the automatic alarm distance adds to what a step can travel.
constexpr double alarm_share = 0.01;

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

// Below this gap two bodies may meet within the step. What moves faster in it than it did before is
// left to the swept test.
double World::State::alarm_distance(std::uint32_t a, std::uint32_t b) const {
  if (settings.alarm_distance_m > 0) return settings.alarm_distance_m;
  const double h = settings.time_step_s;
  return margin_of_touch(a, b) + gravity.norm() * h * h + h * relative_speed(a, b);
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
  return alarm_share * body_size(index) + gravity.norm() * h * h +
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
void World::State::leave_out_uncovered() {
  const auto is_covered = [&](const ContactSide& side) {
    if (side.count == 0 || !soft(side.body).compliance) return true;
    for (std::size_t k = 0; k < std::size_t(side.count); ++k)
      if (!soft(side.body).is_fixed[std::size_t(side.node[k])] &&
          soft(side.body).compliance->row_of_node[std::size_t(side.node[k])] < 0)
        return false;
    return true;
  };
  uncovered =
      std::erase_if(contacts, [&](const Contact& c) { return !is_covered(c.a) || !is_covered(c.b); });
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

// What the free motion would carry through another body though it began farther away than contacts are
// looked for: more than the alarm distance was meant for.
void World::State::add_swept_contacts() {
  bool found_any = false;
  for (std::size_t k = 0; k < touching.size(); ++k) {
    PairContacts& found = touching[k];
    if (found.a == found.b || !is_awake(found.a) || !is_awake(found.b)) continue;
    if (free_approach(found.a, found.b) <= found.alarm_distance_m) continue;
    found.contacts.clear();
    find_swept(*bodies[found.a], *bodies[found.b], swept_ends[0], swept_ends[1], found);
    describe_pair(found);
    for (Contact& contact : found.contacts) {
      complete(contact);
      const auto same = [&](const Contact& c) { return c.key == contact.key; };
      if (std::ranges::any_of(contacts, same)) continue;
      contacts.push_back(contact);
      found_any = true;
    }
  }
  if (!found_any) return;
  std::ranges::sort(contacts, {}, &Contact::key);
  leave_out_uncovered();
  describe_contacts();
  recall_forces();
}

// Mean motion in this step, and how far that of any point may be from it, m; no force is known yet.
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
        c.gap + normal_motion(c) > margin_of_touch(c.key.body_a, c.key.body_b)) {
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

// Contacts that were put off and that the motion so far closes, back among the others without a force;
// false if there are none.
bool World::State::take_back_closed() {
  const std::size_t before = contacts.size();
  std::erase_if(put_off, [&](const Contact& c) {
    if (c.gap + normal_motion(c) >= 0) return false;
    contacts.push_back(c);
    return true;
  });
  if (contacts.size() == before) return false;
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
  return true;
}

}  // namespace souple
