// SPDX-License-Identifier: MIT
#include "runtime/world/pair_rules.hpp"

#include <algorithm>

namespace souple {
namespace {

std::uint64_t key_of(std::uint32_t a, std::uint32_t b) {
  return std::uint64_t{std::min(a, b)} << 32 | std::max(a, b);
}

}  // namespace

void PairRules::set(std::uint32_t a, std::uint32_t b, const PairRule& rule) {
  const auto place = std::ranges::lower_bound(entries_, key_of(a, b), {}, &Entry::key);
  if (place != entries_.end() && place->key == key_of(a, b))
    place->rule = rule;
  else
    entries_.insert(place, {key_of(a, b), rule});
}

PairRule PairRules::of(std::uint32_t a, std::uint32_t b, const PairRule& otherwise) const {
  const auto place = std::ranges::lower_bound(entries_, key_of(a, b), {}, &Entry::key);
  return place != entries_.end() && place->key == key_of(a, b) ? place->rule : otherwise;
}

}  // namespace souple
