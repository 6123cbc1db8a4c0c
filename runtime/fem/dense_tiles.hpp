// SPDX-License-Identifier: MIT
// Dense Cholesky by tiles so small that Eigen's products keep their buffers on the stack: nothing is
// allocated at any size. Column-major, lower triangles.
#pragma once
#include <Eigen/Core>

namespace souple {

using DenseView = Eigen::Map<Eigen::MatrixXd, 0, Eigen::OuterStride<>>;

/// The first `columns` columns of a symmetric matrix of `panel.rows()` become those of its factor.
/// False if the leading block is not positive definite.
bool factorize_panel(DenseView panel);
/// Lower triangle of `update` -= X X^T.
void subtract_square(const DenseView& x, DenseView update);

}  // namespace souple
