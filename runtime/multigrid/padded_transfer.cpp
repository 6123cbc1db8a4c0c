// SPDX-License-Identifier: MIT
#include "runtime/multigrid/padded_transfer.hpp"

#include <immintrin.h>

#include <algorithm>

namespace souple {

PaddedTransfer::PaddedTransfer(const Prolongation& p)
    : row_begin_(p.row_begin), column_(p.column), weight_(p.weight.begin(), p.weight.end()) {}

void PaddedTransfer::restrict_to(const PaddedVector& fine, PaddedVector& coarse) const {
  std::ranges::fill(coarse, 0.0F);
  for (std::size_t row = 0; row + 1 < row_begin_.size(); ++row) {
    const __m128 value = _mm_loadu_ps(fine.data() + 4 * row);
    for (auto k = std::size_t(row_begin_[row]); k < std::size_t(row_begin_[row + 1]); ++k) {
      float* sum = coarse.data() + 4 * std::size_t(column_[k]);
      _mm_storeu_ps(sum, _mm_fmadd_ps(_mm_set1_ps(weight_[k]), value, _mm_loadu_ps(sum)));
    }
  }
}

void PaddedTransfer::add_prolonged(const PaddedVector& coarse, PaddedVector& fine) const {
  for (std::size_t row = 0; row + 1 < row_begin_.size(); ++row) {
    __m128 sum = _mm_loadu_ps(fine.data() + 4 * row);
    for (auto k = std::size_t(row_begin_[row]); k < std::size_t(row_begin_[row + 1]); ++k)
      sum = _mm_fmadd_ps(_mm_set1_ps(weight_[k]),
                         _mm_loadu_ps(coarse.data() + 4 * std::size_t(column_[k])), sum);
    _mm_storeu_ps(fine.data() + 4 * row, sum);
  }
}

std::size_t PaddedTransfer::bytes() const {
  return (row_begin_.size() + column_.size()) * sizeof(Index) + weight_.size() * sizeof(float);
}

}  // namespace souple
