// SPDX-License-Identifier: MIT
#include "runtime/compliance/block_scatter.hpp"

#include <algorithm>

#include "runtime/compliance/product_kernel.hpp"

namespace souple {

void BlockScatter::run(std::span<const Index> rows, std::span<const double> force) {
  const Rows sorted = sort_rows(records_, rows, work_.sorted_rows);
  work_.a.assign(2 * records_.term_total(), 0.0F);
  for (std::size_t begin = 0; begin < sorted.size();) {
    const Index leaf = records_.leaf_of(position_of(sorted[begin]));
    std::size_t end = begin;
    while (end < sorted.size() && position_of(sorted[end]) < records_.range_of(leaf).end) ++end;
    if (records_.is_ready(leaf)) project(leaf, sorted.subspan(begin, end - begin), force);
    begin = end;
  }
  scale_sums();
  descend(0, 0, sorted, force);
}

// Sums of the terms of the block at `depth` above `leaf`, from its own side or from the other.
float* BlockScatter::sums(int depth, Index leaf, bool other_side) {
  const Index child = leaf >> (records_.depth() - depth - 1);
  const auto block = std::size_t(block_of_cluster(depth, child / 2));
  const bool right = (child % 2 == 1) != other_side;
  return work_.a.data() + 2 * records_.first_term(block) +
         (right ? std::size_t(records_.rank(block)) : 0);
}

// work_.b: the forces on all rows of the leaf.
void BlockScatter::load_leaf(Index leaf, Rows rows, std::span<const double> force) {
  work_.b.assign(records_.padded_rows(leaf), 0.0F);
  const Index first = records_.range_of(leaf).begin;
  for (const SortedRow row : rows)
    for (std::size_t i = 0; i < 3; ++i)
      work_.b[3 * std::size_t(position_of(row) - first) + i] += float(force[3 * place_of(row) + i]);
}

// L_a^T times the forces on every node a of the leaf.
void BlockScatter::scale_load(Index leaf) {
  const ClusterRange range = records_.range_of(leaf);
  float* f = work_.b.data();
  for (Index position = range.begin; position < range.end; ++position, f += 3) {
    const auto& [l00, l10, l11, l20, l21, l22] = records_.scale_at(position);
    const float x = f[0], y = f[1], z = f[2];
    f[0] = l00 * x + l10 * y + l20 * z;
    f[1] = l11 * y + l21 * z;
    f[2] = l22 * z;
  }
}

// The sums that come out have the square of the units of their terms.
void BlockScatter::project(Index leaf, Rows rows, std::span<const double> force) {
  load_leaf(leaf, rows, force);
  scale_load(leaf);
  for (int d = 0; d < records_.depth(); ++d) {
    float* all = sums(d, leaf, false);
    records_.for_factor(leaf, d, [&](std::size_t first, const auto* integers, std::size_t count) {
      add_projection(integers, records_.padded_rows(leaf), count, work_.b.data(), all + first);
    });
  }
}

void BlockScatter::scale_sums() {
  for (std::size_t block = 0; block + 1 < std::size_t(records_.leaf_count()); ++block) {
    const auto rank = std::size_t(records_.rank(block));
    const std::size_t first = records_.first_term(block);
    float* sum = work_.a.data() + 2 * first;
    for (std::size_t k = 0; k < rank; ++k) {
      const float unit = records_.unit_of(first + k);
      sum[k] *= unit * unit;
      sum[rank + k] *= unit * unit;
    }
  }
}

void BlockScatter::descend(int depth, Index cluster, Rows rows, std::span<const double> force) {
  if (depth == records_.depth()) return combine(cluster, rows, force);
  const Index middle = cluster_range(records_.node_count(), depth + 1, 2 * cluster).end;
  const auto [left, right] = split_rows(rows, middle);
  sibling_loaded_[std::size_t(depth)] = !right.empty();
  descend(depth + 1, 2 * cluster, left, force);
  sibling_loaded_[std::size_t(depth)] = !left.empty();
  descend(depth + 1, 2 * cluster + 1, right, force);
}

// work_.c: the motion of the leaf, before L_a and after.
void BlockScatter::combine_factors(Index leaf) {
  const std::size_t stride = records_.padded_rows(leaf);
  for (int d = 0; d < records_.depth(); ++d) {
    if (!sibling_loaded_[std::size_t(d)]) continue;
    const float* all = sums(d, leaf, true);
    records_.for_factor(leaf, d, [&](std::size_t first, const auto* integers, std::size_t count) {
      add_combination(integers, stride, count, all + first, work_.c.data());
    });
  }
  const ClusterRange range = records_.range_of(leaf);
  float* u = work_.c.data();
  for (Index position = range.begin; position < range.end; ++position, u += 3) {
    const auto& [l00, l10, l11, l20, l21, l22] = records_.scale_at(position);
    const float x = u[0], y = u[1], z = u[2];
    u[0] = l00 * x;
    u[1] = l10 * x + l11 * y;
    u[2] = l20 * x + l21 * y + l22 * z;
  }
}

void BlockScatter::combine(Index leaf, Rows rows, std::span<const double> force) {
  const ClusterRange range = records_.range_of(leaf);
  const std::size_t stride = records_.padded_rows(leaf);
  work_.c.assign(stride, 0.0F);
  if (records_.is_ready(leaf)) {
    combine_factors(leaf);
    if (!rows.empty()) {
      load_leaf(leaf, rows, force);
      add_combination(records_.diagonal(leaf), stride, 3 * std::size_t(range.size()), work_.b.data(),
                      work_.c.data());
    }
  }
  for (Index position = range.begin; position < range.end; ++position)
    for (std::size_t i = 0; i < 3; ++i)
      displacement_[3 * std::size_t(records_.row_at(position)) + i] =
          work_.c[3 * std::size_t(position - range.begin) + i];
}

}  // namespace souple
