// SPDX-License-Identifier: MIT
#include "runtime/compliance/pair_table.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <new>
#include <numeric>
#include <vector>
#if defined(__AVX2__)
#include <immintrin.h>
#endif

#include "runtime/compliance/block_gather.hpp"

namespace souple {
namespace {

// Where entry (i, j) of a block stands among the mantissas.
constexpr std::size_t place_in_pair[3][3] = {{0, 1, 2}, {4, 5, 6}, {3, 7, 8}};
constexpr std::size_t tile_nodes = 256;  // of the evaluation that fills the table

float step_of(const StoredPair& pair) { return std::bit_cast<float>(std::uint32_t{pair.step} << 16); }

// The least bfloat16 that is not below `value`, which is positive and far from the ends of the range.
std::uint16_t rounded_up(float value) {
  return static_cast<std::uint16_t>((std::bit_cast<std::uint32_t>(value) + 0xFFFFU) >> 16);
}

std::array<float, 9> block_of(const StoredPair& pair, bool transposed) {
  std::array<float, 9> block;
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j)
      block[transposed ? 3 * j + i : 3 * i + j] =
          float(pair.mantissa[place_in_pair[i][j]]) * step_of(pair);
  return block;
}

void store_block(const StoredPair& pair, bool transposed, float* out, std::size_t stride) {
  const std::array<float, 9> block = block_of(pair, transposed);
  for (std::size_t i = 0; i < 3; ++i) std::copy_n(block.data() + 3 * i, 3, out + i * stride);
}

#if defined(__AVX2__)
// The same, but a fourth number is written behind each row.
void store_wide(const StoredPair& pair, float* out, std::size_t stride) {
  const __m128i packed = _mm_loadu_si128(reinterpret_cast<const __m128i*>(pair.mantissa.data()));
  const float step = step_of(pair);
  const __m256 eight =
      _mm256_mul_ps(_mm256_cvtepi32_ps(_mm256_cvtepi16_epi32(packed)), _mm256_set1_ps(step));
  const __m128 row0 = _mm256_castps256_ps128(eight), row1 = _mm256_extractf128_ps(eight, 1);
  const __m128 last = _mm_set_ss(float(pair.mantissa[8]) * step);
  const __m128 fourths = _mm_unpackhi_ps(row0, row1);  // 02, 12, 20, 21
  _mm_storeu_ps(out, row0);
  _mm_storeu_ps(out + stride, row1);
  _mm_storeu_ps(out + 2 * stride, _mm_shuffle_ps(fourths, last, 0x0e | 0x40));
}
#else
void store_wide(const StoredPair& pair, float* out, std::size_t stride) {
  store_block(pair, false, out, stride);
}
#endif

}  // namespace

StoredPair stored_pair(const float* block, std::size_t stride) {
  constexpr float least = 1e-30F, most = 32767;
  float largest = 0;
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j) largest = std::max(largest, std::abs(block[i * stride + j]));
  StoredPair pair;
  if (!(largest >= least)) return pair;
  pair.step = rounded_up(largest / most);
  const float per_step = 1 / step_of(pair);
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j)
      pair.mantissa[place_in_pair[i][j]] = static_cast<std::int16_t>(
          std::clamp(std::nearbyint(block[i * stride + j] * per_step), -most, most));
  return pair;
}

PairTable::PairTable(Index node_count)
    : node_count_(node_count),
      pairs_(new (std::nothrow) StoredPair[bytes_for(node_count) / sizeof(StoredPair)]) {}

std::unique_ptr<const PairTable> PairTable::create(const DecodedRecords& records) {
  const auto count = std::size_t(records.node_count());
  std::unique_ptr<PairTable> table(new PairTable(records.node_count()));
  if (!table->pairs_) return nullptr;
  ComplianceWork work;
  std::vector<Index> rows(count);
  for (std::size_t k = 0; k < count; ++k) rows[k] = records.row_at(Index(k));
  const std::span<const Index> all(rows);
  const std::size_t stride = 3 * std::min(tile_nodes, count);
  std::vector<float> tile(stride * stride);
  for (std::size_t row = 0; row < count; row += tile_nodes)
    for (std::size_t column = 0; column <= row; column += tile_nodes) {
      const std::size_t height = std::min(tile_nodes, count - row),
                        width = std::min(tile_nodes, count - column);
      BlockGather(records, work, tile.data(), stride)
          .run(all.subspan(row, height), all.subspan(column, width));
      for (std::size_t a = 0; a < height; ++a) {
        StoredPair* to = table->pairs_.get() + (row + a) * (row + a + 1) / 2 + column;
        for (std::size_t b = 0; b < width && column + b <= row + a; ++b)
          to[b] = stored_pair(tile.data() + 3 * a * stride + 3 * b, stride);
      }
    }
  return table;
}

// Every block but the last of a row is written with what the next one overwrites.
void PairTable::read_lower(std::span<const SortedRow> rows, float* out, std::size_t stride) const {
  for (std::size_t a = 0; a < rows.size(); ++a, out += 3 * stride) {
    const StoredPair* row = row_of(std::size_t(position_of(rows[a])));
    const StoredPair* next = row_of(std::size_t(position_of(rows[std::min(a + 1, rows.size() - 1)])));
    for (std::size_t b = 0; b < a; ++b) {
      __builtin_prefetch(next + position_of(rows[b]));
      store_wide(row[position_of(rows[b])], out + 3 * b, stride);
    }
    store_block(row[position_of(rows[a])], false, out + 3 * a, stride);
  }
}

void PairTable::read_block(std::span<const SortedRow> rows, std::span<const SortedRow> columns,
                           float* out, std::size_t stride) const {
  for (const SortedRow row : rows)
    for (const SortedRow column : columns) {
      const auto a = std::size_t(position_of(row)), b = std::size_t(position_of(column));
      store_block(row_of(std::max(a, b))[std::min(a, b)], a < b,
                  out + 3 * place_of(row) * stride + 3 * place_of(column), stride);
    }
}

}  // namespace souple
