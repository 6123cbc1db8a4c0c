// SPDX-License-Identifier: MIT
#include "runtime/world/contact_events.hpp"

#include <algorithm>

namespace souple {
namespace {

std::pair<std::uint32_t, std::uint32_t> bodies_of(const ContactEvent& event) {
  return {event.body_a.index, event.body_b.index};
}

}  // namespace

// One entry per pair that carries force, ascending by bodies.
void ContactEvents::collect(const std::vector<Contact>& contacts, const std::vector<double>& forces) {
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    const Contact& c = contacts[i];
    if (c.law.kind != ConstraintLaw::Kind::frictional || !(forces[3 * i] > 0)) continue;
    Vec3 force = c.frame * Eigen::Map<const Vec3>(forces.data() + 3 * i);
    std::uint32_t a = c.key.body_a, b = c.key.body_b;
    if (a > b) {
      std::swap(a, b);
      force = -force;
    }
    now_.push_back({ContactEventKind::begin, {a}, {b}, as_point(force), 1});
  }
  std::ranges::sort(now_, {}, bodies_of);
  std::size_t kept = 0;
  for (std::size_t i = 0; i < now_.size(); ++i) {
    if (kept > 0 && bodies_of(now_[kept - 1]) == bodies_of(now_[i])) {
      as_vec3(now_[kept - 1].force_n) += as_vec3(now_[i].force_n);
      now_[kept - 1].contact_count += now_[i].contact_count;
    } else {
      now_[kept++] = now_[i];
    }
  }
  now_.resize(kept);
}

// Those that were there before persist; those that were and are not any more end.
void ContactEvents::compare() {
  const std::size_t touching = now_.size();
  std::size_t at = 0;
  for (const ContactEvent& before : last_) {
    if (before.kind == ContactEventKind::end) continue;
    while (at < touching && bodies_of(now_[at]) < bodies_of(before)) ++at;
    if (at < touching && bodies_of(now_[at]) == bodies_of(before))
      now_[at].kind = ContactEventKind::persist;
    else
      now_.push_back({ContactEventKind::end, before.body_a, before.body_b, {}, 0});
  }
  std::ranges::sort(now_, {}, bodies_of);
}

}  // namespace souple
