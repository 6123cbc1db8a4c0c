// SPDX-License-Identifier: MIT
#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "runtime/fem/block_matrix.hpp"
#include "runtime/multigrid/prolongation.hpp"

namespace souple {

class RowProductsBuilder;
class RowProductsOpener;
class FusedTerms;

/// T + T^T, T = P^T (U + D/2) P (see GalerkinPlan), by fine row: a row of (U + D/2) P lives in a few
/// slots of the first-level cache and is added to the coarse rows that the fine node hangs on as soon
/// as it is complete. A is read in storage order.
class RowProducts {
 public:
  void replay(const BlockMatrixF& fine, BlockMatrixF& coarse) const;
  std::size_t bytes() const;
  double flops() const;
  /// Pieces, slots and targets.
  void store(LevelTransition& stored) const;

 private:
  friend class RowProductsBuilder;
  friend class RowProductsOpener;
  friend class FusedTerms;

  static constexpr std::size_t width = most_prolongation_weights;
  static_assert(width == LevelTransition::width);

  /// Consecutive blocks of a fine row, few enough for their columns of P to fit the slots.
  struct Piece {
    Index node;   ///< fine row
    Index first;  ///< position of the first block
    std::uint16_t block_count;
    std::uint16_t slot_count;
  };

  void accumulate(const BlockMatrixF& fine, float* coarse) const;
  void add_transpose(const BlockPattern& pattern, float* coarse) const;
  static std::vector<Index> mirror_of(const BlockPattern& pattern);

  std::vector<float> weight_;  ///< P, `width` for every fine node; rows are filled with zeros
  std::vector<Piece> pieces_;
  std::vector<std::uint8_t> slot_;  ///< of every block of a piece and every weight of its column
  std::vector<Index> target_;  ///< of every slot of a piece and every weight of its node: coarse block
  std::vector<Index> mirror_;  ///< of every coarse block on or right of the diagonal: its transpose
};

/// The products, and on the way the coarse pattern and the coarse nodes that nothing hangs on. Takes
/// time proportional to the lists.
struct RowProductsPlan {
  RowProducts products;
  BlockPattern pattern;
  std::vector<Index> lone;
};
RowProductsPlan plan_row_products(const BlockPattern& fine, const Prolongation& p);
/// See GalerkinPlan::open.
Result<RowProductsPlan> open_row_products(const BlockPattern& fine, const LevelTransition& stored,
                                          std::span<const Index> fixed);

}  // namespace souple
