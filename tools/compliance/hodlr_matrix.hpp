// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <Eigen/Core>
#include <array>
#include <vector>

#include "formats/core/hierarchical_compliance.hpp"

namespace souple {

/// C~_IJ = left diag(singular) right^T; columns orthonormal, singular values descending.
struct LowRankBlock {
  Eigen::MatrixXf left;      ///< 3 |I| x rank
  Eigen::VectorXf singular;  ///< rank
  Eigen::MatrixXf right;     ///< 3 |J| x rank
};

/// A symmetric matrix over n nodes in HODLR form, before quantisation, scaled: C = S C~ S^T with
/// S = blockdiag(L_a). Blocks and leaves follow HierarchicalIndex.
struct HodlrMatrix {
  int depth = 0;
  std::vector<Index> order;                 ///< [n] row of the compliance at every position
  std::vector<std::array<float, 6>> scale;  ///< [n] by row
  std::vector<LowRankBlock> blocks;         ///< [2^depth - 1], heap order
  std::vector<Eigen::MatrixXf> leaves;      ///< [2^depth], 3 |leaf| squared, symmetric
};

}  // namespace souple
