// SPDX-License-Identifier: MIT
#include "runtime/fem/assembly_plan.hpp"

#include <algorithm>

namespace souple {
namespace {

/// Rows of a band: few enough that what its blocks read and write stays in the first-level cache.
constexpr Index band_rows = 32;

struct Outer {
  Lanes row[3];
};

SOUPLE_KERNEL void add_outer(const CornerVector& a, Lanes b, Outer& sum) {
  for (int r = 0; r < 3; ++r) sum.row[r] = fma(_mm256_broadcast_sd(&a.entry[r]), b, sum.row[r]);
}

SOUPLE_KERNEL Outer transposed(Outer p) {
  Lanes padding = zero_lanes();
  transpose(p.row[0], p.row[1], p.row[2], padding);
  return p;
}

/// a P + b Q + c I, row-major.
SOUPLE_KERNEL void store_block(double a, const Outer& p, double b, const Outer& q, double c,
                               double* to) {
  const Lanes unit[3] = {_mm256_set_pd(0, 0, 0, c), _mm256_set_pd(0, 0, c, 0),
                         _mm256_set_pd(0, c, 0, 0)};
  Lanes row[3];
  for (int r = 0; r < 3; ++r)
    row[r] = fma(all_lanes(b), q.row[r], fma(all_lanes(a), p.row[r], unit[r]));
  // The fourth entry of a row is overwritten by the next.
  _mm256_storeu_pd(to, row[0]);
  _mm256_storeu_pd(to + 3, row[1]);
  store3(to + 6, row[2]);
}

}  // namespace

AssemblyPlan::AssemblyPlan(const BlockPattern& pattern, std::span<const Tet> tets,
                           std::span<const CornerVector> rest_gradients, std::vector<double> ratio)
    : ratio_(std::move(ratio)), mirror_(pattern.block_count()) {
  if (std::ranges::adjacent_find(ratio_, std::ranges::not_equal_to{}) == ratio_.end()) ratio_.resize(1);
  std::vector<Index> term_count(pattern.block_count(), 0);
  std::vector<Index> places;  // of the blocks above the diagonal, in the order of tets and corners
  places.reserve(6 * tets.size());
  for (const Tet& tet : tets)
    for (std::size_t i = 0; i < 4; ++i)
      for (std::size_t j = 0; j < 4; ++j)
        if (tet[i] < tet[j]) {
          places.push_back(pattern.find(tet[i], tet[j]));
          ++term_count[std::size_t(places.back())];
        }
  order_blocks(pattern, term_count);
  fill_terms(tets, rest_gradients, term_count, places);
}

void AssemblyPlan::order_blocks(const BlockPattern& pattern, std::span<const Index> term_count) {
  for (Index band = 0; band < pattern.node_count(); band += band_rows) {
    band_begin_.push_back(static_cast<Index>(blocks_.size()));
    const auto first = std::ptrdiff_t(blocks_.size());
    for (Index row = band; row < std::min(band + band_rows, pattern.node_count()); ++row) {
      mirror_[std::size_t(pattern.diagonal[row])] = pattern.diagonal[row];
      for (Index b = pattern.diagonal[row] + 1; b < pattern.row_begin[row + 1]; ++b) {
        const Index lower = pattern.find(pattern.column[b], row);
        mirror_[std::size_t(b)] = lower;
        mirror_[std::size_t(lower)] = b;
        blocks_.push_back({b, lower, 0, 0});
      }
    }
    std::stable_sort(blocks_.begin() + first, blocks_.end(), [&](const auto& a, const auto& b) {
      return term_count[std::size_t(a.upper)] < term_count[std::size_t(b.upper)];
    });
  }
  band_begin_.push_back(static_cast<Index>(blocks_.size()));
}

void AssemblyPlan::fill_terms(std::span<const Tet> tets, std::span<const CornerVector> rest_gradients,
                              std::span<const Index> term_count, std::span<const Index> places) {
  std::vector<Index> order_of(mirror_.size(), -1), next(blocks_.size());
  Index term_end = 0;
  for (std::size_t k = 0; k < blocks_.size(); ++k) {
    order_of[std::size_t(blocks_[k].upper)] = static_cast<Index>(k);
    next[k] = term_end;
    term_end += term_count[std::size_t(blocks_[k].upper)];
    blocks_[k].term_end = term_end;
  }
  terms_.resize(places.size());
  std::size_t place = 0;
  for (std::size_t t = 0; t < tets.size(); ++t)
    for (std::size_t i = 0; i < 4; ++i)
      for (std::size_t j = 0; j < 4; ++j) {
        if (tets[t][i] >= tets[t][j]) continue;
        const auto k = std::size_t(order_of[std::size_t(places[place++])]);
        terms_[std::size_t(next[k]++)] = {static_cast<std::uint32_t>(4 * t + i),
                                          static_cast<std::uint32_t>(4 * t + j)};
        const double* a = rest_gradients[4 * t + i].entry;
        const double* b = rest_gradients[4 * t + j].entry;
        blocks_[k].dot_sum += a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
      }
}

template <bool is_uniform>
void AssemblyPlan::assemble_bands(std::span<const CornerVector> gradients, double factor,
                                  IndexRange bands, BlockMatrix& out) const {
  const Index begin = band_begin_[bands.begin], end = band_begin_[bands.end];
  std::size_t term = begin > 0 ? std::size_t(blocks_[begin - 1].term_end) : 0;
  for (Index k = begin; k < end; ++k) {
    const OffDiagonal& block = blocks_[k];
    Outer plain{}, weighted{};
    for (; term < std::size_t(block.term_end); ++term) {
      const auto [first, second] = terms_[term];
      const Lanes gj = _mm256_load_pd(gradients[second].entry);
      add_outer(gradients[first], gj, plain);
      if constexpr (!is_uniform)
        add_outer(gradients[first], all_lanes(ratio_[first / 4]) * gj, weighted);
    }
    // (i, j) is a P + b P^T + c I, so (j, i) is a P^T + b P + c I: the same numbers.
    const double c = factor * block.dot_sum;
    const Outer turned = transposed(plain);
    double* upper = out.values.data() + 9 * std::size_t(block.upper);
    double* lower = out.values.data() + 9 * std::size_t(block.lower);
    if constexpr (is_uniform) {
      store_block(factor * ratio_[0], plain, factor, turned, c, upper);
      store_block(factor * ratio_[0], turned, factor, plain, c, lower);
    } else {
      store_block(factor, weighted, factor, turned, c, upper);
      store_block(factor, transposed(weighted), factor, plain, c, lower);
    }
  }
}

void AssemblyPlan::assemble_off_diagonal(std::span<const CornerVector> gradients, double factor,
                                         IndexRange bands, BlockMatrix& out) const {
  if (ratio_.size() == 1)
    assemble_bands<true>(gradients, factor, bands, out);
  else
    assemble_bands<false>(gradients, factor, bands, out);
}

void AssemblyPlan::assemble_diagonal(double mass_factor, std::span<const double> masses,
                                     IndexRange bands, BlockMatrix& out) const {
  const BlockPattern& pattern = *out.pattern;
  const Index end = std::min(band_rows * bands.end, pattern.node_count());
  for (Index row = band_rows * bands.begin; row < end; ++row) {
    Outer sum{};
    for (Index b = pattern.row_begin[row]; b < pattern.row_begin[row + 1]; ++b) {
      if (b == pattern.diagonal[row]) continue;
      const double* block = out.values.data() + 9 * std::size_t(b);
      sum.row[0] = sum.row[0] + _mm256_loadu_pd(block);
      sum.row[1] = sum.row[1] + _mm256_loadu_pd(block + 3);
      sum.row[2] = sum.row[2] + load3(block + 6);
    }
    // The sum is symmetric but for round-off, and is made so exactly.
    store_block(-0.5, sum, -0.5, transposed(sum), mass_factor * masses[std::size_t(row)],
                out.values.data() + 9 * std::size_t(pattern.diagonal[row]));
  }
}

void AssemblyPlan::hold(std::span<const char> is_held, BlockMatrix& out) const {
  const BlockPattern& pattern = *out.pattern;
  for (Index row = 0; row < pattern.node_count(); ++row) {
    if (!is_held[std::size_t(row)]) continue;
    for (Index b = pattern.row_begin[row]; b < pattern.row_begin[row + 1]; ++b) {
      out.block(b).setZero();
      out.block(mirror_[std::size_t(b)]).setZero();
    }
    out.block(pattern.diagonal[row]).setIdentity();
  }
}

std::size_t AssemblyPlan::bytes() const {
  return blocks_.size() * sizeof(OffDiagonal) + terms_.size() * sizeof(Term) +
         ratio_.size() * sizeof(double) + (band_begin_.size() + mirror_.size()) * sizeof(Index);
}

}  // namespace souple
