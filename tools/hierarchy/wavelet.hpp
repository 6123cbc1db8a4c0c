// SPDX-License-Identifier: GPL-3.0-or-later
// The wavelets of red refinement (METHOD 3.3): lifting with a linear prediction.
#pragma once
#include <array>
#include <span>
#include <vector>

#include "formats/core/mesh.hpp"
#include "formats/core/result.hpp"

namespace souple {

/// One row a node of the fine level: {i, i} keeps coarse node i, {a, b} is the midpoint of edge (a, b).
using ParentRows = std::vector<std::array<Index, 2>>;

/// Lifting transform of nodal values on nested levels. Values are stored node by node, `components`
/// each, in place: after `forward` the coarse nodes hold the coarsest values and every midpoint holds
/// its detail gamma = value - (value_a + value_b) / 2. `inverse` undoes it to the last bit where the
/// arithmetic is exact and to rounding otherwise; without details it is the nested prolongation.
class NestedWavelet {
 public:
  /// `levels`: parents of every level above the coarsest, coarsest first. Issue
  /// asset_hierarchy_invalid: rows that are not as above.
  static Result<NestedWavelet> make(std::vector<ParentRows> levels, std::size_t coarse_node_count);

  void forward(std::span<double> values, std::size_t components) const;
  void inverse(std::span<double> values, std::size_t components) const;
  std::size_t node_count() const;

 private:
  NestedWavelet() = default;
  struct Midpoint {
    std::size_t node, a, b;  ///< numbers on the finest level
  };
  std::vector<std::vector<Midpoint>> levels_;  ///< coarsest first
  std::size_t node_count_ = 0;
};

}  // namespace souple
