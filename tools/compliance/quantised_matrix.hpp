// SPDX-License-Identifier: GPL-3.0-or-later
// A HODLR matrix in integers: what a HierarchicalIndex and its records say, before they are coded.
#pragma once
#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "tools/compliance/hierarchical_encoder.hpp"
#include "tools/compliance/worker_pool.hpp"

namespace souple {

/// Relative sizes of the quantisation steps, to be multiplied by one factor.
struct StepShares {
  Eigen::VectorXd block;  ///< [2^depth - 1]
  Eigen::VectorXd leaf;   ///< [2^depth]
};

/// Steps that reach an error with the fewest bytes. One step for all where it is a sum over entries
/// (frobenius, scaled_spectral). For worst_column those that are best for column errors relative to the
/// column norms, by the model that a coefficient's error is uniform and independent.
/// `column_norms`: of C, in cluster order.
StepShares step_shares(const HodlrMatrix& matrix, const Eigen::VectorXd& column_norms, ErrorNorm norm);

/// How a low-rank block is rounded. Its integers, a_k and b_k of HierarchicalIndex, follow from the
/// block: together they would take as much memory as all blocks.
struct QuantisedBlock {
  std::vector<Eigen::Index> kept;    ///< terms of the block; none is all zero
  std::vector<std::uint8_t> planes;  ///< bytes that hold a term's integers
  float step = 0;
};

struct QuantisedMatrix {
  std::vector<QuantisedBlock> blocks;
  std::vector<float> leaf_step;
};

/// Rows [first, first + count) of a side of `block`, left or right, in integers; count x kept.
Eigen::MatrixXi side_integers(const LowRankBlock& block, const QuantisedBlock& quantised,
                              const Eigen::MatrixXf& side, Eigen::Index first, Eigen::Index count);
Eigen::MatrixXi leaf_integers(const Eigen::MatrixXf& leaf, float step);
/// The singular values of the kept terms.
Eigen::VectorXf kept_singular(const LowRankBlock& block, const QuantisedBlock& quantised);

/// Nothing if an integer would exceed what a record can hold.
std::optional<QuantisedMatrix> quantise(const HodlrMatrix& matrix, const StepShares& shares,
                                        double factor, WorkerPool& pool);

/// Index and payload.
EncodedCompliance encode_records(const HodlrMatrix& matrix, const QuantisedMatrix& quantised,
                                 WorkerPool& pool);

}  // namespace souple
