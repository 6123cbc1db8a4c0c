// SPDX-License-Identifier: MIT
#pragma once
#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "formats/core/asset.hpp"
#include "formats/core/result.hpp"
#include "runtime/multigrid/galerkin_plan.hpp"
#include "runtime/multigrid/padded_transfer.hpp"

namespace souple {

/// Coarsening ends at so many nodes for a body of `node_count`: a dense factor of them costs about as
/// much as a pass over the matrix of the body.
Index coarsest_node_count(Index node_count);

/// The levels of a body and how its matrix gets from each to the next coarser one; const, shared by its
/// instances.
class MultigridHierarchy {
 public:
  struct Transition {
    PaddedTransfer transfer;
    GalerkinPlan plan;
  };

  /// `levels`: of the body, coarsest first, as far as they are larger than the coarsest level has to
  /// be; lattices follow where they do not suffice. `finest` is the pattern of the finest one's matrix;
  /// it must outlive the hierarchy. `fixed`: nodes of the finest level, ascending. Issues:
  /// asset_embedding_invalid, asset_index_out_of_range.
  static Result<MultigridHierarchy> create(std::span<const MeshLevel> levels,
                                           const BlockPattern& finest, std::span<const Index> fixed);

  /// The same from what an asset stores (see LevelTransition), coarsest first; `coarsest`: rest
  /// positions of level 0, m. `positions`: of the finest one, for lattices where nothing is stored.
  /// Nothing of it is believed. Issues: asset_multigrid_invalid, asset_index_out_of_range.
  static Result<MultigridHierarchy> open(std::span<const LevelTransition> stored,
                                         std::span<const Point> coarsest,
                                         std::span<const Point> positions, const BlockPattern& finest,
                                         std::span<const Index> fixed);

  std::size_t level_count() const { return transitions_.size() + 1; }
  /// Level 0 is the finest.
  const BlockPattern& pattern(std::size_t level) const {
    return level == 0 ? *finest_ : transitions_[level - 1]->plan.coarse_pattern();
  }
  /// Between a level and the next coarser one.
  const Transition& transition(std::size_t level) const { return *transitions_[level]; }
  std::size_t bytes() const;

 private:
  void add(const Prolongation& p, GalerkinPlan plan);
  /// Of the coarsest level so far.
  const BlockPattern& coarsest_pattern() const { return pattern(transitions_.size()); }
  std::vector<Index> nodes_at_rest() const;
  void add_lattices(std::vector<Point> positions, std::vector<Index> at_rest, Index enough);

  const BlockPattern* finest_ = nullptr;
  /// By pointer: patterns stay where they are when the hierarchy is moved.
  std::vector<std::unique_ptr<Transition>> transitions_;
};

}  // namespace souple
