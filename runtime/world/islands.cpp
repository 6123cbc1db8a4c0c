// SPDX-License-Identifier: MIT
#include "runtime/world/islands.hpp"

#include <algorithm>
#include <numeric>

namespace souple {

void Islands::begin(std::size_t body_count) {
  parent_.resize(body_count);
  std::iota(parent_.begin(), parent_.end(), 0u);
  owner_.clear();
}

std::uint32_t Islands::root(std::uint32_t body) {
  while (parent_[body] != body) {
    parent_[body] = parent_[parent_[body]];
    body = parent_[body];
  }
  return body;
}

// The smaller number stands for both, so that the islands' order is that of their first bodies.
void Islands::connect(std::uint32_t a, std::uint32_t b) {
  a = root(a);
  b = root(b);
  parent_[std::max(a, b)] = std::min(a, b);
}

void Islands::group() {
  for (std::uint32_t& owner : owner_) owner = root(owner);
  order_.resize(owner_.size());
  std::iota(order_.begin(), order_.end(), 0u);
  std::ranges::sort(order_, [&](std::uint32_t a, std::uint32_t b) {
    return owner_[a] != owner_[b] ? owner_[a] < owner_[b] : a < b;
  });
  first_.clear();
  for (std::size_t k = 0; k < order_.size(); ++k)
    if (k == 0 || owner_[order_[k]] != owner_[order_[k - 1]]) first_.push_back(k);
  first_.push_back(order_.size());
}

}  // namespace souple
