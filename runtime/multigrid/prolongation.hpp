// SPDX-License-Identifier: MIT
#pragma once
#include <cstddef>
#include <span>
#include <vector>

#include "formats/core/asset.hpp"
#include "formats/core/result.hpp"
#include "runtime/fem/linear_algebra.hpp"

namespace souple {

inline constexpr std::size_t most_prolongation_weights = 4;

/// P between the nodes of two levels: scalar weights, times the 3x3 identity for motions. By fine node;
/// columns ascend in a row. A row without entries is a fine node that does not move (a fixed one).
struct Prolongation {
  Index coarse_count = 0;
  std::vector<Index> row_begin;  ///< fine_count() + 1; up to most_prolongation_weights a row
  std::vector<Index> column;     ///< coarse node of every weight
  std::vector<double> weight;

  Index fine_count() const { return static_cast<Index>(row_begin.size()) - 1; }
};

/// Of a level to the one below it: by its embedding where it has one (which carries rigid motions of
/// moved midpoints), else by its parents (weights 1, 1/2 and 1/2; METHOD 3.2). Weights below 1e-12 are
/// left out. Issues: asset_embedding_invalid, asset_index_out_of_range.
Result<Prolongation> prolongation_of(const MeshLevel& fine, const MeshLevel& coarse);
/// As stored, which is what the function above made.
Prolongation prolongation_of(const LevelTransition& stored);
/// The same without the rows of `fixed` fine nodes.
Prolongation without_rows(const Prolongation& p, std::span<const Index> fixed);

/// fine = P coarse and coarse = P^T fine; 3 entries a node.
void prolong(const Prolongation& p, const Eigen::VectorXf& coarse, Eigen::VectorXf& fine);
void restrict_to(const Prolongation& p, const Eigen::VectorXf& fine, Eigen::VectorXf& coarse);

}  // namespace souple
