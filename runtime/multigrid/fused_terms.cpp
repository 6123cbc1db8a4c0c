// SPDX-License-Identifier: MIT
#include "runtime/multigrid/fused_terms.hpp"

#include <array>
#include <utility>

#include "runtime/multigrid/block_kernel.hpp"

namespace souple {
namespace {

using block_kernel::Block;

std::size_t at(Index i) { return static_cast<std::size_t>(i); }

}  // namespace

FusedTerms FusedTerms::create(const BlockPattern& fine, const RowProductsPlan& plan) {
  const RowProducts& rows = plan.products;
  constexpr std::size_t width = RowProducts::width;
  // f(position in T, fine block, weight) for every product of two weights that are not zero.
  const auto for_terms = [&](const auto& f) {
    const std::uint8_t* slot = rows.slot_.data();
    const Index* target = rows.target_.data();
    for (const RowProducts::Piece& piece : rows.pieces_) {
      const float* const own = rows.weight_.data() + width * at(piece.node);
      for (Index k = piece.first; k < piece.first + piece.block_count; ++k, slot += width) {
        const float* const other = rows.weight_.data() + width * at(fine.column[at(k)]);
        const float half = k == fine.diagonal[at(piece.node)] ? 0.5F : 1.0F;
        for (std::size_t w = 0; w < width * width; ++w)
          if (const float weight = half * own[w % width] * other[w / width]; weight != 0)
            f(at(target[width * slot[w / width] + w % width]), k, weight);
      }
      target += width * piece.slot_count;
    }
  };
  std::vector<Index> next(plan.pattern.block_count(), 0);
  for_terms([&](std::size_t block, Index, float) { ++next[block]; });
  FusedTerms fused;
  Index count = 0;
  // The number of terms of a block of T becomes the place of its first one.
  const auto place = [&](Index block) {
    count += std::exchange(next[at(block)], count);
    return count;
  };
  for (std::size_t a = 0; a < plan.pattern.diagonal.size(); ++a)
    for (Index k = plan.pattern.diagonal[a]; k < plan.pattern.row_begin[a + 1]; ++k) {
      const Index lower = rows.mirror_[fused.targets_.size()];
      const Index upper_end = place(k);
      fused.targets_.push_back({k, lower, upper_end, lower == k ? upper_end : place(lower)});
    }
  fused.terms_.resize(at(count));
  for_terms([&](std::size_t block, Index source, float weight) {
    fused.terms_[at(next[block]++)] = {source, weight};
  });
  return fused;
}

void FusedTerms::replay(const BlockMatrixF& fine, BlockMatrixF& coarse) const {
  std::size_t term = 0;
  const auto sum_until = [&](Index end) {
    Block sum = block_kernel::zero();
    for (; term < at(end); ++term)
      sum = block_kernel::add(
          sum, terms_[term].weight,
          block_kernel::load(fine.values.data() + block_kernel::floats * at(terms_[term].source)));
    return sum;
  };
  for (const Target& target : targets_) {
    std::array<float, block_kernel::floats> upper, lower;
    block_kernel::store(upper.data(), sum_until(target.upper_end));
    const bool diagonal = target.upper == target.lower;
    if (!diagonal) block_kernel::store(lower.data(), sum_until(target.lower_end));
    block_kernel::store_symmetric(upper.data(), diagonal ? upper.data() : lower.data(),
                                  coarse.values.data() + block_kernel::floats * at(target.upper),
                                  coarse.values.data() + block_kernel::floats * at(target.lower));
  }
}

std::size_t FusedTerms::bytes() const {
  return targets_.size() * sizeof(Target) + terms_.size() * sizeof(Term);
}

double FusedTerms::flops() const {
  return double(block_kernel::floats) * (2.0 * double(terms_.size()) + double(targets_.size()));
}

}  // namespace souple
