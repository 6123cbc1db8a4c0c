// SPDX-License-Identifier: MIT
#include "runtime/fem/block_matrix.hpp"

#include <algorithm>

namespace souple {

Index BlockPattern::find(Index row, Index col) const {
  const auto first = column.begin() + row_begin[row];
  const auto last = column.begin() + row_begin[row + 1];
  return static_cast<Index>(std::lower_bound(first, last, col) - column.begin());
}

BlockPattern build_block_pattern(Index node_count, const std::vector<Tet>& tets) {
  std::vector<std::vector<Index>> neighbours(node_count);
  for (Index node = 0; node < node_count; ++node) neighbours[node].push_back(node);
  for (const auto& tet : tets)
    for (const Index i : tet)
      for (const Index j : tet)
        if (i != j) neighbours[i].push_back(j);
  BlockPattern pattern;
  pattern.row_begin.push_back(0);
  for (Index node = 0; node < node_count; ++node) {
    auto& row = neighbours[node];
    std::ranges::sort(row);
    row.erase(std::unique(row.begin(), row.end()), row.end());
    const auto diagonal = std::ranges::lower_bound(row, node) - row.begin();
    pattern.diagonal.push_back(static_cast<Index>(pattern.column.size() + diagonal));
    pattern.column.insert(pattern.column.end(), row.begin(), row.end());
    pattern.row_begin.push_back(static_cast<Index>(pattern.column.size()));
  }
  return pattern;
}

void multiply(const BlockMatrix& a, const Eigen::VectorXd& x, Eigen::VectorXd& y) {
  const BlockPattern& pattern = *a.pattern;
  for (Index row = 0; row < pattern.node_count(); ++row) {
    Vec3 sum = Vec3::Zero();
    for (Index b = pattern.row_begin[row]; b < pattern.row_begin[row + 1]; ++b)
      sum.noalias() += a.block(b) * node_entry(x, pattern.column[b]);
    node_entry(y, row) = sum;
  }
}

}  // namespace souple
