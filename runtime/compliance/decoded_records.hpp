// SPDX-License-Identifier: MIT
#pragma once
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

/// The records of a hierarchical compliance in single precision, S and the steps multiplied in: block
/// (I, J) = F_I F_J^T, decoded once, record by record. A decoded record never changes.
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
  const float* diagonal(Index leaf) const { return values_.get() + begin_[std::size_t(leaf)]; }
  /// Its rows of the block at depth `d` on its path: term after term, `padded_rows` apart.
  const float* factor(Index leaf, int d) const;
  /// Terms of that block, up to the last that is not zero on this leaf.
  std::size_t term_count(Index leaf, int d) const {
    return active_[std::size_t(leaf) * std::size_t(depth_) + std::size_t(d)];
  }
  Index rank(std::size_t block) const { return index_.rank[block]; }
  std::size_t first_term(std::size_t block) const { return first_term_[block]; }
  std::size_t term_total() const { return index_.singular.size(); }
  std::size_t resident_bytes() const;

 private:
  enum class State : std::uint8_t { absent, decoded, corrupt };

  bool decode(Index leaf) const;
  bool read_integers(const RecordShape& shape, std::span<const std::byte> record) const;
  void store_diagonal(const RecordShape& shape) const;
  void store_factors(const RecordShape& shape) const;
  Mat3 scale_at(Index position) const;

  Index node_count_;
  int depth_;
  float shift_;
  HierarchicalIndex index_;
  std::unique_ptr<BlockSource> source_;
  std::vector<RecordShape> shapes_;
  std::vector<Index> position_of_row_, leaf_of_position_;
  std::vector<std::size_t> begin_;       ///< [leaves + 1] in values_
  std::vector<std::size_t> first_term_;  ///< [blocks]
  std::unique_ptr<float[]> values_;      ///< written once a leaf, by make_ready
  mutable std::vector<std::uint32_t> active_;
  mutable std::vector<std::atomic<State>> state_;
  // Scratch memory of the one who decodes.
  mutable std::atomic_flag decoding_;
  mutable LeafIntegers integers_;
  mutable std::vector<std::uint32_t> scratch_;
};

}  // namespace souple
