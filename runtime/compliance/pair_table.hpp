// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

#include "runtime/compliance/sorted_rows.hpp"

namespace souple {

/// A 3x3 block rounded to nine integers of one common step: every entry is within 2^-15 of the largest
/// one of the block. The step is kept as a bfloat16.
struct StoredPair {
  std::array<std::int16_t, 9>
      mantissa{};          ///< rows 0 and 1 with an entry of row 2 behind each; row 2's last
  std::uint16_t step = 0;  ///< upper half of a float
};
static_assert(sizeof(StoredPair) == 20);

/// `block`: three rows of three, `stride` apart, finite. Blocks below 1e-30 become zero.
StoredPair stored_pair(const float* block, std::size_t stride);

/// The blocks of a hierarchical compliance between all pairs of nodes, evaluated once: reading a pair
/// takes a nanosecond or two where its factors take a hundred. One half by symmetry, in cluster order,
/// so that the nodes of a contact stand in a few runs of every row. 10 n^2 bytes.
class PairTable {
 public:
  static std::size_t bytes_for(Index node_count) {
    return std::size_t(node_count) * (std::size_t(node_count) + 1) / 2 * sizeof(StoredPair);
  }
  /// All records are decoded. nullptr if there is no memory.
  static std::unique_ptr<const PairTable> create(const DecodedRecords& records);

  /// Lower block triangle of C between `rows`, which ascend, place k being the k-th.
  void read_lower(std::span<const SortedRow> rows, float* out, std::size_t stride) const;
  /// C(rows, columns) at their places.
  void read_block(std::span<const SortedRow> rows, std::span<const SortedRow> columns, float* out,
                  std::size_t stride) const;
  std::size_t bytes() const { return bytes_for(node_count_); }

 private:
  explicit PairTable(Index node_count);
  /// Pairs of the node at `position` with those up to itself.
  const StoredPair* row_of(std::size_t position) const {
    return pairs_.get() + position * (position + 1) / 2;
  }

  Index node_count_;
  std::unique_ptr<StoredPair[]> pairs_;
};

}  // namespace souple
