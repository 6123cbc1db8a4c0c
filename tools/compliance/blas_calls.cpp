// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/compliance/blas_calls.hpp"

#include <cblas.h>

extern "C" {
void openblas_set_num_threads(int count);
void dpotrf_(const char* triangle, const int* n, double* a, const int* lda, int* info);
}

namespace souple::blas {
namespace {

// Dimensions of one front fit an int long before its square fits the memory.
blasint i(std::int64_t value) { return static_cast<blasint>(value); }

}  // namespace

void use_one_thread_per_call() {
  static const bool once = (openblas_set_num_threads(1), true);
  static_cast<void>(once);
}

void subtract_product(std::int64_t m, std::int64_t n, std::int64_t k, const float* a, std::int64_t lda,
                      const float* b, std::int64_t ldb, float* c, std::int64_t ldc) {
  cblas_sgemm(CblasColMajor, CblasNoTrans, CblasNoTrans, i(m), i(n), i(k), -1, a, i(lda), b, i(ldb), 1,
              c, i(ldc));
}
void subtract_product(std::int64_t m, std::int64_t n, std::int64_t k, const double* a, std::int64_t lda,
                      const double* b, std::int64_t ldb, double* c, std::int64_t ldc) {
  cblas_dgemm(CblasColMajor, CblasNoTrans, CblasNoTrans, i(m), i(n), i(k), -1, a, i(lda), b, i(ldb), 1,
              c, i(ldc));
}
void subtract_product_transposed(std::int64_t m, std::int64_t n, std::int64_t k, const double* a,
                                 std::int64_t lda, const double* b, std::int64_t ldb, double* c,
                                 std::int64_t ldc) {
  cblas_dgemm(CblasColMajor, CblasNoTrans, CblasTrans, i(m), i(n), i(k), -1, a, i(lda), b, i(ldb), 1, c,
              i(ldc));
}
void add_transposed_product(std::int64_t m, std::int64_t n, std::int64_t k, const float* a,
                            std::int64_t lda, const float* b, std::int64_t ldb, float* c,
                            std::int64_t ldc) {
  cblas_sgemm(CblasColMajor, CblasTrans, CblasNoTrans, i(m), i(n), i(k), 1, a, i(lda), b, i(ldb), 1, c,
              i(ldc));
}
void add_transposed_product(std::int64_t m, std::int64_t n, std::int64_t k, const double* a,
                            std::int64_t lda, const double* b, std::int64_t ldb, double* c,
                            std::int64_t ldc) {
  cblas_dgemm(CblasColMajor, CblasTrans, CblasNoTrans, i(m), i(n), i(k), 1, a, i(lda), b, i(ldb), 1, c,
              i(ldc));
}
void add_gram(std::int64_t n, std::int64_t k, const float* a, std::int64_t lda, float* c,
              std::int64_t ldc) {
  cblas_ssyrk(CblasColMajor, CblasLower, CblasTrans, i(n), i(k), 1, a, i(lda), 1, c, i(ldc));
}
void add_gram(std::int64_t n, std::int64_t k, const double* a, std::int64_t lda, double* c,
              std::int64_t ldc) {
  cblas_dsyrk(CblasColMajor, CblasLower, CblasTrans, i(n), i(k), 1, a, i(lda), 1, c, i(ldc));
}
void subtract_outer_gram(std::int64_t n, std::int64_t k, const double* a, std::int64_t lda, double* c,
                         std::int64_t ldc) {
  cblas_dsyrk(CblasColMajor, CblasLower, CblasNoTrans, i(n), i(k), -1, a, i(lda), 1, c, i(ldc));
}
void solve_lower(std::int64_t n, std::int64_t columns, const float* l, std::int64_t ldl, float* b,
                 std::int64_t ldb) {
  cblas_strsm(CblasColMajor, CblasLeft, CblasLower, CblasNoTrans, CblasNonUnit, i(n), i(columns), 1, l,
              i(ldl), b, i(ldb));
}
void solve_lower(std::int64_t n, std::int64_t columns, const double* l, std::int64_t ldl, double* b,
                 std::int64_t ldb) {
  cblas_dtrsm(CblasColMajor, CblasLeft, CblasLower, CblasNoTrans, CblasNonUnit, i(n), i(columns), 1, l,
              i(ldl), b, i(ldb));
}
void solve_lower_from_right(std::int64_t rows, std::int64_t n, const double* l, std::int64_t ldl,
                            double* b, std::int64_t ldb) {
  cblas_dtrsm(CblasColMajor, CblasRight, CblasLower, CblasTrans, CblasNonUnit, i(rows), i(n), 1, l,
              i(ldl), b, i(ldb));
}
bool cholesky(std::int64_t n, double* a, std::int64_t lda) {
  const int size = static_cast<int>(n), stride = static_cast<int>(lda);
  int info = 0;
  dpotrf_("L", &size, a, &stride, &info);
  return info == 0;
}

}  // namespace souple::blas
