// SPDX-License-Identifier: MIT
#pragma once
#include <span>
#include <vector>

#include "runtime/fem/front_plan.hpp"

namespace souple {

/// Rows and columns of A^-1 = L^-T L^-1 at some nodes, in Gram form: Y = L^-1 E with the unit columns E
/// of these nodes, and the block is Y^T Y; no backward substitution. In the order of the elimination
/// the nodes of a subtree are neighbours, and a front has something to do only for the columns of its
/// own subtree. Twelve columns, four nodes, are a tile; of a tile only the rows of fronts that see any
/// of its columns are kept. In double.
class InverseBlockWork {
 public:
  /// `panels`: of the factor. `places`: in the order of the plan, by node. `chosen`: nodes, one for
  /// each three rows and columns of `block`, which is row-major and symmetric to the bit. The bits of
  /// an entry depend on the set of the nodes alone; they may repeat. Allocates where it was never used
  /// for as much before.
  void evaluate(const FrontPlan& plan, const double* panels, std::span<const Index> places,
                std::span<const Index> chosen, std::span<double> block);

 private:
  struct Column {
    Index place, slot;  ///< slot: among the nodes asked for
  };
  struct TileRange {
    Index begin = 0, end = 0;
  };
  /// The rows of one front in one tile.
  struct Segment {
    Index front;
    std::size_t begin;  ///< in values_
    std::size_t depth;  ///< rows
  };

  std::size_t tile_count() const { return segment_begin_.size() - 1; }
  void number_columns(std::span<const Index> places, std::span<const Index> chosen);
  void lay_out(const FrontPlan& plan);
  void set_units(const FrontPlan& plan);
  void forward(const FrontPlan& plan, std::size_t index, const double* panel);
  void find_targets(const FrontPlan& plan, const FrontPlan::Front& front, const Segment* segment);
  void multiply(std::span<double> block);
  void multiply_tiles(std::size_t s, std::size_t t, std::span<double> block);
  void store_tile(const double* product, std::size_t s, std::size_t t, std::span<double> block) const;
  void copy_repeated(std::span<double> block) const;

  std::vector<Column> columns_;             ///< nodes, by place, each once
  std::vector<Column> repeated_;            ///< as place: the slot that it repeats
  std::vector<TileRange> ranges_;           ///< by front
  std::vector<std::size_t> segment_begin_;  ///< by tile, in segments_
  std::vector<Segment> segments_;           ///< of a tile: ascending fronts
  std::vector<std::size_t> next_;           ///< by tile: the segment to be filled next
  std::vector<std::size_t> targets_;        ///< in values_, by row of the border of the front in work
  std::vector<double> reciprocals_;         ///< of the diagonal of the front in work
  Eigen::VectorXd values_;                  ///< Y
  std::size_t size_ = 0;                    ///< scalars, of the block's rows
};

}  // namespace souple
