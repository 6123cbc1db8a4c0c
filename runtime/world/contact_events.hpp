// SPDX-License-Identifier: MIT
#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

#include "runtime/contact/contact.hpp"
#include "runtime/world/constraints.hpp"

namespace souple {

enum class ContactEventKind : std::uint8_t { begin, persist, end };

/// Two bodies that press on each other; joints and grabs are none.
struct ContactEvent {
  ContactEventKind kind = ContactEventKind::begin;
  BodyId body_a, body_b;  ///< a <= b
  Point force_n{};        ///< on body A, of all their contacts; 0 at the end
  std::uint32_t contact_count = 0;
};

/// Turns the contacts of each step into events. Allocates nothing once it has grown.
class ContactEvents {
 public:
  /// `forces`: 3 per contact, in its frame. Of pairs of `sleeping` bodies what was last known persists.
  template <class IsSleeping>
  void update(const std::vector<Contact>& contacts, const std::vector<double>& forces,
              IsSleeping&& is_sleeping) {
    std::swap(last_, now_);
    now_.clear();
    for (const ContactEvent& event : last_)
      if (event.kind != ContactEventKind::end && is_sleeping(event.body_a.index, event.body_b.index))
        now_.push_back(event);
    collect(contacts, forces);
    compare();
  }
  void clear() { now_.clear(); }
  const std::vector<ContactEvent>& events() const { return now_; }

 private:
  void collect(const std::vector<Contact>& contacts, const std::vector<double>& forces);
  void compare();

  std::vector<ContactEvent> last_, now_;  ///< ascending by bodies
};

}  // namespace souple
