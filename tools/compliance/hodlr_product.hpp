// SPDX-License-Identifier: GPL-3.0-or-later
// The blocks of a HODLR matrix in double, rows in cluster order: for matrices that are small enough to
// be held once more.
#pragma once
#include <Eigen/Core>
#include <vector>

#include "tools/compliance/hodlr_matrix.hpp"
#include "tools/compliance/quantised_matrix.hpp"

namespace souple {

/// S C~ S^T as factors that carry S: block = left right^T.
struct ScaledHodlr {
  struct Block {
    Eigen::MatrixXd left, right;
  };
  Index node_count = 0;
  int depth = 0;
  std::vector<Block> blocks;            ///< heap order
  std::vector<Eigen::MatrixXd> leaves;  ///< symmetric
};

/// Of the integers: what a reader decodes, before the shift.
ScaledHodlr scaled_hodlr(const HodlrMatrix& matrix, const QuantisedMatrix& quantised, WorkerPool& pool);

/// C~ itself, without S.
ScaledHodlr plain_hodlr(const HodlrMatrix& matrix, const QuantisedMatrix& quantised);

/// L_a of every position as 3x3 matrices.
std::vector<Eigen::Matrix3d> ordered_scales(const HodlrMatrix& matrix);

}  // namespace souple
