// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/compliance/dense_kernels.hpp"

#include <cblas.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <vector>

// LAPACK's Fortran routines, which libopenblas carries.
extern "C" {
void sgeqrf_(const int* m, const int* n, float* a, const int* lda, float* tau, float* work,
             const int* lwork, int* info);
void sorgqr_(const int* m, const int* n, const int* k, float* a, const int* lda, const float* tau,
             float* work, const int* lwork, int* info);
void dgesdd_(const char* jobz, const int* m, const int* n, double* a, const int* lda, double* s,
             double* u, const int* ldu, double* vt, const int* ldvt, double* work, const int* lwork,
             int* iwork, int* info);
void dpotrf_(const char* uplo, const int* n, double* a, const int* lda, int* info);
void spotri_(const char* uplo, const int* n, float* a, const int* lda, int* info);
}

namespace souple {
namespace {

// Pieces of Gram matrices and of their factors' application: doubles of a piece stay small.
constexpr Eigen::Index gram_columns = 128, cast_rows = 512;
// Off the identity by less, a Gram matrix is that of columns one more pass makes orthonormal.
constexpr double well_conditioned = 1e-2;
// Keeps rounding errors of a Gram matrix from making it indefinite.
constexpr double gram_shift = 1e-14;
constexpr int largest_pass_count = 6;

int as_int(Eigen::Index value) { return static_cast<int>(value); }
int leading(const ConstFloatRef& a) { return as_int(std::max<Eigen::Index>(a.outerStride(), 1)); }
int leading(const FloatRef& a) { return as_int(std::max<Eigen::Index>(a.outerStride(), 1)); }

// a^T a in double.
Eigen::MatrixXd gram_of(const ConstFloatRef& a, const PieceRunner& run) {
  const Eigen::Index n = a.cols();
  Eigen::MatrixXd gram = Eigen::MatrixXd::Zero(n, n);
  run(std::size_t((n + gram_columns - 1) / gram_columns), [&](std::size_t piece) {
    const Eigen::Index begin = Eigen::Index(piece) * gram_columns;
    const Eigen::Index count = std::min(gram_columns, n - begin);
    Eigen::MatrixXd rows;
    for (Eigen::Index row = 0; row < a.rows(); row += cast_rows) {
      // Columns from `begin` on: the lower triangle of the Gram matrix.
      rows = a.block(row, begin, std::min(cast_rows, a.rows() - row), n - begin).cast<double>();
      cblas_dgemm(CblasColMajor, CblasTrans, CblasNoTrans, as_int(n - begin), as_int(count),
                  as_int(rows.rows()), 1, rows.data(), as_int(rows.rows()), rows.data(),
                  as_int(rows.rows()), 1, gram.data() + begin * n + begin, as_int(n));
    }
  });
  return gram.selfadjointView<Eigen::Lower>();
}

}  // namespace

void use_one_blas_thread() { openblas_set_num_threads(1); }

void add_product(float factor, const ConstFloatRef& a, const ConstFloatRef& b, FloatRef c) {
  if (a.cols() == 0 || c.size() == 0) return;
  cblas_sgemm(CblasColMajor, CblasNoTrans, CblasNoTrans, as_int(c.rows()), as_int(c.cols()),
              as_int(a.cols()), factor, a.data(), leading(a), b.data(), leading(b), 1, c.data(),
              leading(c));
}

void add_transposed_product(float factor, const ConstFloatRef& a, const ConstFloatRef& b, FloatRef c) {
  if (a.rows() == 0 || c.size() == 0) return;
  cblas_sgemm(CblasColMajor, CblasTrans, CblasNoTrans, as_int(c.rows()), as_int(c.cols()),
              as_int(a.rows()), factor, a.data(), leading(a), b.data(), leading(b), 1, c.data(),
              leading(c));
}

void add_product_transposed(float factor, const ConstFloatRef& a, const ConstFloatRef& b, FloatRef c) {
  if (a.cols() == 0 || c.size() == 0) return;
  cblas_sgemm(CblasColMajor, CblasNoTrans, CblasTrans, as_int(c.rows()), as_int(c.cols()),
              as_int(a.cols()), factor, a.data(), leading(a), b.data(), leading(b), 1, c.data(),
              leading(c));
}

void solve_right(const ConstFloatRef& lower, bool transposed, FloatRef x) {
  if (x.size() == 0) return;
  cblas_strsm(CblasColMajor, CblasRight, CblasLower, transposed ? CblasTrans : CblasNoTrans,
              CblasNonUnit, as_int(x.rows()), as_int(x.cols()), 1, lower.data(), leading(lower),
              x.data(), leading(x));
}

bool inverse_of_cholesky(FloatRef lower) {
  const int n = as_int(lower.rows()), stride = leading(lower);
  int info = 0;
  spotri_("L", &n, lower.data(), &stride, &info);
  for (Eigen::Index column = 1; column < lower.cols(); ++column)
    lower.col(column).head(column) = lower.row(column).head(column).transpose();
  return info == 0;
}

bool orthonormalise(FloatRef a, Eigen::MatrixXf& r) {
  const int m = as_int(a.rows()), n = as_int(a.cols()), stride = leading(a), query = -1;
  std::vector<float> scale(std::size_t(std::max(n, 1)));
  float first = 0, second = 0;
  int info = 0;
  sgeqrf_(&m, &n, a.data(), &stride, scale.data(), &first, &query, &info);
  sorgqr_(&m, &n, &n, a.data(), &stride, scale.data(), &second, &query, &info);
  const int size = std::max({n, 1, int(first), int(second)});
  std::vector<float> work(std::size_t{unsigned(size)});
  sgeqrf_(&m, &n, a.data(), &stride, scale.data(), work.data(), &size, &info);
  if (info != 0) return false;
  r = a.topRows(n).triangularView<Eigen::Upper>();
  sorgqr_(&m, &n, &n, a.data(), &stride, scale.data(), work.data(), &size, &info);
  return info == 0;
}

bool orthonormalise_in_double(FloatRef a, Eigen::MatrixXd& r, const PieceRunner& run) {
  const int n = as_int(a.cols());
  r.setIdentity(n, n);
  if (n == 0) return true;
  for (int pass = 0; pass < largest_pass_count; ++pass) {
    Eigen::MatrixXd gram = gram_of(a, run);
    const double off = (gram - Eigen::MatrixXd::Identity(n, n)).cwiseAbs().maxCoeff();
    if (!std::isfinite(off)) return false;
    if (off > well_conditioned) gram.diagonal().array() += gram_shift * gram.trace();
    int info = 0;
    dpotrf_("L", &n, gram.data(), &n, &info);
    if (info != 0) return false;
    const Eigen::MatrixXd factor = gram.triangularView<Eigen::Lower>();
    run(std::size_t((a.rows() + cast_rows - 1) / cast_rows), [&](std::size_t piece) {
      const Eigen::Index row = Eigen::Index(piece) * cast_rows;
      const Eigen::Index count = std::min(cast_rows, a.rows() - row);
      Eigen::MatrixXd rows = a.middleRows(row, count).cast<double>();
      cblas_dtrsm(CblasColMajor, CblasRight, CblasLower, CblasTrans, CblasNonUnit, as_int(count), n, 1,
                  factor.data(), n, rows.data(), as_int(count));
      a.middleRows(row, count) = rows.cast<float>();
    });
    r = (factor.transpose() * r).eval();
    if (off <= well_conditioned) return true;
  }
  return false;
}

SmallSvd singular_values(Eigen::MatrixXd a) {
  const int m = as_int(a.rows()), n = as_int(a.cols()), k = std::min(m, n), query = -1;
  SmallSvd svd;
  svd.left.resize(m, k);
  svd.singular.resize(k);
  svd.right.resize(n, k);
  svd.converged = true;
  if (k == 0) return svd;
  Eigen::MatrixXd right(k, n);
  std::vector<int> integers(8 * std::size_t(k));
  double wanted = 0;
  int info = 0;
  dgesdd_("S", &m, &n, a.data(), &m, svd.singular.data(), svd.left.data(), &m, right.data(), &k,
          &wanted, &query, integers.data(), &info);
  const int size = std::max(1, int(wanted));
  std::vector<double> work(static_cast<std::size_t>(size));
  dgesdd_("S", &m, &n, a.data(), &m, svd.singular.data(), svd.left.data(), &m, right.data(), &k,
          work.data(), &size, integers.data(), &info);
  svd.right = right.transpose();
  svd.converged = info == 0 && svd.singular.allFinite();
  return svd;
}

double spectral_norm(const ConstFloatRef& a) {
  if (a.size() == 0) return 0;
  Eigen::MatrixXf gram = Eigen::MatrixXf::Zero(a.cols(), a.cols());
  add_transposed_product(1, a, a, gram);
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(gram.cast<double>(),
                                                              Eigen::EigenvaluesOnly);
  return std::sqrt(std::max(0.0, solver.eigenvalues().maxCoeff()));
}

}  // namespace souple
