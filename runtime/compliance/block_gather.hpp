// SPDX-License-Identifier: MIT
#pragma once
#include <span>

#include "runtime/compliance/rest_compliance.hpp"
#include "runtime/compliance/sorted_rows.hpp"

namespace souple {

/// One evaluation of C(rows, columns): goes down the tree with the rows and columns of each cluster and
/// multiplies, where they part, the factors of both sides tile by tile.
class BlockGather {
 public:
  BlockGather(const DecodedRecords& records, ComplianceWork& work, float* out, std::size_t stride)
      : records_(records), work_(work), out_(out), stride_(stride) {}

  void run(std::span<const Index> rows, std::span<const Index> columns);

 private:
  using Rows = std::span<const SortedRow>;

  void descend(int depth, Index cluster, Rows rows, Rows columns);
  void copy_leaf(Index leaf, Rows rows, Rows columns);
  void multiply(int depth, Rows rows, Rows columns);
  template <std::size_t width>
  void pack_node(int depth, Index position, float* const (&to)[3]) const;
  template <std::size_t width>
  std::size_t pack(int depth, Rows nodes, std::vector<float>& panels,
                   std::vector<std::size_t>& panel_begin) const;
  void store_tile(const float* tile, Rows rows, std::size_t first_row, Rows columns,
                  std::size_t first_column) const;

  const DecodedRecords& records_;
  ComplianceWork& work_;
  float* out_;
  std::size_t stride_;
};

}  // namespace souple
