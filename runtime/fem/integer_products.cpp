// SPDX-License-Identifier: MIT
#include "runtime/fem/integer_products.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#if defined(__AVX2__) && defined(__FMA__)
#include <immintrin.h>
#endif

namespace souple {

// With r the largest sum of magnitudes of a row or column over the largest entry, a product of both
// factors at n stays in 32 bits if r n^2 < 2^31: both get the same number of bits.
IntegerBlock append_integers(const Eigen::MatrixXd& matrix, PackedValues& values) {
  constexpr double limit = std::numeric_limits<std::int32_t>::max();
  IntegerBlock block;
  block.rows = static_cast<std::size_t>(matrix.rows());
  block.columns = static_cast<std::size_t>(matrix.cols());
  const double largest = matrix.size() > 0 ? matrix.cwiseAbs().maxCoeff() : 0;
  if (!(largest > 0)) {
    values.insert(values.end(), block.rows_padded() * ((block.columns + 1) / 2 * 2), 0);
    return block;
  }
  const double sum = std::max(matrix.cwiseAbs().rowwise().sum().maxCoeff(),
                              matrix.cwiseAbs().colwise().sum().maxCoeff());
  const double top = std::min(32'767.0, std::floor(std::sqrt(limit * largest / sum)));
  block.unit = float(largest / top);
  // Rounding adds at most a half to every entry of a row or column.
  const double added = 0.5 * double(std::max(matrix.rows(), matrix.cols()));
  block.most = std::int32_t(std::min(32'767.0, limit / (sum / largest * top + added + 1)));
  for (Eigen::Index j = 0; j < matrix.cols(); ++j) {
    for (Eigen::Index i = 0; i < matrix.rows(); ++i)
      values.push_back(static_cast<std::uint16_t>(
          static_cast<std::int16_t>(std::lround(matrix(i, j) / largest * top))));
    values.insert(values.end(), block.rows_padded() - block.rows, 0);
  }
  if (block.columns % 2 == 1) values.insert(values.end(), block.rows_padded(), 0);
  return block;
}

#if defined(__AVX2__) && defined(__FMA__)

namespace {

__m256i sixteen(const void* values) { return _mm256_loadu_si256(static_cast<const __m256i*>(values)); }

// A line holds 32 numbers, two steps of a column: each step asks for every other one of the columns
// that come next. Pieces are small and their columns short, so that the processor does not see the
// stream.
void prefetch(const std::uint16_t* values) {
  _mm_prefetch(reinterpret_cast<const char*>(values), _MM_HINT_T0);
}

__m256 magnitude(__m256 v) { return _mm256_andnot_ps(_mm256_set1_ps(-0.0F), v); }

float largest_of(__m256 v) {
  const __m128 four = _mm_max_ps(_mm256_castps256_ps128(v), _mm256_extractf128_ps(v, 1));
  const __m128 two = _mm_max_ps(four, _mm_movehl_ps(four, four));
  return _mm_cvtss_f32(_mm_max_ss(two, _mm_shuffle_ps(two, two, 1)));
}

// The eight entries from `begin` on; zero from `count` on.
__m256 eight_of(const float* x, std::size_t begin, std::size_t count) {
  if (begin + 8 <= count) return _mm256_loadu_ps(x + begin);
  alignas(32) float rest[8] = {};
  if (begin < count) std::copy(x + begin, x + count, rest);
  return _mm256_load_ps(rest);
}

// Rounds x to integers up to `most` in `integers`, zeros up to a multiple of 16. Returns their unit:
// zero if all are zero, not a number if one is not finite.
float round_to_integers(const float* x, std::size_t count, std::int32_t most, float* integers) {
  __m256 large = _mm256_setzero_ps(), finite = large;
  for (std::size_t i = 0; i < count; i += 8) {
    const __m256 v = eight_of(x, i, count);
    large = _mm256_max_ps(magnitude(v), large);
    finite = _mm256_fmadd_ps(v, _mm256_setzero_ps(), finite);
  }
  if (_mm256_movemask_ps(_mm256_cmp_ps(finite, finite, _CMP_UNORD_Q)) != 0)
    return std::numeric_limits<float>::quiet_NaN();
  const float largest = largest_of(large);
  // So small that its inverse would not be finite: nothing beside what products round off.
  if (!(largest > 1e-30F)) return 0;
  const __m256 scale = _mm256_set1_ps(float(most) / largest);
  for (std::size_t i = 0; i < count; i += 16) {
    const __m256i low = _mm256_cvtps_epi32(_mm256_mul_ps(eight_of(x, i, count), scale));
    const __m256i high = _mm256_cvtps_epi32(_mm256_mul_ps(eight_of(x, i + 8, count), scale));
    _mm256_storeu_si256(reinterpret_cast<__m256i*>(integers + i / 2),
                        _mm256_permute4x64_epi64(_mm256_packs_epi32(low, high), 0xd8));
  }
  return largest / float(most);
}

// The integers 2k and 2k + 1 in every lane.
__m256i pair_of(const float* integers, std::size_t k) {
  std::int32_t pair;
  std::memcpy(&pair, integers + k, sizeof(pair));
  return _mm256_set1_epi32(pair);
}

void add_scaled(__m256i sums, __m256 unit, float* y) {
  _mm256_storeu_ps(y, _mm256_fmadd_ps(_mm256_cvtepi32_ps(sums), unit, _mm256_loadu_ps(y)));
}

// Two columns a pair: their entries side by side, so that one instruction adds both products.
template <std::size_t pairs>
void add_columns(const std::uint16_t* m, std::size_t rows, const float* integers, float unit,
                 float* y) {
  __m256i x[pairs];
  for (std::size_t p = 0; p < pairs; ++p) x[p] = pair_of(integers, p);
  const __m256 units = _mm256_set1_ps(unit);
  for (std::size_t i = 0; i < rows; i += 16) {
    __m256i low = _mm256_setzero_si256(), high = low;
    for (std::size_t p = 0; p < pairs; ++p) {
      const __m256i a = sixteen(m + 2 * p * rows + i), b = sixteen(m + (2 * p + 1) * rows + i);
      prefetch(m + (2 * pairs + 2 * p + i / 16 % 2) * rows + i);
      low = _mm256_add_epi32(low, _mm256_madd_epi16(_mm256_unpacklo_epi16(a, b), x[p]));
      high = _mm256_add_epi32(high, _mm256_madd_epi16(_mm256_unpackhi_epi16(a, b), x[p]));
    }
    add_scaled(_mm256_permute2x128_si256(low, high, 0x20), units, y + i);
    add_scaled(_mm256_permute2x128_si256(low, high, 0x31), units, y + i + 8);
  }
}

// The sums of the lanes of four vectors.
__m128i four_sums(__m256i a, __m256i b, __m256i c, __m256i d) {
  const __m256i sums = _mm256_hadd_epi32(_mm256_hadd_epi32(a, b), _mm256_hadd_epi32(c, d));
  return _mm_add_epi32(_mm256_castsi256_si128(sums), _mm256_extracti128_si256(sums, 1));
}

// Of up to four columns.
template <std::size_t columns>
__m128i transposed_columns(const std::uint16_t* m, std::size_t rows, const float* integers) {
  __m256i sums[4];
  for (__m256i& sum : sums) sum = _mm256_setzero_si256();
  for (std::size_t i = 0; i < rows; i += 16) {
    const __m256i x = sixteen(integers + i / 2);
    for (std::size_t j = i / 16 % 2; j < columns; j += 2) prefetch(m + (columns + j) * rows + i);
    for (std::size_t j = 0; j < columns; ++j)
      sums[j] = _mm256_add_epi32(sums[j], _mm256_madd_epi16(sixteen(m + j * rows + i), x));
  }
  return four_sums(sums[0], sums[1], sums[2], sums[3]);
}

}  // namespace

void add_product(const IntegerBlock& m, const float* x, float* y, float* scratch) {
  const float unit = m.unit * round_to_integers(x, m.columns, m.most, scratch);
  if (unit == 0) return;
  const std::size_t rows = m.rows_padded();
  if (std::isnan(unit)) return std::fill(y, y + rows, unit);
  std::size_t j = 0;
  for (; j + 8 <= m.columns; j += 8)
    add_columns<4>(m.values + j * rows, rows, scratch + j / 2, unit, y);
  for (; j < m.columns; j += 2) add_columns<1>(m.values + j * rows, rows, scratch + j / 2, unit, y);
}

void subtract_transposed_product(const IntegerBlock& m, const float* x, float* y, float* scratch) {
  const float unit = m.unit * round_to_integers(x, m.rows, m.most, scratch);
  if (unit == 0) return;
  const std::size_t rows = m.rows_padded();
  if (std::isnan(unit)) return std::fill(y, y + m.columns, unit);
  alignas(16) float sums[4];
  for (std::size_t j = 0; j < m.columns; j += 4) {
    const std::uint16_t* from = m.values + j * rows;
    const bool four = j + 2 < m.columns;
    const __m128i all =
        four ? transposed_columns<4>(from, rows, scratch) : transposed_columns<2>(from, rows, scratch);
    _mm_store_ps(sums, _mm_cvtepi32_ps(all));
    for (std::size_t k = j; k < std::min(j + 4, m.columns); ++k) y[k] -= unit * sums[k - j];
  }
}

#else

namespace {

float value_of(const IntegerBlock& m, std::size_t i, std::size_t j) {
  return m.unit * float(static_cast<std::int16_t>(m.values[j * m.rows_padded() + i]));
}

}  // namespace

void add_product(const IntegerBlock& m, const float* x, float* y, float*) {
  for (std::size_t j = 0; j < m.columns; ++j)
    for (std::size_t i = 0; i < m.rows; ++i) y[i] += value_of(m, i, j) * x[j];
}

void subtract_transposed_product(const IntegerBlock& m, const float* x, float* y, float*) {
  for (std::size_t j = 0; j < m.columns; ++j) {
    float sum = 0;
    for (std::size_t i = 0; i < m.rows; ++i) sum += value_of(m, i, j) * x[i];
    y[j] -= sum;
  }
}

#endif

}  // namespace souple
