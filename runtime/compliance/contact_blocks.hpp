// SPDX-License-Identifier: MIT
#pragma once
#include <cstddef>
#include <span>
#include <vector>

#include "runtime/compliance/rest_compliance.hpp"

namespace souple {

/// C0 between the nodes of one body that are in contact, in the rest frame, kept from step to step:
/// only the rows of nodes that come are evaluated. The values are those of a fresh evaluation to the
/// bit. Allocates only to hold more nodes than ever before.
class ContactBlocks {
 public:
  /// Makes the blocks between `rows` (of `rest`, ascending, each once) current.
  void update(const RestCompliance& rest, std::span<const Index> rows);
  /// Forgets all values, as after a change of the compliance.
  void clear();

  /// Slot of the k-th row of the last update. Slots are 0 ... count() - 1.
  std::span<const Index> slots() const { return slots_; }
  std::size_t count() const { return rows_.size(); }
  /// Block of slots (s, t): row-major at values() + 3 s stride() + 3 t, m/N. Both triangles are there.
  const float* values() const { return values_.data(); }
  std::size_t stride() const { return 3 * capacity_; }
  std::size_t bytes() const;

 private:
  void reserve(std::size_t count);
  std::size_t keep(std::span<const Index> rows);
  void close_gaps(std::size_t kept);
  void store_transposes(std::size_t first, std::size_t last);

  struct Move {
    Index from = 0, to = 0;  ///< slots
  };

  std::size_t capacity_ = 0;   ///< nodes
  std::vector<float> values_;  ///< (3 capacity) squared, and room for a tile past the end
  std::vector<Index> rows_, slots_;
  std::vector<Index> row_at_;  ///< row at every slot
  std::vector<Index> earlier_rows_, earlier_slots_;
  std::vector<char> is_taken_;  ///< by slot
  std::vector<Move> moves_;
  std::vector<float> transposed_;
  ComplianceWork work_;
};

}  // namespace souple
