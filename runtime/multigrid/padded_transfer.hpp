// SPDX-License-Identifier: MIT
#pragma once
#include <vector>

#include "runtime/multigrid/prolongation.hpp"

namespace souple {

/// Four floats a node: x, y, z and one that pads, so that a node is one aligned load. What stands in
/// the fourth place of a residual means nothing; in that of a motion it is 0.
using PaddedVector = std::vector<float>;

/// A prolongation with single-precision weights, on padded vectors.
class PaddedTransfer {
 public:
  explicit PaddedTransfer(const Prolongation& p);

  /// coarse = P^T fine, summed in the order of the fine nodes.
  void restrict_to(const PaddedVector& fine, PaddedVector& coarse) const;
  /// fine += P coarse.
  void add_prolonged(const PaddedVector& coarse, PaddedVector& fine) const;

  /// Whether the fine node hangs on anything: fixed ones do not.
  bool holds(std::size_t fine_node) const { return row_begin_[fine_node] < row_begin_[fine_node + 1]; }
  std::size_t bytes() const;

 private:
  std::vector<Index> row_begin_, column_;
  std::vector<float> weight_;
};

}  // namespace souple
