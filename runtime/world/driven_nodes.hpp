// SPDX-License-Identifier: MIT
// Dirichlet nodes that move. Internal to the world.
#pragma once
#include <span>
#include <vector>

#include "formats/core/result.hpp"
#include "runtime/fem/linear_algebra.hpp"
#include "runtime/world/settings.hpp"

namespace souple {

class SoftBodyAsset;

struct DrivenNodes {
  std::vector<Index> nodes;
  std::vector<Keyframe> path;

  /// Writes where the nodes are at `time_s` into `x`, m.
  void place(double time_s, std::span<const Point> rest, Eigen::VectorXd& x) const;
};

/// Issue driven_nodes_invalid. `is_fixed` by node.
Result<std::vector<DrivenNodes>> find_driven_nodes(const SoftBodyDescription& description,
                                                   const SoftBodyAsset& asset,
                                                   const std::vector<char>& is_fixed);

}  // namespace souple
