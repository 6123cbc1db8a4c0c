// SPDX-License-Identifier: MIT
#include "runtime/multigrid/dense_solver.hpp"

#include <algorithm>
#include <cmath>

namespace souple {
namespace {

/// Of the diagonal entry that it was: below it is the rounding of single precision that is left.
constexpr double least_pivot = 1e-6;
/// Columns whose effect on the rest is applied together.
constexpr Eigen::Index panel_width = 24;

}  // namespace

DenseSolver::DenseSolver(Index node_count)
    : factor_(3 * Eigen::Index{node_count}, 3 * Eigen::Index{node_count}),
      y_(3 * Eigen::Index{node_count}) {}

void DenseSolver::load(const BlockMatrixF& a) {
  factor_.setZero();
  const BlockPattern& pattern = *a.pattern;
  for (Index row = 0; row < pattern.node_count(); ++row)
    for (Index b = pattern.diagonal[std::size_t(row)]; b < pattern.row_begin[std::size_t(row) + 1]; ++b)
      factor_.block<3, 3>(3 * pattern.column[std::size_t(b)], 3 * row) =
          a.block(b).transpose().cast<double>();
}

/// Columns [first, last): of the rows below, those of the panel itself take part at once.
bool DenseSolver::factorize_panel(Eigen::Index first, Eigen::Index last) {
  const Eigen::Index n = factor_.rows();
  for (Eigen::Index k = first; k < last; ++k) {
    const double pivot = factor_(k, k);
    if (!std::isfinite(pivot)) return false;
    auto below = factor_.col(k).tail(n - k - 1);
    if (pivot <= least_pivot * y_[k]) {
      factor_(k, k) = 0;
      below.setZero();
      continue;
    }
    factor_(k, k) = 1 / std::sqrt(pivot);
    below *= factor_(k, k);
    for (Eigen::Index j = k + 1; j < last; ++j)
      factor_.col(j).tail(n - j).noalias() -= factor_(j, k) * factor_.col(k).tail(n - j);
  }
  return true;
}

bool DenseSolver::update(const BlockMatrixF& a) {
  load(a);
  y_ = factor_.diagonal();
  const Eigen::Index n = factor_.rows();
  for (Eigen::Index first = 0; first < n; first += panel_width) {
    const Eigen::Index last = std::min(first + panel_width, n);
    if (!factorize_panel(first, last)) return false;
    const auto panel = factor_.middleCols(first, last - first);
    for (Eigen::Index j = last; j < n; ++j)
      factor_.col(j).tail(n - j).noalias() -= panel.bottomRows(n - j) * panel.row(j).transpose();
  }
  return true;
}

void DenseSolver::solve(const PaddedVector& b, PaddedVector& x) {
  const Eigen::Index n = factor_.rows();
  for (Eigen::Index i = 0; i < n; ++i) y_[i] = b[std::size_t(i / 3 * 4 + i % 3)];
  for (Eigen::Index k = 0; k < n; ++k) {
    y_[k] *= factor_(k, k);
    y_.tail(n - k - 1).noalias() -= y_[k] * factor_.col(k).tail(n - k - 1);
  }
  for (Eigen::Index k = n; k-- > 0;) {
    y_[k] -= factor_.col(k).tail(n - k - 1).dot(y_.tail(n - k - 1));
    y_[k] *= factor_(k, k);
  }
  for (Eigen::Index i = 0; i < n; ++i) x[std::size_t(i / 3 * 4 + i % 3)] = float(y_[i]);
}

}  // namespace souple
