// SPDX-License-Identifier: MIT
#include "runtime/multigrid/gauss_seidel.hpp"

#include <immintrin.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace souple {
namespace {

std::size_t at(Index i) { return static_cast<std::size_t>(i); }

/// Part of a row right of the diagonal. Rows of blocks are read four floats at a time: the fourth is
/// the first of the next row or block, and after a block beside the diagonal there always is one.
struct UpperRow {
  const float* values;
  const Index* column;
  Index count;
};

UpperRow upper_row(const BlockMatrixF& a, std::size_t row) {
  const BlockPattern& pattern = *a.pattern;
  const Index begin = pattern.diagonal[row] + 1;
  return {a.values.data() + 9 * at(begin), pattern.column.data() + begin,
          pattern.row_begin[row + 1] - begin};
}

/// sum_j A_ij x_j. The fourth entry of x is 0, so that of the products is, too.
__m128 gathered(const UpperRow& row, const float* x) {
  __m128 sum0 = _mm_setzero_ps(), sum1 = _mm_setzero_ps(), sum2 = _mm_setzero_ps();
  const float* block = row.values;
  for (Index k = 0; k < row.count; ++k, block += 9) {
    const __m128 xj = _mm_load_ps(x + 4 * at(row.column[k]));
    sum0 = _mm_fmadd_ps(_mm_loadu_ps(block), xj, sum0);
    sum1 = _mm_fmadd_ps(_mm_loadu_ps(block + 3), xj, sum1);
    sum2 = _mm_fmadd_ps(_mm_loadu_ps(block + 6), xj, sum2);
  }
  __m128 sum3 = _mm_setzero_ps();
  _MM_TRANSPOSE4_PS(sum0, sum1, sum2, sum3);
  return _mm_add_ps(_mm_add_ps(sum0, sum1), sum2);
}

/// y_j -= A_ij^T x_i.
void scatter(const UpperRow& row, __m128 xi, float* y) {
  const __m128 x0 = _mm_shuffle_ps(xi, xi, 0x00), x1 = _mm_shuffle_ps(xi, xi, 0x55),
               x2 = _mm_shuffle_ps(xi, xi, 0xAA);
  const float* block = row.values;
  for (Index k = 0; k < row.count; ++k, block += 9) {
    float* place = y + 4 * at(row.column[k]);
    __m128 sum = _mm_load_ps(place);
    sum = _mm_fnmadd_ps(_mm_loadu_ps(block), x0, sum);
    sum = _mm_fnmadd_ps(_mm_loadu_ps(block + 3), x1, sum);
    sum = _mm_fnmadd_ps(_mm_loadu_ps(block + 6), x2, sum);
    _mm_store_ps(place, sum);
  }
}

__m128 times(const float* columns, __m128 v) {
  __m128 sum = _mm_mul_ps(_mm_loadu_ps(columns), _mm_shuffle_ps(v, v, 0x00));
  sum = _mm_fmadd_ps(_mm_loadu_ps(columns + 4), _mm_shuffle_ps(v, v, 0x55), sum);
  return _mm_fmadd_ps(_mm_loadu_ps(columns + 8), _mm_shuffle_ps(v, v, 0xAA), sum);
}

/// Of a Galerkin matrix in single precision, relative.
constexpr double rounding = 1e-6;

bool is_definite(const Mat3& m) {
  // Written so that NaN is refused.
  return m(0, 0) > 0 && m(0, 0) * m(1, 1) - m(0, 1) * m(1, 0) > 0 && m.determinant() > 0 &&
         std::isfinite(m.trace());
}

}  // namespace

GaussSeidel::GaussSeidel(Index node_count) : inverse_(12 * at(node_count)) {}

bool GaussSeidel::update(const BlockMatrixF& a) {
  for (std::size_t row = 0; row < a.pattern->diagonal.size(); ++row) {
    Mat3 block = a.block(a.pattern->diagonal[row]).cast<double>();
    if (!is_definite(block)) {
      block.diagonal().array() += rounding * block.trace();
      if (!is_definite(block)) return false;
    }
    const Eigen::Matrix3f inverse = block.inverse().cast<float>();
    for (Eigen::Index column = 0; column < 3; ++column)
      std::copy_n(inverse.col(column).data(), 3, inverse_.data() + 12 * row + 4 * std::size_t(column));
  }
  return true;
}

void GaussSeidel::forward(const BlockMatrixF& a, const PaddedVector& b, PaddedVector& x,
                          PaddedVector& residual) const {
  std::ranges::fill(residual, 0.0F);
  for (std::size_t row = a.pattern->diagonal.size(); row-- > 0;) {
    const UpperRow upper = upper_row(a, row);
    const __m128 rest = _mm_sub_ps(_mm_load_ps(b.data() + 4 * row), gathered(upper, x.data()));
    const __m128 xi = times(inverse_.data() + 12 * row, rest);
    _mm_store_ps(x.data() + 4 * row, xi);
    scatter(upper, xi, residual.data());
  }
}

void GaussSeidel::backward(const BlockMatrixF& a, const PaddedVector& b, PaddedVector& x,
                           PaddedVector& work) const {
  std::ranges::copy(b, work.begin());
  for (std::size_t row = 0; row < a.pattern->diagonal.size(); ++row) {
    const UpperRow upper = upper_row(a, row);
    const __m128 rest = _mm_sub_ps(_mm_load_ps(work.data() + 4 * row), gathered(upper, x.data()));
    const __m128 xi = times(inverse_.data() + 12 * row, rest);
    _mm_store_ps(x.data() + 4 * row, xi);
    scatter(upper, xi, work.data());
  }
}

void GaussSeidel::subtract_product(const BlockMatrixF& a, const PaddedVector& x, PaddedVector& y) {
  for (std::size_t row = 0; row < a.pattern->diagonal.size(); ++row) {
    const UpperRow upper = upper_row(a, row);
    const __m128 xi = _mm_load_ps(x.data() + 4 * row);
    const float* d = a.values.data() + 9 * at(a.pattern->diagonal[row]);
    const std::array<float, 12> columns{d[0], d[3], d[6], 0, d[1], d[4], d[7], 0, d[2], d[5], d[8], 0};
    const __m128 product = _mm_add_ps(gathered(upper, x.data()), times(columns.data(), xi));
    _mm_store_ps(y.data() + 4 * row, _mm_sub_ps(_mm_load_ps(y.data() + 4 * row), product));
    scatter(upper, xi, y.data());
  }
}

}  // namespace souple
