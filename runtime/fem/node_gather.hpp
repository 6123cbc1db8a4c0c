// SPDX-License-Identifier: MIT
#pragma once
#include <span>
#include <vector>

#include "runtime/fem/element_lanes.hpp"

namespace souple {

/// From tets to nodes: every node gathers what its incident tets computed, in their order. Ranges of
/// nodes are independent.
class NodeGather {
 public:
  NodeGather() = default;
  NodeGather(Index node_count, std::span<const Tet> tets);

  Index node_count() const { return static_cast<Index>(begin_.size()) - 1; }
  IndexRange all_nodes() const { return {0, node_count()}; }
  std::size_t bytes() const { return (begin_.size() + corners_.size()) * sizeof(Index); }

  /// sums (3n) += the vectors of the node's corners.
  void add_corners(std::span<const CornerVector> corners, IndexRange nodes, double* sums) const;
  /// Mean of the incident rotations weighted by the volumes of the tets, projected onto SO(3)
  /// (METHOD 4.1).
  void mean_rotations(std::span<const Mat3> tet_rotations, std::span<const double> volumes,
                      IndexRange nodes, Mat3* out) const;

 private:
  Mat3 weighted_sum(std::span<const Mat3> tet_rotations, std::span<const double> volumes,
                    Index node) const;

  std::vector<Index> begin_;    ///< node_count + 1
  std::vector<Index> corners_;  ///< 4 tet + corner, ascending
};

}  // namespace souple
