// SPDX-License-Identifier: MIT
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "runtime/contact/contact.hpp"

namespace souple {

/// Bodies that contacts and joints connect, through bodies that can be moved by forces. Keeps its
/// memory from step to step.
class Islands {
 public:
  /// `is_movable(body)`: whether contact forces move it.
  template <class IsMovable>
  void build(const std::vector<Contact>& contacts, std::size_t body_count, IsMovable&& is_movable) {
    begin(body_count);
    for (const Contact& c : contacts)
      if (can_connect(c, is_movable)) connect(c.a.body, c.b.body);
    for (const Contact& c : contacts)
      owner_.push_back(c.a.body != ContactSide::no_body && is_movable(c.a.body) ? c.a.body : c.b.body);
    group();
  }

  std::size_t count() const { return first_.empty() ? 0 : first_.size() - 1; }
  /// Numbers of its contacts, ascending.
  std::span<const std::uint32_t> contacts(std::size_t island) const {
    return std::span(order_).subspan(first_[island], first_[island + 1] - first_[island]);
  }
  /// Where its contacts begin among all, sorted by island.
  std::size_t first_contact(std::size_t island) const { return first_[island]; }
  /// One body stands for all that are connected.
  std::uint32_t root(std::uint32_t body);

 private:
  template <class IsMovable>
  static bool can_connect(const Contact& c, IsMovable&& is_movable) {
    return c.a.body != ContactSide::no_body && c.b.body != ContactSide::no_body &&
           is_movable(c.a.body) && is_movable(c.b.body);
  }
  void begin(std::size_t body_count);
  void connect(std::uint32_t a, std::uint32_t b);
  void group();

  std::vector<std::uint32_t> parent_;  ///< by body
  std::vector<std::uint32_t> owner_;   ///< by contact: a body of its island
  std::vector<std::uint32_t> order_;   ///< contacts by island
  std::vector<std::size_t> first_;
};

}  // namespace souple
