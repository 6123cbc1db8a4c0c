// SPDX-License-Identifier: MIT
#include "runtime/compliance/block_gather.hpp"

#include <algorithm>

#include "runtime/compliance/product_kernel.hpp"

namespace souple {

void BlockGather::run(std::span<const Index> rows, std::span<const Index> columns) {
  descend(0, 0, sort_rows(records_, rows, work_.sorted_rows),
          sort_rows(records_, columns, work_.sorted_columns));
}

void BlockGather::descend(int depth, Index cluster, Rows rows, Rows columns) {
  if (rows.empty() || columns.empty()) return;
  if (depth == records_.depth()) return copy_leaf(cluster, rows, columns);
  const Index middle = cluster_range(records_.node_count(), depth + 1, 2 * cluster).end;
  const auto [upper, lower] = split_rows(rows, middle);
  const auto [left, right] = split_rows(columns, middle);
  multiply(depth, upper, right);
  multiply(depth, lower, left);
  descend(depth + 1, 2 * cluster, upper, left);
  descend(depth + 1, 2 * cluster + 1, lower, right);
}

void BlockGather::copy_leaf(Index leaf, Rows rows, Rows columns) {
  const float* diagonal = records_.diagonal(leaf);
  const std::size_t from_stride = records_.padded_rows(leaf);
  const Index first = records_.range_of(leaf).begin;
  for (const SortedRow row : rows)
    for (const SortedRow column : columns) {
      const float* from = diagonal + 3 * std::size_t(position_of(row) - first) * from_stride +
                          3 * std::size_t(position_of(column) - first);
      float* to = out_ + 3 * place_of(row) * stride_ + 3 * place_of(column);
      for (std::size_t i = 0; i < 3; ++i) std::copy_n(from + i * from_stride, 3, to + i * stride_);
    }
}

// Three rows of F, entries `width` apart.
template <std::size_t width>
void BlockGather::pack_node(int depth, Index position, float* const (&to)[3]) const {
  const Index leaf = records_.leaf_of(position);
  const std::size_t stride = records_.padded_rows(leaf);
  const auto row = 3 * std::size_t(position - records_.range_of(leaf).begin);
  const std::size_t first_term = records_.first_term(records_.block_above(leaf, depth));
  const auto& [l00, l10, l11, l20, l21, l22] = records_.scale_at(position);
  records_.for_factor(leaf, depth, [&](std::size_t first, const auto* integers, std::size_t count) {
    for (std::size_t k = first; k < first + count; ++k, integers += stride) {
      const float unit = records_.unit_of(first_term + k);
      const auto x = float(integers[row]), y = float(integers[row + 1]), z = float(integers[row + 2]);
      to[0][k * width] = unit * (l00 * x);
      to[1][k * width] = unit * (l10 * x + l11 * y);
      to[2][k * width] = unit * (l20 * x + l21 * y + l22 * z);
    }
  });
}

// Panels of `width` scalar rows, term after term; each has the terms that any of its nodes needs, where
// others have zeros. `panel_begin` [panels + 1]: terms so far.
template <std::size_t width>
std::size_t BlockGather::pack(int depth, Rows nodes, std::vector<float>& panels,
                              std::vector<std::size_t>& panel_begin) const {
  const std::size_t count = (3 * nodes.size() + width - 1) / width;
  panel_begin.assign(1, 0);
  for (std::size_t p = 0; p < count; ++p) {
    const std::size_t last = std::min((width * (p + 1) - 1) / 3, nodes.size() - 1);
    std::size_t terms = 0;
    for (std::size_t node = width * p / 3; node <= last; ++node)
      terms = std::max(terms, records_.term_count(records_.leaf_of(position_of(nodes[node])), depth));
    panel_begin.push_back(panel_begin.back() + terms);
  }
  panels.assign(panel_begin.back() * width, 0.0F);
  for (std::size_t node = 0; node < nodes.size(); ++node) {
    float* to[3];
    for (std::size_t i = 0; i < 3; ++i)
      to[i] = panels.data() + panel_begin[(3 * node + i) / width] * width + (3 * node + i) % width;
    pack_node<width>(depth, position_of(nodes[node]), to);
  }
  return count;
}

void BlockGather::multiply(int depth, Rows rows, Rows columns) {
  if (rows.empty() || columns.empty()) return;
  auto& row_begin = work_.row_panels;
  auto& column_begin = work_.column_panels;
  const std::size_t row_panels = pack<tile_rows>(depth, rows, work_.a, row_begin);
  const std::size_t column_panels = pack<tile_columns>(depth, columns, work_.b, column_begin);
  alignas(32) float tile[tile_rows * tile_columns];
  for (std::size_t q = 0; q < column_panels; ++q)
    for (std::size_t p = 0; p < row_panels; ++p) {
      const std::size_t terms =
          std::min(row_begin[p + 1] - row_begin[p], column_begin[q + 1] - column_begin[q]);
      multiply_tile(work_.a.data() + row_begin[p] * tile_rows,
                    work_.b.data() + column_begin[q] * tile_columns, terms, tile);
      store_tile(tile, rows, tile_rows * p, columns, tile_columns * q);
    }
}

void BlockGather::store_tile(const float* tile, Rows rows, std::size_t first_row, Rows columns,
                             std::size_t first_column) const {
  const std::size_t height = std::min(tile_rows, 3 * rows.size() - first_row);
  const std::size_t width = std::min(tile_columns, 3 * columns.size() - first_column);
  std::size_t target[tile_columns];
  for (std::size_t j = 0; j < width; ++j)
    target[j] = 3 * place_of(columns[(first_column + j) / 3]) + (first_column + j) % 3;
  const bool in_order =
      target[width - 1] - target[0] == width - 1 && std::is_sorted(target, target + width);
  for (std::size_t i = 0; i < height; ++i, tile += tile_columns) {
    float* to = out_ + (3 * place_of(rows[(first_row + i) / 3]) + (first_row + i) % 3) * stride_;
    if (in_order)
      std::copy_n(tile, width, to + target[0]);
    else
      for (std::size_t j = 0; j < width; ++j) to[target[j]] = tile[j];
  }
}

}  // namespace souple
