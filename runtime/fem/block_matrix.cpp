// SPDX-License-Identifier: MIT
#include "runtime/fem/block_matrix.hpp"

#include <algorithm>

#include "runtime/fem/lanes.hpp"

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

namespace {

/// Sum of blocks times nodes, to be reduced at the end. Rows of a block are read four entries at a
/// time: the fourth meets the 0 behind x_j. The last row is read from one entry ahead, so that nothing
/// is read behind the last block, and meets (0, x_j).
struct DoubleSum {
  Lanes row[3] = {};

  SOUPLE_KERNEL void add(const double* block, const double* xj) {
    const Lanes v = load3(xj);
    row[0] = fma(_mm256_loadu_pd(block), v, row[0]);
    row[1] = fma(_mm256_loadu_pd(block + 3), v, row[1]);
    row[2] = fma(_mm256_loadu_pd(block + 5), _mm256_permute4x64_pd(v, 0x93), row[2]);
  }
  SOUPLE_KERNEL void store_with(const DoubleSum& other, double* y) {
    for (int r = 0; r < 3; ++r) row[r] = row[r] + other.row[r];
    Lanes padding = zero_lanes();
    transpose(row[0], row[1], row[2], padding);
    store3(y, (row[0] + row[1]) + (row[2] + padding));
  }
};

/// The same in single precision: eight entries of a block are one vector, which meets
/// (x, y, z, x, y, z, x, y); the ninth meets z.
struct FloatSum {
  __m256 head = _mm256_setzero_ps();
  __m128 last = _mm_setzero_ps();

  SOUPLE_KERNEL void add(const float* block, const float* xj) {
    const __m128 v = _mm_maskload_ps(xj, _mm_set_epi32(0, -1, -1, -1));
    const __m256 repeated =
        _mm256_permutevar8x32_ps(_mm256_castps128_ps256(v), _mm256_set_epi32(1, 0, 2, 1, 0, 2, 1, 0));
    head = _mm256_fmadd_ps(_mm256_loadu_ps(block), repeated, head);
    last = _mm_fmadd_ss(_mm_load_ss(block + 8), _mm_movehl_ps(v, v), last);
  }
  SOUPLE_KERNEL void store_with(const FloatSum& other, float* y) {
    alignas(32) float s[8];
    _mm256_store_ps(s, _mm256_add_ps(head, other.head));
    y[0] = s[0] + s[1] + s[2];
    y[1] = s[3] + s[4] + s[5];
    y[2] = s[6] + s[7] + _mm_cvtss_f32(_mm_add_ss(last, other.last));
  }
};

/// Even and odd blocks apart, for a single chain of additions would be slower than memory.
template <class Sum, class Scalar>
void multiply_range(const BasicBlockMatrix<Scalar>& a, const Scalar* x, IndexRange rows, Scalar* y) {
  const BlockPattern& pattern = *a.pattern;
  for (Index row = rows.begin; row < rows.end; ++row) {
    Sum even, odd;
    const Index end = pattern.row_begin[row + 1];
    Index b = pattern.row_begin[row];
    const Scalar* block = a.values.data() + 9 * std::size_t(b);
    for (; b + 1 < end; b += 2, block += 18) {
      even.add(block, x + 3 * std::size_t(pattern.column[b]));
      odd.add(block + 9, x + 3 * std::size_t(pattern.column[b + 1]));
    }
    if (b < end) even.add(block, x + 3 * std::size_t(pattern.column[b]));
    even.store_with(odd, y + 3 * std::size_t(row));
  }
}

}  // namespace

void multiply_rows(const BlockMatrix& a, const double* x, IndexRange rows, double* y) {
  multiply_range<DoubleSum>(a, x, rows, y);
}

void multiply_rows(const BlockMatrixF& a, const float* x, IndexRange rows, float* y) {
  multiply_range<FloatSum>(a, x, rows, y);
}

void multiply(const BlockMatrix& a, const Eigen::VectorXd& x, Eigen::VectorXd& y) {
  multiply_rows(a, x.data(), {0, a.pattern->node_count()}, y.data());
}

void multiply(const BlockMatrixF& a, const Eigen::VectorXf& x, Eigen::VectorXf& y) {
  multiply_rows(a, x.data(), {0, a.pattern->node_count()}, y.data());
}

}  // namespace souple
