// SPDX-License-Identifier: MIT
#include "runtime/fem/dense_tiles.hpp"

#include <Eigen/Cholesky>
#include <algorithm>

namespace souple {
namespace {

// 96 x 96 doubles are 72 KiB; Eigen moves what is over 128 KiB to the heap.
constexpr Eigen::Index tile = 96;

Eigen::Index length(Eigen::Index from, Eigen::Index end) { return std::min(tile, end - from); }

using Tile = Eigen::Ref<Eigen::MatrixXd, 0, Eigen::OuterStride<>>;

void subtract_product(Tile out, const Tile& a, const Tile& b) { out.noalias() -= a * b.transpose(); }

// Diagonal tile and what is below it in its columns.
bool factorize_tile(DenseView& panel, Eigen::Index k, Eigen::Index width) {
  Tile diagonal = panel.block(k, k, width, width);
  const Eigen::LLT<Tile> llt(diagonal);
  if (llt.info() != Eigen::Success) return false;
  const Eigen::Index rows = panel.rows();
  for (Eigen::Index i = k + width; i < rows; i += tile) {
    auto below = panel.block(i, k, length(i, rows), width);
    diagonal.triangularView<Eigen::Lower>().transpose().solveInPlace<Eigen::OnTheRight>(below);
  }
  return true;
}

}  // namespace

bool factorize_panel(DenseView panel) {
  const Eigen::Index rows = panel.rows(), columns = panel.cols();
  for (Eigen::Index k = 0; k < columns; k += tile) {
    const Eigen::Index width = length(k, columns);
    if (!factorize_tile(panel, k, width)) return false;
    for (Eigen::Index j = k + width; j < columns; j += tile)
      for (Eigen::Index i = j; i < rows; i += tile)
        subtract_product(panel.block(i, j, length(i, rows), length(j, columns)),
                         panel.block(i, k, length(i, rows), width),
                         panel.block(j, k, length(j, columns), width));
  }
  return true;
}

void subtract_square(const DenseView& x, DenseView update) {
  DenseView factor = x;
  const Eigen::Index rows = x.rows(), depth = x.cols();
  for (Eigen::Index j = 0; j < rows; j += tile)
    for (Eigen::Index i = j; i < rows; i += tile)
      for (Eigen::Index k = 0; k < depth; k += tile)
        subtract_product(update.block(i, j, length(i, rows), length(j, rows)),
                         factor.block(i, k, length(i, rows), length(k, depth)),
                         factor.block(j, k, length(j, rows), length(k, depth)));
}

}  // namespace souple
