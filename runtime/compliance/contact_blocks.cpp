// SPDX-License-Identifier: MIT
#include "runtime/compliance/contact_blocks.hpp"

#include <algorithm>
#include <cstring>
#ifdef __AVX__
#include <immintrin.h>
#endif

namespace souple {
namespace {

// New nodes that are evaluated at once: few enough that the triangle above the diagonal, which symmetry
// gives, costs little; enough that a representation can work by small matrix products.
constexpr std::size_t chunk_nodes = 150;
constexpr std::size_t tile = 8;  // scalars

// to(j, i) = from(i, j), both with rows of the given strides.
#ifdef __AVX__
void transpose_tile(const float* from, std::size_t from_stride, float* to, std::size_t to_stride) {
  __m256 r[tile], t[tile];
  for (std::size_t i = 0; i < tile; ++i) r[i] = _mm256_loadu_ps(from + i * from_stride);
  for (std::size_t i = 0; i < tile; i += 2) {
    t[i] = _mm256_unpacklo_ps(r[i], r[i + 1]);
    t[i + 1] = _mm256_unpackhi_ps(r[i], r[i + 1]);
  }
  for (std::size_t i = 0; i < tile; i += 4) {
    r[i] = _mm256_shuffle_ps(t[i], t[i + 2], 0x44);
    r[i + 1] = _mm256_shuffle_ps(t[i], t[i + 2], 0xee);
    r[i + 2] = _mm256_shuffle_ps(t[i + 1], t[i + 3], 0x44);
    r[i + 3] = _mm256_shuffle_ps(t[i + 1], t[i + 3], 0xee);
  }
  for (std::size_t i = 0; i < 4; ++i) {
    _mm256_storeu_ps(to + i * to_stride, _mm256_permute2f128_ps(r[i], r[i + 4], 0x20));
    _mm256_storeu_ps(to + (i + 4) * to_stride, _mm256_permute2f128_ps(r[i], r[i + 4], 0x31));
  }
}
#else
void transpose_tile(const float* from, std::size_t from_stride, float* to, std::size_t to_stride) {
  for (std::size_t i = 0; i < tile; ++i)
    for (std::size_t j = 0; j < tile; ++j) to[j * to_stride + i] = from[i * from_stride + j];
}
#endif

}  // namespace

void ContactBlocks::clear() {
  rows_.clear();
  slots_.clear();
}

// More room than before; what is held moves to the new places. A tile may read past the last row.
void ContactBlocks::reserve(std::size_t count) {
  if (count <= capacity_) return;
  const std::size_t grown = std::max(count, capacity_ + capacity_ / 2);
  std::vector<float> values((3 * grown + tile) * 3 * grown + tile, 0.0F);
  for (std::size_t row = 0; row < 3 * capacity_; ++row)
    std::copy_n(values_.data() + row * stride(), stride(), values.data() + row * 3 * grown);
  values_ = std::move(values);
  capacity_ = grown;
  for (auto* list : {&rows_, &slots_, &row_at_, &earlier_rows_, &earlier_slots_}) list->reserve(grown);
  is_taken_.reserve(grown);
  moves_.reserve(grown);
  transposed_.reserve(tile * (3 * chunk_nodes + tile));
}

// The slots of the rows that were there before, -1 for others; how many they are.
std::size_t ContactBlocks::keep(std::span<const Index> rows) {
  std::swap(rows_, earlier_rows_);
  std::swap(slots_, earlier_slots_);
  rows_.assign(rows.begin(), rows.end());
  slots_.assign(rows.size(), -1);
  std::size_t kept = 0;
  for (std::size_t k = 0, e = 0; k < rows.size(); ++k) {
    while (e < earlier_rows_.size() && earlier_rows_[e] < rows[k]) ++e;
    if (e == earlier_rows_.size()) break;
    if (earlier_rows_[e] != rows[k]) continue;
    slots_[k] = earlier_slots_[e];
    ++kept;
  }
  return kept;
}

// What is kept takes the first slots: the last of it move to where others have gone.
void ContactBlocks::close_gaps(std::size_t kept) {
  is_taken_.assign(kept, 0);
  for (const Index slot : slots_)
    if (slot >= 0 && std::size_t(slot) < kept) is_taken_[std::size_t(slot)] = 1;
  moves_.clear();
  Index gap = 0;
  for (Index& slot : slots_) {
    if (slot < 0 || std::size_t(slot) < kept) continue;
    while (is_taken_[std::size_t(gap)]) ++gap;
    moves_.push_back({slot, gap});
    slot = gap++;
  }
  // Columns first, row by row of what is kept, wherever it still is; then whole rows.
  const auto move_columns = [&](Index slot) {
    for (std::size_t i = 0; i < 3; ++i) {
      float* row = values_.data() + (3 * std::size_t(slot) + i) * stride();
      for (const Move& move : moves_)
        std::memcpy(row + 3 * move.to, row + 3 * move.from, 3 * sizeof(float));
    }
  };
  if (moves_.empty()) return;
  for (std::size_t slot = 0; slot < kept; ++slot)
    if (is_taken_[slot]) move_columns(Index(slot));
  for (const Move& move : moves_) {
    move_columns(move.from);
    for (std::size_t i = 0; i < 3; ++i)
      std::copy_n(values_.data() + (3 * std::size_t(move.from) + i) * stride(), 3 * kept,
                  values_.data() + (3 * std::size_t(move.to) + i) * stride());
  }
}

void ContactBlocks::update(const RestCompliance& rest, std::span<const Index> rows) {
  reserve(rows.size());
  const std::size_t kept = keep(rows);
  close_gaps(kept);
  row_at_.resize(rows.size());
  auto next = static_cast<Index>(kept);
  for (std::size_t k = 0; k < rows.size(); ++k) {
    if (slots_[k] < 0) slots_[k] = next++;
    row_at_[std::size_t(slots_[k])] = rows[k];
  }
  // Against what was kept and what has come before.
  const std::span<const Index> all(row_at_);
  for (std::size_t first = kept, last; first < rows.size(); first = last) {
    last = std::min(first + chunk_nodes, rows.size());
    rest.gather_block(all.subspan(first, last - first), all.first(last),
                      values_.data() + 3 * first * stride(), stride(), work_);
    store_transposes(first, last);
  }
}

// Rows [first, last) into the columns of all earlier rows, by tiles. What the last tiles take from
// beyond is not stored.
void ContactBlocks::store_transposes(std::size_t first, std::size_t last) {
  const std::size_t rows = 3 * (last - first), columns = 3 * first;
  const std::size_t padded = (rows + tile - 1) / tile * tile;
  const float* source = values_.data() + 3 * first * stride();
  transposed_.resize(tile * padded);
  for (std::size_t q = 0; q < columns; q += tile) {
    for (std::size_t p = 0; p < rows; p += tile)
      transpose_tile(source + p * stride() + q, stride(), transposed_.data() + p, padded);
    for (std::size_t j = q; j < std::min(q + tile, columns); ++j)
      std::copy_n(transposed_.data() + (j - q) * padded, rows,
                  values_.data() + j * stride() + 3 * first);
  }
}

std::size_t ContactBlocks::bytes() const {
  return (values_.capacity() + transposed_.capacity() + work_.a.capacity() + work_.b.capacity() +
          work_.c.capacity() + work_.coarse_block.capacity() + work_.half_block.capacity()) *
         sizeof(float);
}

}  // namespace souple
