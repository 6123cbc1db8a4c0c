// SPDX-License-Identifier: GPL-3.0-or-later
// The scaling S = blockdiag(L_a) of a compliance that makes one quantisation step fair to all nodes in
// the norm that is asked for.
#pragma once
#include <Eigen/Core>
#include <array>
#include <vector>

#include "formats/core/result.hpp"
#include "tools/compliance/hierarchical_encoder.hpp"
#include "tools/compliance/worker_pool.hpp"

namespace souple {

/// L_a as a lower triangular matrix.
template <class Scalar>
Eigen::Matrix<Scalar, 3, 3> scale_matrix(const std::array<float, 6>& l) {
  Eigen::Matrix<Scalar, 3, 3> m;
  m << Scalar(l[0]), 0, 0, Scalar(l[1]), Scalar(l[2]), 0, Scalar(l[3]), Scalar(l[4]), Scalar(l[5]);
  return m;
}

/// L_a with coarse mantissas, as it is stored.
std::array<float, 6> rounded_scale(const Eigen::Matrix3d& l);

struct NodeScaling {
  std::vector<std::array<float, 6>> scale;  ///< [n] by row
  /// Root mean square error of the scaled entries at which the tolerance is about reached.
  float entry_error = 0;
};

/// scaled_spectral: the Cholesky factors of the diagonal blocks; frobenius: one constant; worst_column:
/// the column norms, the largest cut off. Issue compliance_factorisation_failed: a diagonal block is
/// not positive definite.
Result<NodeScaling> node_scaling(const SymmetricSource& source, const EncodeOptions& options,
                                 WorkerPool& pool);

/// sqrt(sum_i C_ij^2) of every column j.
Eigen::VectorXd column_norms(const SymmetricSource& source, WorkerPool& pool);

}  // namespace souple
