// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <Eigen/Core>
#include <functional>

namespace souple {

/// y = A x on a block of vectors, A symmetric.
using BlockProduct = std::function<void(const Eigen::MatrixXd& x, Eigen::MatrixXd& y)>;

struct EigenvalueRange {
  double smallest = 0, largest = 0;
};

/// The extreme eigenvalues of A, size x size, by `steps` steps of block Lanczos from a fixed random
/// start, fully reorthogonalised. They lie inside the true range; for the dense edge of a random
/// matrix, the hard case, by a share of about 5 / steps^2 of the range.
EigenvalueRange extreme_eigenvalues(const BlockProduct& product, Eigen::Index size,
                                    Eigen::Index block_columns, int steps);

}  // namespace souple
