// SPDX-License-Identifier: MIT
#pragma once
#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "runtime/compliance/decoded_records.hpp"

namespace souple {

/// Rows of a call in cluster order: the position in the upper half, the place in the call in the lower.
using SortedRow = std::uint64_t;
inline Index position_of(SortedRow row) { return static_cast<Index>(row >> 32); }
inline std::size_t place_of(SortedRow row) { return static_cast<std::size_t>(row & 0xFFFFFFFFU); }

inline std::span<const SortedRow> sort_rows(const DecodedRecords& records, std::span<const Index> rows,
                                            std::vector<SortedRow>& sorted) {
  sorted.resize(rows.size());
  for (std::size_t k = 0; k < rows.size(); ++k)
    sorted[k] = (SortedRow(records.position_of(rows[k])) << 32) | k;
  std::ranges::sort(sorted);
  return sorted;
}

/// Splits rows of one cluster at the first position of its right child.
struct SplitRows {
  std::span<const SortedRow> left, right;
};
inline SplitRows split_rows(std::span<const SortedRow> rows, Index middle) {
  const auto at = std::ranges::lower_bound(rows, SortedRow(middle) << 32);
  const auto count = std::size_t(at - rows.begin());
  return {rows.first(count), rows.subspan(count)};
}

}  // namespace souple
