// SPDX-License-Identifier: MIT
// What holds between two bodies instead of what the world says. Internal to the world.
#pragma once
#include <cstdint>
#include <vector>

#include "runtime/world/settings.hpp"

namespace souple {

class PairRules {
 public:
  void set(std::uint32_t a, std::uint32_t b, const PairRule& rule);
  /// `otherwise` if nothing was set for the two, in whatever order.
  PairRule of(std::uint32_t a, std::uint32_t b, const PairRule& otherwise) const;

 private:
  struct Entry {
    std::uint64_t key;
    PairRule rule;
  };
  std::vector<Entry> entries_;  ///< ascending by key
};

}  // namespace souple
