// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <string>
#include <tuple>

#include "formats/core/limits.hpp"
#include "runtime/multigrid/row_products.hpp"

namespace souple {
namespace {

std::size_t at(Index i) { return static_cast<std::size_t>(i); }

Issue invalid(const std::string& what) {
  return make_issue(IssueCode::asset_multigrid_invalid, what, "multigrid");
}

/// `begin` cuts a list of `count` entries into at least one row.
bool cuts(const std::vector<Index>& begin, std::size_t count) {
  return begin.size() > 1 && begin.front() == 0 && std::ranges::is_sorted(begin) &&
         at(begin.back()) == count;
}

/// Columns ascend in a row and are nodes of `count`.
bool has_sound_columns(const std::vector<Index>& begin, const std::vector<Index>& column, Index count) {
  for (std::size_t row = 0; row + 1 < begin.size(); ++row) {
    Index before = -1;
    for (Index k = begin[row]; k < begin[row + 1]; ++k) {
      if (column[at(k)] <= before || column[at(k)] >= count) return false;
      before = column[at(k)];
    }
  }
  return true;
}

}  // namespace

/// Believes nothing: every index is followed once, to the node that it has to lead to. What passes is
/// the plan of the product, not just a safe one.
class RowProductsOpener {
 public:
  RowProductsOpener(const BlockPattern& fine, const LevelTransition& stored)
      : fine_(fine),
        stored_(stored),
        coarse_count_(static_cast<Index>(stored.pattern_begin.size()) - 1) {}

  Result<RowProductsPlan> open(std::span<const Index> fixed) {
    if (Status sound = check_rows(); !sound) return sound.issue();
    pad_rows();
    if (Status sound = take_pattern(); !sound) return sound.issue();
    if (Status sound = take_pieces(); !sound) return sound.issue();
    if (Status sound = fix(fixed); !sound) return sound.issue();
    find_lone();
    return std::move(plan_);
  }

 private:
  static constexpr std::size_t width = RowProducts::width;

  Status check_rows() const {
    const auto& [begin, column, weight] = std::tie(stored_.row_begin, stored_.column, stored_.weight);
    if (begin.size() != at(fine_.node_count()) + 1 || !cuts(begin, column.size()) ||
        weight.size() != column.size() || !has_sound_columns(begin, column, coarse_count_))
      return invalid("the prolongation is not one of " + std::to_string(fine_.node_count()) + " to " +
                     std::to_string(coarse_count_) + " nodes");
    for (std::size_t i = 0; i + 1 < begin.size(); ++i)
      if (begin[i + 1] == begin[i] || at(begin[i + 1] - begin[i]) > width)
        return invalid("row " + std::to_string(i) + " of the prolongation has " +
                       std::to_string(begin[i + 1] - begin[i]) + " entries");
    // Written so that NaN is refused.
    const auto unsound = [](double w) { return !(std::abs(w) <= limits::embedding_weight); };
    if (std::ranges::any_of(weight, unsound)) return invalid("a weight is not finite or too large");
    return {};
  }

  void pad_rows() {
    const std::size_t n = at(fine_.node_count());
    plan_.products.weight_.assign(n * width, 0);
    column_.resize(n * width);
    for (std::size_t i = 0; i < n; ++i) {
      const std::size_t first = at(stored_.row_begin[i]), count = at(stored_.row_begin[i + 1]) - first;
      for (std::size_t w = 0; w < width; ++w)
        column_[i * width + w] = stored_.column[first + (w < count ? w : 0)];
      for (std::size_t w = 0; w < count; ++w)
        plan_.products.weight_[i * width + w] = static_cast<float>(stored_.weight[first + w]);
    }
  }

  /// Sound, symmetric and with its diagonal.
  Status take_pattern() {
    BlockPattern& pattern = plan_.pattern;
    pattern.row_begin = stored_.pattern_begin;
    pattern.column = stored_.pattern_column;
    if (!cuts(pattern.row_begin, pattern.column.size()) ||
        !has_sound_columns(pattern.row_begin, pattern.column, coarse_count_))
      return invalid("the coarse pattern is not one of " + std::to_string(coarse_count_) + " nodes");
    for (Index a = 0; a < coarse_count_; ++a) {
      const auto first = pattern.column.begin() + pattern.row_begin[at(a)];
      const auto last = pattern.column.begin() + pattern.row_begin[at(a) + 1];
      const auto diagonal = std::lower_bound(first, last, a);
      if (diagonal == last || *diagonal != a)
        return invalid("row " + std::to_string(a) + " of the coarse pattern has no diagonal block");
      pattern.diagonal.push_back(static_cast<Index>(diagonal - pattern.column.begin()));
    }
    return take_mirror();
  }

  /// The transposes of a symmetric pattern come in order: the next free place of their row is theirs.
  Status take_mirror() {
    const BlockPattern& pattern = plan_.pattern;
    std::vector<Index> next(pattern.row_begin.begin(), pattern.row_begin.end() - 1);
    for (Index a = 0; a < coarse_count_; ++a)
      for (Index k = pattern.diagonal[at(a)]; k < pattern.row_begin[at(a) + 1]; ++k) {
        const std::size_t b = at(pattern.column[at(k)]);
        const Index place = next[b]++;
        if (place > pattern.diagonal[b] || pattern.column[at(place)] != a)
          return invalid("the coarse pattern is not symmetric at (" + std::to_string(a) + ", " +
                         std::to_string(b) + ")");
        plan_.products.mirror_.push_back(place);
      }
    for (std::size_t b = 0; b < next.size(); ++b)
      if (next[b] != pattern.diagonal[b] + 1)
        return invalid("the coarse pattern is not symmetric in row " + std::to_string(b));
    return {};
  }

  /// Rows in order, each covered from its diagonal to its end.
  Status take_pieces() {
    Index node = -1, next_block = 0, row_end = 0;
    std::size_t slot = 0, target = 0;
    for (const auto& piece : stored_.pieces) {
      if (next_block == row_end && ++node < fine_.node_count()) {
        next_block = fine_.diagonal[at(node)];
        row_end = fine_.row_begin[at(node) + 1];
      }
      const auto [i, first, blocks, slots] = piece;
      if (i != node || node >= fine_.node_count() || first != next_block || blocks < 1 ||
          blocks > row_end - first || slots < 1 || slots > 256)
        return invalid("a piece of the plan is not the one expected in row " + std::to_string(node));
      if (at(blocks) > stored_.slots.size() - slot || at(slots) > stored_.targets.size() - target)
        return invalid("the lists of the plan are too short");
      if (!follows(piece, slot, target))
        return invalid("a slot or target of row " + std::to_string(node) + " leads elsewhere");
      plan_.products.pieces_.push_back(
          {i, first, static_cast<std::uint16_t>(blocks), static_cast<std::uint16_t>(slots)});
      next_block += blocks;
      slot += at(blocks);
      target += at(slots);
    }
    if (node != fine_.node_count() - 1 || next_block != row_end || slot != stored_.slots.size() ||
        target != stored_.targets.size())
      return invalid("the plan does not cover the matrix");
    copy_lists();
    return {};
  }

  /// Targets lead from the coarse rows of the fine node to one column a slot, which all blocks that use
  /// the slot have.
  bool follows(const std::array<Index, 4>& piece, std::size_t slot, std::size_t target) const {
    const BlockPattern& pattern = plan_.pattern;
    const auto [i, first, blocks, slots] = piece;
    std::array<Index, 256> column;
    for (std::size_t s = 0; s < at(slots); ++s)
      for (std::size_t w = 0; w < width; ++w) {
        const Index place = stored_.targets[target + s][w];
        const std::size_t a = at(column_[at(i) * width + w]);
        if (place < pattern.row_begin[a] || place >= pattern.row_begin[a + 1]) return false;
        if (w == 0) column[s] = pattern.column[at(place)];
        if (pattern.column[at(place)] != column[s]) return false;
      }
    for (std::size_t k = 0; k < at(blocks); ++k)
      for (std::size_t w = 0; w < width; ++w) {
        const std::size_t s = stored_.slots[slot + k][w];
        if (s >= at(slots) || column[s] != column_[at(fine_.column[at(first) + k]) * width + w])
          return false;
      }
    return true;
  }

  void copy_lists() {
    plan_.products.slot_.resize(stored_.slots.size() * width);
    std::memcpy(plan_.products.slot_.data(), stored_.slots.data(), plan_.products.slot_.size());
    plan_.products.target_.resize(stored_.targets.size() * width);
    std::memcpy(plan_.products.target_.data(), stored_.targets.data(),
                plan_.products.target_.size() * sizeof(Index));
  }

  Status fix(std::span<const Index> fixed) {
    for (const Index node : fixed) {
      if (node < 0 || node >= fine_.node_count())
        return make_issue(
            IssueCode::asset_index_out_of_range,
            "fixed node " + std::to_string(node) + " of " + std::to_string(fine_.node_count()));
      std::fill_n(plan_.products.weight_.begin() + std::ptrdiff_t(width) * node, width, 0.0F);
    }
    return {};
  }

  void find_lone() {
    std::vector<bool> used(at(coarse_count_), false);
    for (std::size_t k = 0; k < column_.size(); ++k)
      if (plan_.products.weight_[k] != 0) used[at(column_[k])] = true;
    for (Index a = 0; a < coarse_count_; ++a)
      if (!used[at(a)]) plan_.lone.push_back(a);
  }

  const BlockPattern& fine_;
  const LevelTransition& stored_;
  const Index coarse_count_;
  std::vector<Index> column_;  ///< of P, `width` a row
  RowProductsPlan plan_;
};

Result<RowProductsPlan> open_row_products(const BlockPattern& fine, const LevelTransition& stored,
                                          std::span<const Index> fixed) {
  return RowProductsOpener(fine, stored).open(fixed);
}

}  // namespace souple
