// SPDX-License-Identifier: MIT
#include "runtime/compliance/contact_blocks.hpp"

#include <algorithm>

namespace souple {
namespace {

// New nodes that are evaluated at once: enough that a representation can work by small matrix products.
constexpr std::size_t chunk_nodes = 128;

}  // namespace

void ContactBlocks::clear() {
  given_rows_.clear();
  slots_.clear();
  rows_.clear();
  keys_.clear();
}

void ContactBlocks::update(const RestCompliance& rest, std::span<const Index> rows) {
  if (std::ranges::equal(rows, given_rows_)) return;
  std::swap(keys_, earlier_keys_);
  order_rows(rest, rows);
  if (rest.gathers_at_once()) {
    reserve(rows.size(), false);
    return rest.gather_lower(rows_, values_.data(), stride(), work_);
  }
  const std::size_t earlier_stride = stride();
  std::swap(values_, earlier_);
  reserve(rows.size(), true);
  find_kept();
  copy_kept(earlier_stride);
  evaluate_new(rest);
}

void ContactBlocks::order_rows(const RestCompliance& rest, std::span<const Index> rows) {
  given_rows_.assign(rows.begin(), rows.end());
  keys_.clear();
  for (std::size_t k = 0; k < rows.size(); ++k) keys_.push_back({rest.order_of(rows[k]), Index(k)});
  std::ranges::sort(keys_);
  rows_.resize(rows.size());
  slots_.resize(rows.size());
  for (std::size_t slot = 0; slot < rows.size(); ++slot) {
    rows_[slot] = rows[std::size_t(keys_[slot].given)];
    slots_[std::size_t(keys_[slot].given)] = Index(slot);
  }
}

// More room than before. What is held stays as it is, with its own stride.
void ContactBlocks::reserve(std::size_t count, bool both) {
  if (count > capacity_) {
    capacity_ = std::max(count, capacity_ + capacity_ / 2);
    for (auto* list : {&given_rows_, &slots_, &rows_, &mixed_slots_, &mixed_rows_})
      list->reserve(capacity_);
    for (auto* list : {&keys_, &earlier_keys_}) list->reserve(capacity_);
    runs_.reserve(capacity_);
  }
  const std::size_t size = std::max(values_.size(), stride() * stride());
  values_.resize(size);
  if (!both) return;
  earlier_.resize(size);
  evaluated_.resize(3 * chunk_nodes * stride());
}

void ContactBlocks::find_kept() {
  runs_.clear();
  mixed_slots_.clear();
  kept_count_ = 0;
  for (std::size_t to = 0, from = 0; to < keys_.size(); ++to) {
    while (from < earlier_keys_.size() && earlier_keys_[from].order < keys_[to].order) ++from;
    if (from == earlier_keys_.size() || earlier_keys_[from].order != keys_[to].order) continue;
    mixed_slots_.push_back(Index(to));
    const bool goes_on = !runs_.empty() && runs_.back().to + runs_.back().count == to &&
                         runs_.back().from + runs_.back().count == from;
    if (!goes_on) runs_.push_back({to, from, 0});
    ++runs_.back().count;
  }
  kept_count_ = mixed_slots_.size();
  for (std::size_t slot = 0, k = 0; slot < keys_.size(); ++slot)
    if (k < kept_count_ && std::size_t(mixed_slots_[k]) == slot)
      ++k;
    else
      mixed_slots_.push_back(Index(slot));
  mixed_rows_.clear();
  for (const Index slot : mixed_slots_) mixed_rows_.push_back(rows_[std::size_t(slot)]);
}

void ContactBlocks::copy_kept(std::size_t earlier_stride) {
  for (const Run& rows : runs_)
    for (std::size_t k = 0; k < 3 * rows.count; ++k) {
      const float* from = earlier_.data() + (3 * rows.from + k) * earlier_stride;
      float* to = values_.data() + (3 * rows.to + k) * stride();
      const std::size_t slot = rows.to + k / 3;
      for (const Run& columns : runs_) {
        if (columns.to > slot) break;
        std::copy_n(from + 3 * columns.from, 3 * std::min(columns.count, slot + 1 - columns.to),
                    to + 3 * columns.to);
      }
    }
}

// Against what was kept and what has come before.
void ContactBlocks::evaluate_new(const RestCompliance& rest) {
  const std::span<const Index> all(mixed_rows_);
  for (std::size_t first = kept_count_, last; first < all.size(); first = last) {
    last = std::min(first + chunk_nodes, all.size());
    rest.gather_block(all.subspan(first, last - first), all.first(last), evaluated_.data(), 3 * last,
                      work_);
    store_evaluated(first, last);
  }
}

void ContactBlocks::store_evaluated(std::size_t first, std::size_t last) {
  for (std::size_t a = first; a < last; ++a)
    for (std::size_t b = 0; b < last; ++b) {
      const auto row = 3 * std::size_t(mixed_slots_[a]), column = 3 * std::size_t(mixed_slots_[b]);
      const float* from = evaluated_.data() + 3 * (a - first) * 3 * last + 3 * b;
      for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 3; ++j)
          values_[column <= row ? (row + i) * stride() + column + j
                                : (column + j) * stride() + row + i] = from[i * 3 * last + j];
    }
}

std::size_t ContactBlocks::bytes() const {
  return (values_.capacity() + earlier_.capacity() + evaluated_.capacity() + work_.a.capacity() +
          work_.b.capacity() + work_.c.capacity() + work_.coarse_block.capacity() +
          work_.half_block.capacity()) *
         sizeof(float);
}

}  // namespace souple
