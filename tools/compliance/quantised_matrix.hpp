// SPDX-License-Identifier: GPL-3.0-or-later
// A HODLR matrix in integers: what a HierarchicalIndex and its records say, before they are coded.
#pragma once
#include <Eigen/Core>
#include <cstddef>
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

struct QuantisedBlock {
  Eigen::MatrixXi left, right;  ///< a_k and b_k of HierarchicalIndex; no term is all zero
  Eigen::VectorXf singular;
  float step = 0;
};

struct QuantisedMatrix {
  std::vector<QuantisedBlock> blocks;
  std::vector<Eigen::MatrixXi> leaves;
  std::vector<float> leaf_step;
};

/// Nothing if an integer would exceed what a record can hold.
std::optional<QuantisedMatrix> quantise(const HodlrMatrix& matrix, const StepShares& shares,
                                        double factor, WorkerPool& pool);

/// Index and payload.
EncodedCompliance encode_records(const HodlrMatrix& matrix, const QuantisedMatrix& quantised,
                                 WorkerPool& pool);

}  // namespace souple
