// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <span>

#include "runtime/compliance/rest_compliance.hpp"
#include "runtime/compliance/sorted_rows.hpp"

namespace souple {

/// One product C(:, rows) force: the loaded leaves project their forces onto the terms of the blocks on
/// their paths, then every leaf combines the terms of those blocks whose other side is loaded.
class BlockScatter {
 public:
  BlockScatter(const DecodedRecords& records, ComplianceWork& work, std::span<double> displacement)
      : records_(records), work_(work), displacement_(displacement) {}

  void run(std::span<const Index> rows, std::span<const double> force);

 private:
  using Rows = std::span<const SortedRow>;

  void project(Index leaf, Rows rows, std::span<const double> force);
  void scale_load(Index leaf);
  void scale_sums();
  void combine_factors(Index leaf);
  void load_leaf(Index leaf, Rows rows, std::span<const double> force);
  void descend(int depth, Index cluster, Rows rows, std::span<const double> force);
  void combine(Index leaf, Rows rows, std::span<const double> force);
  float* sums(int depth, Index leaf, bool other_side);

  const DecodedRecords& records_;
  ComplianceWork& work_;
  std::span<double> displacement_;
  std::array<bool, 32> sibling_loaded_{};
};

}  // namespace souple
