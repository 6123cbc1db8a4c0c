// SPDX-License-Identifier: GPL-3.0-or-later
// BLAS and LAPACK in single precision, on the calling thread alone: the callers are parallel
// themselves.
#pragma once
#include <Eigen/Core>
#include <cstddef>
#include <functional>

namespace souple {

using FloatView = Eigen::Map<const Eigen::MatrixXf, 0, Eigen::OuterStride<>>;
using FloatSpan = Eigen::Map<Eigen::MatrixXf, 0, Eigen::OuterStride<>>;
using FloatRef = Eigen::Ref<Eigen::MatrixXf, 0, Eigen::OuterStride<>>;
using ConstFloatRef = Eigen::Ref<const Eigen::MatrixXf, 0, Eigen::OuterStride<>>;

/// Ends OpenBLAS's own threads: under contention they make small work many times slower, and sums
/// would depend on their count.
void use_one_blas_thread();

/// c += factor a b.
void add_product(float factor, const ConstFloatRef& a, const ConstFloatRef& b, FloatRef c);
/// c += factor a^T b.
void add_transposed_product(float factor, const ConstFloatRef& a, const ConstFloatRef& b, FloatRef c);
/// c += factor a b^T.
void add_product_transposed(float factor, const ConstFloatRef& a, const ConstFloatRef& b, FloatRef c);

/// x := x L^-1 or x L^-T, L the lower triangle of `lower`.
void solve_right(const ConstFloatRef& lower, bool transposed, FloatRef x);

/// The inverse of L L^T, full; false if L is singular.
bool inverse_of_cholesky(FloatRef lower);

/// a = q r, rows >= columns; a becomes q with orthonormal columns, r upper triangular.
bool orthonormalise(FloatRef a, Eigen::MatrixXf& r);

/// Runs `count` independent pieces of work, in any order or at once.
using PieceRunner =
    std::function<void(std::size_t count, const std::function<void(std::size_t)>& piece)>;

/// The same with sums and factors in double (Cholesky QR, shifted and repeated: Fukaya et al. 2020),
/// for columns whose sizes differ by more than single precision resolves. Condition numbers up to 1e7
/// or so.
bool orthonormalise_in_double(FloatRef a, Eigen::MatrixXd& r, const PieceRunner& run);

struct SmallSvd {
  Eigen::MatrixXd left, right;  ///< a = left diag(singular) right^T
  Eigen::VectorXd singular;     ///< descending
  bool converged = false;
};
SmallSvd singular_values(Eigen::MatrixXd a);

/// The largest singular value of a matrix with few columns, in double.
double spectral_norm(const ConstFloatRef& a);

}  // namespace souple
