// SPDX-License-Identifier: MIT
// The solvers of the bodies of a world, and what they share. Internal to the world.
#pragma once
#include <memory>
#include <vector>

#include "runtime/solve/solver_parts.hpp"
#include "runtime/world/bodies.hpp"

namespace souple {

/// Instances of one asset with the same fixed nodes share what their solvers are made of.
class SolverShare {
 public:
  /// Gives the body its solver: the one that was asked for, or the default of its asset.
  /// Issue solver_not_possible.
  Status prepare(SoftBody& body, const WorldSettings& settings);

 private:
  struct Group {
    std::shared_ptr<const SoftBodyAsset> asset;
    std::vector<Index> free_nodes;
    SolverParts parts;
  };
  Group& group_of(const SoftBody& body);

  std::vector<std::unique_ptr<Group>> groups_;
};

}  // namespace souple
