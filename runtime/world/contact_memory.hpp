// SPDX-License-Identifier: MIT
#pragma once
#include <algorithm>
#include <array>
#include <vector>

#include "runtime/contact/contact.hpp"

namespace souple {

/// What a step leaves of a contact to the next one; forces on body A in world coordinates, N.
struct ContactMemory {
  ContactKey key;
  Vec3 force = Vec3::Zero();
  Vec3 change = Vec3::Zero();  ///< of the force in the step
  /// What of the force is not part of an impact: what the free motion of the next step may count on.
  Vec3 lasting = Vec3::Zero();
  std::array<Vec3, 3> course{};  ///< forces of the last steps, the latest first
};

/// Of all contacts of a step, ascending by key.
class ContactMemories {
 public:
  const ContactMemory* find(const ContactKey& key) const {
    const auto found = std::ranges::lower_bound(entries_, key, {}, &ContactMemory::key);
    return found == entries_.end() || found->key != key ? nullptr : &*found;
  }
  std::vector<ContactMemory>& entries() { return entries_; }
  const std::vector<ContactMemory>& entries() const { return entries_; }

 private:
  std::vector<ContactMemory> entries_;
};

}  // namespace souple
