// SPDX-License-Identifier: MIT
#pragma once
#include <algorithm>
#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "runtime/compliance/block_source.hpp"
#include "runtime/compliance/record_model.hpp"
#include "runtime/fem/linear_algebra.hpp"

namespace souple {

/// The records of a hierarchical compliance, decoded once, record by record; a decoded record never
/// changes. Diagonal blocks are kept in single precision, S and the steps multiplied in; the factors as
/// the integers that they are stored as, about 1.8 bytes each: block (I, J) = F_I F_J^T, where three
/// rows of F are L_a times three of the integers, and every column of F is unit_of(term) times that.
class DecodedRecords {
 public:
  /// `index` is sound (fault_of). Nothing is decoded yet; memory is reserved, but not touched.
  DecodedRecords(Index node_count, HierarchicalIndex index, double shift,
                 std::unique_ptr<BlockSource> source);

  Index node_count() const { return node_count_; }
  int depth() const { return depth_; }
  Index leaf_count() const { return Index{1} << depth_; }
  Index leaf_of(Index position) const { return leaf_of_position_[std::size_t(position)]; }
  Index position_of(Index row) const { return position_of_row_[std::size_t(row)]; }
  Index row_at(Index position) const { return index_.order[std::size_t(position)]; }
  ClusterRange range_of(Index leaf) const { return cluster_range(node_count_, depth_, leaf); }

  /// Whether the leaf is decoded, or can be now: then it is. Else its record is asked for. False for
  /// good where the record is corrupt. Several threads may call it; two at once decode one by one.
  bool make_ready(Index leaf) const;
  /// The same without asking: true where the record is not there yet.
  bool make_if_there(Index leaf) const {
    return !source_->ready(std::size_t(leaf)) || make_ready(leaf);
  }
  bool is_ready(Index leaf) const {
    return state_[std::size_t(leaf)].load(std::memory_order_acquire) == State::decoded;
  }

  /// Of a decoded leaf: 3 m rows, padded with zeros to `padded_rows`.
  std::size_t padded_rows(Index leaf) const;
  /// Its own block, m/N, shift included: 3m x 3m, rows `padded_rows` apart.
  const float* diagonal(Index leaf) const { return diagonals_.get() + begin_[std::size_t(leaf)]; }
  /// Calls visit(first, integers, count) for runs of terms of one type, in order: terms [first, first +
  /// count) of the block at depth `d` on the path of the leaf, with its rows of them, `padded_rows`
  /// apart, as std::int8_t, std::int16_t or std::int32_t. term_count terms in all.
  template <class Visit>
  void for_factor(Index leaf, int d, Visit&& visit) const;
  /// L_a of the node at a position: (00, 10, 11, 20, 21, 22).
  const std::array<float, 6>& scale_at(Index position) const {
    return index_.scale[std::size_t(row_at(position))];
  }
  float unit_of(std::size_t term) const { return units_[term]; }
  /// Block at depth `d` on the path of the leaf.
  std::size_t block_above(Index leaf, int d) const {
    return std::size_t(block_of_cluster(d, leaf >> (depth_ - d)));
  }
  /// Terms of that block, up to the last that is not zero on this leaf.
  std::size_t term_count(Index leaf, int d) const {
    return active_[std::size_t(leaf) * std::size_t(depth_) + std::size_t(d)];
  }
  Index rank(std::size_t block) const { return index_.rank[block]; }
  std::size_t first_term(std::size_t block) const { return first_term_[block]; }
  std::size_t term_total() const { return index_.singular.size(); }
  std::size_t resident_bytes() const;

 private:
  /// Terms of a block that are stored by as many bytes, up to `last`.
  struct Run {
    std::size_t last = 0;
    std::size_t bytes = 0;  ///< of an integer: 1, 2 or 4
  };
  enum class State : std::uint8_t { absent, decoded, corrupt };

  bool decode(Index leaf) const;
  bool read_integers(const RecordShape& shape, std::span<const std::byte> record) const;
  void store_diagonal(const RecordShape& shape) const;
  void store_factors(const RecordShape& shape) const;
  void find_runs();
  Mat3 scale_matrix(Index position) const;
  std::span<const Run> runs_of(std::size_t block) const {
    return std::span(runs_).subspan(first_run_[block], first_run_[block + 1] - first_run_[block]);
  }
  std::byte* factor(Index leaf, int d) const {
    return factors_.get() + factor_begin_[std::size_t(leaf) * std::size_t(depth_) + std::size_t(d)];
  }

  Index node_count_;
  int depth_;
  float shift_;
  HierarchicalIndex index_;
  std::unique_ptr<BlockSource> source_;
  std::vector<RecordShape> shapes_;
  std::vector<Index> position_of_row_, leaf_of_position_;
  std::vector<std::size_t> begin_;         ///< [leaves + 1] in diagonals_
  std::vector<std::size_t> factor_begin_;  ///< [leaves depth + 1] in factors_
  std::vector<Run> runs_;
  std::vector<std::size_t> first_run_;    ///< [blocks + 1]
  std::vector<float> units_;              ///< [terms] step / root of the singular value
  std::vector<std::size_t> first_term_;   ///< [blocks]
  std::unique_ptr<float[]> diagonals_;    ///< written once a leaf, by make_ready
  std::unique_ptr<std::byte[]> factors_;  ///< the same
  mutable std::vector<std::uint32_t> active_;
  mutable std::vector<std::atomic<State>> state_;
  // Scratch memory of the one who decodes.
  mutable std::atomic_flag decoding_;
  mutable LeafIntegers integers_;
  mutable std::vector<std::uint32_t> scratch_;
};

template <class Visit>
void DecodedRecords::for_factor(Index leaf, int d, Visit&& visit) const {
  const std::size_t rows = padded_rows(leaf), count = term_count(leaf, d);
  const std::byte* integers = factor(leaf, d);
  std::size_t first = 0;
  for (const Run& run : runs_of(block_above(leaf, d))) {
    const std::size_t last = std::min(run.last, count);
    if (first >= last) return;
    if (run.bytes == 1)
      visit(first, reinterpret_cast<const std::int8_t*>(integers), last - first);
    else if (run.bytes == 2)
      visit(first, reinterpret_cast<const std::int16_t*>(integers), last - first);
    else
      visit(first, reinterpret_cast<const std::int32_t*>(integers), last - first);
    integers += (last - first) * rows * run.bytes;
    first = last;
  }
}

}  // namespace souple
