// SPDX-License-Identifier: MIT
#pragma once
#include <compare>
#include <cstddef>
#include <span>
#include <vector>

#include "runtime/compliance/rest_compliance.hpp"

namespace souple {

/// C0 between the nodes of one body that are in contact, in the rest frame. Where evaluating is dear,
/// blocks are kept from step to step, and only the rows of nodes that come are evaluated; the values
/// are those of a fresh evaluation to the bit. Allocates only to hold more nodes than ever before.
class ContactBlocks {
 public:
  /// Makes the blocks between `rows` (of `rest`, ascending, each once) current.
  void update(const RestCompliance& rest, std::span<const Index> rows);
  /// Forgets all values, as after a change of the compliance.
  void clear();

  /// Slot of the k-th row of the last update: its rank by RestCompliance::order_of.
  std::span<const Index> slots() const { return slots_; }
  std::size_t count() const { return rows_.size(); }
  /// Block of slots (s, t), t <= s: row-major at values() + 3 s stride() + 3 t, m/N.
  const float* values() const { return values_.data(); }
  std::size_t stride() const { return 3 * capacity_; }
  std::size_t bytes() const;

 private:
  /// Slots that hold the same rows as before: [to, to + count) what [from, from + count) did.
  struct Run {
    std::size_t to = 0, from = 0, count = 0;
  };

  /// A row as it was given, by RestCompliance::order_of.
  struct Key {
    Index order = 0, given = 0;
    auto operator<=>(const Key&) const = default;
  };

  void order_rows(const RestCompliance& rest, std::span<const Index> rows);
  void reserve(std::size_t count, bool both);
  void find_kept();
  void copy_kept(std::size_t earlier_stride);
  void evaluate_new(const RestCompliance& rest);
  void store_evaluated(std::size_t first, std::size_t last);

  std::size_t capacity_ = 0;             ///< nodes
  std::vector<float> values_, earlier_;  ///< (3 capacity) squared; the second if blocks are kept
  std::vector<Index> given_rows_, slots_;
  std::vector<Index> rows_;               ///< by slot
  std::vector<Key> keys_, earlier_keys_;  ///< by slot
  // While blocks are kept.
  std::vector<Run> runs_;
  std::size_t kept_count_ = 0;
  std::vector<Index> mixed_slots_, mixed_rows_;  ///< those that were kept, then those that came
  std::vector<float> evaluated_;                 ///< some that came x mixed
  ComplianceWork work_;
};

}  // namespace souple
