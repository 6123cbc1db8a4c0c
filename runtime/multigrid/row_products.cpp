// SPDX-License-Identifier: MIT
#include "runtime/multigrid/row_products.hpp"

#include <algorithm>
#include <array>
#include <cstring>
#include <span>
#include <utility>

#include "runtime/multigrid/block_kernel.hpp"

namespace souple {
namespace {

using block_kernel::Block;

constexpr std::size_t slot_floats = 16;  // of a block, on a cache line of its own
constexpr std::size_t slot_limit = 256;

std::size_t at(Index i) { return static_cast<std::size_t>(i); }

inline void add_to(float* sum, float weight, const Block& b) {
  block_kernel::store(sum, block_kernel::add(block_kernel::load(sum), weight, b));
}

}  // namespace

void RowProducts::accumulate(const BlockMatrixF& fine, float* coarse) const {
  alignas(64) std::array<float, slot_limit * slot_floats> slots;
  const BlockPattern& pattern = *fine.pattern;
  const std::uint8_t* slot = slot_.data();
  const Index* target = target_.data();
  for (const Piece& piece : pieces_) {
    for (std::size_t s = 0; s < piece.slot_count; ++s)
      block_kernel::store(&slots[slot_floats * s], block_kernel::zero());
    const std::size_t last = at(piece.first) + piece.block_count;
    for (std::size_t k = at(piece.first); k < last; ++k, slot += width) {
      Block a = block_kernel::load(fine.values.data() + block_kernel::floats * k);
      if (k == at(pattern.diagonal[at(piece.node)])) a = block_kernel::scaled(0.5F, a);
      const float* const weight = weight_.data() + width * at(pattern.column[k]);
      for (std::size_t w = 0; w < width; ++w) add_to(&slots[slot_floats * slot[w]], weight[w], a);
    }
    const float* const weight = weight_.data() + width * at(piece.node);
    for (std::size_t s = 0; s < piece.slot_count; ++s, target += width) {
      const Block sum = block_kernel::load(&slots[slot_floats * s]);
      for (std::size_t w = 0; w < width; ++w)
        add_to(coarse + block_kernel::floats * at(target[w]), weight[w], sum);
    }
  }
}

/// T becomes T + T^T.
void RowProducts::add_transpose(const BlockPattern& pattern, float* coarse) const {
  const Index* mirror = mirror_.data();
  for (std::size_t row = 0; row < pattern.diagonal.size(); ++row)
    for (std::size_t k = at(pattern.diagonal[row]); k < at(pattern.row_begin[row + 1]); ++k) {
      float* const upper = coarse + block_kernel::floats * k;
      float* const lower = coarse + block_kernel::floats * at(*mirror++);
      block_kernel::store_symmetric(upper, lower, upper, lower);
    }
}

std::vector<Index> RowProducts::mirror_of(const BlockPattern& pattern) {
  std::vector<Index> mirror;
  mirror.reserve((pattern.block_count() + pattern.diagonal.size()) / 2);
  std::vector<Index> left(pattern.row_begin.begin(), pattern.row_begin.end() - 1);
  // Rows ascend, so that the transposes in every row do.
  for (std::size_t a = 0; a < pattern.diagonal.size(); ++a)
    for (Index k = pattern.diagonal[a]; k < pattern.row_begin[a + 1]; ++k)
      mirror.push_back(left[at(pattern.column[at(k)])]++);
  return mirror;
}

void RowProducts::store(LevelTransition& stored) const {
  for (const Piece& piece : pieces_)
    stored.pieces.push_back({piece.node, piece.first, piece.block_count, piece.slot_count});
  stored.slots.resize(slot_.size() / width);
  std::memcpy(stored.slots.data(), slot_.data(), slot_.size());
  stored.targets.resize(target_.size() / width);
  std::memcpy(stored.targets.data(), target_.data(), target_.size() * sizeof(Index));
}

void RowProducts::replay(const BlockMatrixF& fine, BlockMatrixF& coarse) const {
  std::ranges::fill(coarse.values, 0.0F);
  accumulate(fine, coarse.values.data());
  add_transpose(*coarse.pattern, coarse.values.data());
}

std::size_t RowProducts::bytes() const {
  return weight_.size() * sizeof(float) + pieces_.size() * sizeof(Piece) + slot_.size() +
         (target_.size() + mirror_.size()) * sizeof(Index);
}

double RowProducts::flops() const {
  return double(block_kernel::floats) *
         (2.0 * double(slot_.size() + target_.size()) + double(mirror_.size()));
}

/// Makes the lists in time proportional to their length: no searching, no sorting but of coarse rows.
class RowProductsBuilder {
 public:
  RowProductsBuilder(const BlockPattern& fine, const Prolongation& p) : fine_(fine), p_(p) {
    pad_rows();
    for (Index i = 0; i < p.fine_count(); ++i)
      if (!row(i).empty()) append_pieces(i);
    transpose_pieces();
    build_pattern();
    fill_targets();
    plan_.products.mirror_ = RowProducts::mirror_of(plan_.pattern);
  }
  RowProductsPlan take() { return std::move(plan_); }

 private:
  static constexpr std::size_t width = RowProducts::width;

  std::span<const Index> row(Index i) const {
    return std::span(p_.column).subspan(at(p_.row_begin[at(i)]),
                                        at(p_.row_begin[at(i) + 1] - p_.row_begin[at(i)]));
  }

  /// Every row of P at the same width: what is missing repeats the first column with weight 0.
  void pad_rows() {
    const std::size_t n = at(p_.fine_count());
    plan_.products.weight_.assign(n * width, 0);
    column_.assign(n * width, 0);
    for (std::size_t i = 0; i < n; ++i) {
      const auto columns = row(Index(i));
      if (columns.empty()) continue;
      for (std::size_t w = 0; w < width; ++w)
        column_[i * width + w] = w < columns.size() ? columns[w] : columns[0];
      for (std::size_t w = 0; w < columns.size(); ++w)
        plan_.products.weight_[i * width + w] = float(p_.weight[at(p_.row_begin[i]) + w]);
    }
  }

  void append_pieces(Index i) {
    const std::size_t most_blocks = slot_limit / width;
    const auto last = at(fine_.row_begin[at(i) + 1]);
    for (std::size_t first = at(fine_.diagonal[at(i)]); first < last; first += most_blocks)
      append_piece(i, first, std::min(most_blocks, last - first));
  }

  /// Slots in the order of first use. Columns of nodes that do not move share slot 0, with weight 0.
  void append_piece(Index i, std::size_t first, std::size_t count) {
    slot_of_.resize(at(p_.coarse_count), -1);
    const std::size_t begin = slot_column_.size();
    const std::size_t old_size = plan_.products.slot_.size();
    for (std::size_t k = first; k < first + count; ++k) {
      const Index j = fine_.column[k];
      const bool moves = !row(j).empty();
      for (std::size_t w = 0; w < width; ++w) {
        if (!moves) {
          plan_.products.slot_.push_back(0);
          continue;
        }
        Index& slot = slot_of_[at(column_[at(j) * width + w])];
        if (slot < 0) {
          slot = Index(slot_column_.size() - begin);
          slot_column_.push_back(column_[at(j) * width + w]);
        }
        plan_.products.slot_.push_back(static_cast<std::uint8_t>(slot));
      }
    }
    for (std::size_t s = begin; s < slot_column_.size(); ++s) slot_of_[at(slot_column_[s])] = -1;
    if (slot_column_.size() == begin) return plan_.products.slot_.resize(old_size);
    plan_.products.pieces_.push_back({i, Index(first), static_cast<std::uint16_t>(count),
                                      static_cast<std::uint16_t>(slot_column_.size() - begin)});
    slot_begin_.push_back(slot_column_.size());
  }

  /// By coarse node: the pieces whose fine node hangs on it, and by which of its weights.
  void transpose_pieces() {
    use_begin_.assign(at(p_.coarse_count) + 1, 0);
    for (const auto& piece : plan_.products.pieces_)
      for (std::size_t w = 0; w < width; ++w) ++use_begin_[at(column_[at(piece.node) * width + w]) + 1];
    for (std::size_t a = 1; a < use_begin_.size(); ++a) use_begin_[a] += use_begin_[a - 1];
    uses_.resize(use_begin_.back());
    std::vector<std::size_t> next(use_begin_.begin(), use_begin_.end() - 1);
    for (std::size_t piece = 0; piece < plan_.products.pieces_.size(); ++piece)
      for (std::size_t w = 0; w < width; ++w)
        uses_[next[at(column_[at(plan_.products.pieces_[piece].node) * width + w])]++] = {piece, w};
  }

  /// Calls f(piece, weight, slot, column) for everything that is added to coarse row a.
  template <class Function>
  void for_row(Index a, const Function& f) const {
    for (std::size_t u = use_begin_[at(a)]; u < use_begin_[at(a) + 1]; ++u)
      for (std::size_t s = slot_begin_[uses_[u].piece]; s < slot_begin_[uses_[u].piece + 1]; ++s)
        f(uses_[u].weight, s, slot_column_[s]);
  }

  /// The pattern of T and its transpose, with the diagonal.
  void build_pattern() {
    const std::size_t n = at(p_.coarse_count);
    std::vector<std::vector<Index>> rows(n);
    std::vector<Index> seen(n, -1);
    for (Index a = 0; a < p_.coarse_count; ++a) {
      if (use_begin_[at(a)] == use_begin_[at(a) + 1]) plan_.lone.push_back(a);
      seen[at(a)] = a;
      rows[at(a)].push_back(a);
      for_row(a, [&](std::size_t, std::size_t, Index b) {
        if (seen[at(b)] == a) return;
        seen[at(b)] = a;
        rows[at(a)].push_back(b);
      });
    }
    std::vector<std::size_t> own(n);
    for (std::size_t a = 0; a < n; ++a) own[a] = rows[a].size();
    for (std::size_t a = 0; a < n; ++a)
      for (std::size_t k = 0; k < own[a]; ++k) rows[at(rows[a][k])].push_back(Index(a));
    BlockPattern& pattern = plan_.pattern;
    pattern.row_begin.push_back(0);
    for (std::size_t a = 0; a < n; ++a) {
      std::ranges::sort(rows[a]);
      rows[a].erase(std::unique(rows[a].begin(), rows[a].end()), rows[a].end());
      const auto diagonal = std::ranges::lower_bound(rows[a], Index(a)) - rows[a].begin();
      pattern.diagonal.push_back(static_cast<Index>(pattern.column.size()) + Index(diagonal));
      pattern.column.insert(pattern.column.end(), rows[a].begin(), rows[a].end());
      pattern.row_begin.push_back(static_cast<Index>(pattern.column.size()));
    }
  }

  void fill_targets() {
    plan_.products.target_.resize(slot_column_.size() * width);
    std::vector<Index> place(at(p_.coarse_count));
    for (Index a = 0; a < p_.coarse_count; ++a) {
      for (Index k = plan_.pattern.row_begin[at(a)]; k < plan_.pattern.row_begin[at(a) + 1]; ++k)
        place[at(plan_.pattern.column[at(k)])] = k;
      for_row(a, [&](std::size_t weight, std::size_t slot, Index b) {
        plan_.products.target_[slot * width + weight] = place[at(b)];
      });
    }
  }

  struct Use {
    std::size_t piece, weight;
  };

  const BlockPattern& fine_;
  const Prolongation& p_;
  RowProductsPlan plan_;
  std::vector<Index> column_;               ///< of P, at the plan's width
  std::vector<Index> slot_of_;              ///< of every coarse node; -1: none in this piece
  std::vector<std::size_t> slot_begin_{0};  ///< by piece
  std::vector<Index> slot_column_;          ///< coarse node of every slot of every piece
  std::vector<std::size_t> use_begin_;      ///< by coarse node
  std::vector<Use> uses_;
};

RowProductsPlan plan_row_products(const BlockPattern& fine, const Prolongation& p) {
  return RowProductsBuilder(fine, p).take();
}

}  // namespace souple
