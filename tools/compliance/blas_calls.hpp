// SPDX-License-Identifier: GPL-3.0-or-later
// The few BLAS calls of the compliance, for both scalar types, column-major, each on the calling thread
// alone: parallelism is over independent calls, and the bits of a call depend on its arguments only.
#pragma once
#include <cstdint>

namespace souple::blas {

/// Keeps OpenBLAS to one thread; to be called before the others, from any thread. The bits of a product
/// differ from one kind of processor to another; OPENBLAS_CORETYPE in the environment settles the kind.
void use_one_thread_per_call();

/// C -= A B, C m x n, inner dimension k.
void subtract_product(std::int64_t m, std::int64_t n, std::int64_t k, const float* a, std::int64_t lda,
                      const float* b, std::int64_t ldb, float* c, std::int64_t ldc);
void subtract_product(std::int64_t m, std::int64_t n, std::int64_t k, const double* a, std::int64_t lda,
                      const double* b, std::int64_t ldb, double* c, std::int64_t ldc);
/// C -= A B^T, C m x n, inner dimension k.
void subtract_product_transposed(std::int64_t m, std::int64_t n, std::int64_t k, const double* a,
                                 std::int64_t lda, const double* b, std::int64_t ldb, double* c,
                                 std::int64_t ldc);
/// C += A^T B, C m x n, inner dimension k.
void add_transposed_product(std::int64_t m, std::int64_t n, std::int64_t k, const float* a,
                            std::int64_t lda, const float* b, std::int64_t ldb, float* c,
                            std::int64_t ldc);
void add_transposed_product(std::int64_t m, std::int64_t n, std::int64_t k, const double* a,
                            std::int64_t lda, const double* b, std::int64_t ldb, double* c,
                            std::int64_t ldc);
/// Lower triangle of C += A^T A, C n x n, A k x n.
void add_gram(std::int64_t n, std::int64_t k, const float* a, std::int64_t lda, float* c,
              std::int64_t ldc);
void add_gram(std::int64_t n, std::int64_t k, const double* a, std::int64_t lda, double* c,
              std::int64_t ldc);
/// Lower triangle of C -= A A^T, C n x n, A n x k.
void subtract_outer_gram(std::int64_t n, std::int64_t k, const double* a, std::int64_t lda, double* c,
                         std::int64_t ldc);
/// B = L^-1 B, L n x n lower, B n x columns.
void solve_lower(std::int64_t n, std::int64_t columns, const float* l, std::int64_t ldl, float* b,
                 std::int64_t ldb);
void solve_lower(std::int64_t n, std::int64_t columns, const double* l, std::int64_t ldl, double* b,
                 std::int64_t ldb);
/// B = B L^-T, L n x n lower, B rows x n.
void solve_lower_from_right(std::int64_t rows, std::int64_t n, const double* l, std::int64_t ldl,
                            double* b, std::int64_t ldb);
/// Lower Cholesky factor in place; false if not positive definite.
bool cholesky(std::int64_t n, double* a, std::int64_t lda);

}  // namespace souple::blas
