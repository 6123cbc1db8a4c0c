// SPDX-License-Identifier: MIT
#pragma once
#include <cstddef>
#include <span>
#include <variant>
#include <vector>

#include "runtime/fem/block_matrix.hpp"
#include "runtime/multigrid/fused_terms.hpp"
#include "runtime/multigrid/prolongation.hpp"
#include "runtime/multigrid/row_products.hpp"

namespace souple {

/// The product P^T A P for patterns that are known in advance (METHOD 3.1, Alg. 6-9), with all
/// searching done beforehand: replayed at every step, as the rotations change A.
///
/// With A = U + D + U^T (blocks right of, on and left of the diagonal), P^T A P = T + T^T where
/// T = P^T (U + D/2) P: only half of A is read. Where P has up to two weights a row (nested levels
/// whose midpoints stay), the two products of the thesis are fused: every coarse block has one list of
/// weighted fine blocks (FusedTerms). Where it has up to four, the lists would be four times as long,
/// and the products are interleaved by fine row instead (RowProducts).
class GalerkinPlan {
 public:
  /// Coarse nodes that no fine node hangs on get an identity block on the diagonal. The pattern of
  /// `fine` is symmetric; rows of `p` have most_prolongation_weights at most.
  static GalerkinPlan create(const BlockPattern& fine, const Prolongation& p);
  /// The same from a plan that was stored, for a body whose nodes `fixed` do not move (rows of P
  /// without entries; the coarse pattern stays that of the free body). Nothing of `stored` is believed:
  /// issue asset_multigrid_invalid if it is not the plan of prolongation_of(stored) on `fine`.
  static Result<GalerkinPlan> open(const BlockPattern& fine, const LevelTransition& stored,
                                   std::span<const Index> fixed);

  const BlockPattern& coarse_pattern() const { return pattern_; }
  /// Coarse nodes that no moving fine node hangs on, ascending.
  std::span<const Index> lone_nodes() const { return lone_; }
  /// Fills `coarse` (on coarse_pattern()) in an order that does not change from run to run; allocates
  /// nothing. `fine` is on the pattern of create() and symmetric: only its blocks on and right of the
  /// diagonal are read. `coarse` is symmetric to the bit.
  void replay(const BlockMatrixF& fine, BlockMatrixF& coarse) const;
  /// Of the plan, without the coarse pattern.
  std::size_t bytes() const;
  /// Multiplications and additions of one replay.
  double flops() const;

 private:
  static GalerkinPlan choose(const BlockPattern& fine, const Prolongation& p, RowProductsPlan rows);

  BlockPattern pattern_;
  std::vector<Index> lone_;  ///< coarse nodes without fine ones
  std::variant<FusedTerms, RowProducts> products_;
};

}  // namespace souple
