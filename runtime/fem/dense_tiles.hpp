// SPDX-License-Identifier: MIT
// Dense Cholesky by columns, lower triangles, in strips of twelve rows. Nothing is allocated.
#pragma once
#include <cstddef>

namespace souple {

/// The first `columns` columns of a symmetric matrix of `rows` rows, a multiple of 3 of both, become
/// those of its factor. What stands above the diagonal is left or overwritten. False if the leading
/// block is not positive definite.
bool factorize_panel(double* panel, std::size_t rows, std::size_t columns);

/// Columns of a matrix of which only some rows are meant.
struct RowsOfColumns {
  const double* first;
  std::size_t stride;
  std::size_t rows, columns;
};
/// Scalars of the work of subtract_square.
std::size_t square_work(std::size_t rows, std::size_t columns);
/// Lower triangle of out = from - X X^T, both of x.rows columns of x.rows; `out` may be `from`.
void subtract_square(const RowsOfColumns& x, const double* from, double* out, double* work);

}  // namespace souple
