// SPDX-License-Identifier: MIT
#include "runtime/contact/block_sparse_operator.hpp"

#include <algorithm>
#if defined(__AVX2__) && defined(__FMA__)
#include <immintrin.h>
#endif

namespace souple {

BlockSparseOperator::BlockSparseOperator(const BlockColumns& delassus, std::span<const double> free_gap)
    : free_gap_(free_gap),
      begin_(delassus.begin),
      row_(delassus.row),
      value_(3 * lanes * delassus.row.size()),
      gap_(lanes * delassus.size()) {
  for (std::size_t c = 0; c < 3 * row_.size(); ++c)
    std::copy_n(&delassus.value[3 * c], 3, &value_[lanes * c]);
}

Mat3 BlockSparseOperator::diagonal_block(std::size_t i) const {
  Mat3 diagonal = Mat3::Zero();
  for_each_block(i, [&](std::size_t row, const Mat3& block) {
    if (row == i) diagonal = block;
  });
  return diagonal;
}

void BlockSparseOperator::start(std::span<const double> force) {
  for (std::size_t i = 0; i < size(); ++i) std::copy_n(&free_gap_[3 * i], 3, &gap_[lanes * i]);
  for (std::size_t i = 0; i < size(); ++i) {
    const Vec3 f = Eigen::Map<const Vec3>(&force[3 * i]);
    if (f != Vec3::Zero()) add_influence(i, f);
  }
}

void BlockSparseOperator::add_influence(std::size_t i, const Vec3& change) {
#if defined(__AVX2__) && defined(__FMA__)
  const __m256d n = _mm256_set1_pd(change[0]), t = _mm256_set1_pd(change[1]),
                s = _mm256_set1_pd(change[2]);
  for (std::size_t b = begin_[i]; b < begin_[i + 1]; ++b) {
    const double* block = &value_[3 * lanes * b];
    double* y = &gap_[lanes * row_[b]];
    __m256d sum = _mm256_fmadd_pd(n, _mm256_loadu_pd(block), _mm256_loadu_pd(y));
    sum = _mm256_fmadd_pd(t, _mm256_loadu_pd(block + 4), sum);
    _mm256_storeu_pd(y, _mm256_fmadd_pd(s, _mm256_loadu_pd(block + 8), sum));
  }
#else
  for_each_block(i, [&](std::size_t row, const Mat3& block) {
    Eigen::Map<Vec3>(&gap_[lanes * row]) += block * change;
  });
#endif
}

}  // namespace souple
