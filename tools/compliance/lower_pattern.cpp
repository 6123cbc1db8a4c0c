// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/compliance/lower_pattern.hpp"

#include <cholmod.h>

#include <algorithm>

namespace souple {

LowerPattern lower_pattern(const BlockPattern& pattern, std::span<const Index> nodes,
                           std::int64_t width) {
  std::vector<std::int64_t> local(std::size_t(pattern.node_count()), -1);
  for (std::size_t k = 0; k < nodes.size(); ++k) local[std::size_t(nodes[k])] = std::int64_t(k);
  LowerPattern lower;
  std::vector<std::int64_t> others;
  for (std::size_t k = 0; k < nodes.size(); ++k) {
    others.clear();
    for (Index b = pattern.row_begin[std::size_t(nodes[k])];
         b < pattern.row_begin[std::size_t(nodes[k]) + 1]; ++b)
      if (const auto other = local[std::size_t(pattern.column[std::size_t(b)])];
          other >= std::int64_t(k))
        others.push_back(other);
    std::ranges::sort(others);
    for (auto column = width * std::int64_t(k); column < width * std::int64_t(k + 1); ++column) {
      for (const std::int64_t other : others)
        for (auto row = std::max(column, width * other); row < width * (other + 1); ++row)
          lower.row.push_back(row);
      lower.begin.push_back(std::int64_t(lower.row.size()));
    }
  }
  return lower;
}

cholmod_sparse as_sparse(LowerPattern& pattern) {
  cholmod_sparse sparse{};
  sparse.nrow = sparse.ncol = pattern.begin.size() - 1;
  sparse.nzmax = pattern.row.size();
  sparse.p = pattern.begin.data();
  sparse.i = pattern.row.data();
  sparse.stype = -1;
  sparse.itype = CHOLMOD_LONG;
  sparse.xtype = CHOLMOD_PATTERN;
  sparse.dtype = CHOLMOD_DOUBLE;
  sparse.sorted = 1;
  sparse.packed = 1;
  return sparse;
}

}  // namespace souple
