// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/compliance/hodlr_factor.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>

#include "tools/compliance/extreme_eigenvalues.hpp"

namespace souple {
namespace {

using Eigen::MatrixXd;

constexpr int inverse_steps = 12;
constexpr double first_shift = 4;  ///< resolutions

// I - L^T G2 L is positive definite, L L^T = G1: the test of Sylvester on both sides of a block.
bool is_contraction(const MatrixXd& left_gram, const MatrixXd& right_gram) {
  const Eigen::Index rank = left_gram.rows();
  if (rank == 0) return true;
  // Nearly dependent columns leave a Gram matrix that rounding may have made indefinite.
  const MatrixXd raised = left_gram + 1e-14 * left_gram.trace() * MatrixXd::Identity(rank, rank);
  const Eigen::LLT<MatrixXd> factor(raised);
  if (factor.info() != Eigen::Success) return false;
  const MatrixXd lower = factor.matrixL();
  const MatrixXd rest = MatrixXd::Identity(rank, rank) - lower.transpose() * right_gram * lower;
  return rest.allFinite() && Eigen::LLT<MatrixXd>(rest).info() == Eigen::Success;
}

}  // namespace

HodlrFactor::HodlrFactor(const ScaledHodlr& matrix)
    : matrix_(&matrix),
      leaves_(matrix.leaves.size()),
      solved_(matrix.blocks),
      couplings_(matrix.blocks.size()) {}

std::optional<HodlrFactor> HodlrFactor::create(const ScaledHodlr& matrix, double shift,
                                               WorkerPool& pool) {
  HodlrFactor factor(matrix);
  std::atomic<bool> ok{true};
  pool.run(matrix.leaves.size(), [&](std::size_t leaf, unsigned) {
    if (ok && !factor.factor_leaf(Index(leaf), shift)) ok = false;
  });
  for (int d = matrix.depth - 1; d >= 0 && ok; --d)
    pool.run(std::size_t{1} << d, [&](std::size_t cluster, unsigned) {
      if (ok && !factor.factor_block(d, Index(cluster))) ok = false;
    });
  if (!ok) return std::nullopt;
  return factor;
}

bool HodlrFactor::factor_leaf(Index leaf, double shift) {
  MatrixXd own = matrix_->leaves[std::size_t(leaf)];
  own.diagonal().array() += shift;
  auto& factor = leaves_[std::size_t(leaf)];
  factor.compute(own);
  if (factor.info() != Eigen::Success) return false;
  const Index begin = cluster_range(matrix_->node_count, matrix_->depth, leaf).begin;
  for (int d = 0; d < matrix_->depth; ++d) {
    const Index child = leaf >> (matrix_->depth - d - 1);
    auto& block = solved_[std::size_t(block_of_cluster(d, child / 2))];
    const Index first = cluster_range(matrix_->node_count, d + 1, child).begin;
    factor.solveInPlace((child % 2 == 0 ? block.left : block.right)
                            .middleRows(3 * Eigen::Index{begin - first}, own.rows()));
  }
  return true;
}

bool HodlrFactor::factor_block(int depth, Index cluster) {
  const auto b = std::size_t(block_of_cluster(depth, cluster));
  const ScaledHodlr::Block &block = matrix_->blocks[b], &solved = solved_[b];
  Coupling& coupling = couplings_[b];
  coupling.left_gram = block.left.transpose() * solved.left;
  coupling.right_gram = block.right.transpose() * solved.right;
  if (!is_contraction(coupling.left_gram, coupling.right_gram)) return false;
  const Eigen::Index rank = coupling.left_gram.rows();
  if (rank > 0)
    coupling.difference.compute(MatrixXd::Identity(rank, rank) -
                                coupling.left_gram * coupling.right_gram);
  const ClusterRange range = cluster_range(matrix_->node_count, depth, cluster);
  for (int d = 0; d < depth; ++d) {
    const Index child = cluster >> (depth - d - 1);
    auto& above = solved_[std::size_t(block_of_cluster(d, child / 2))];
    const Index first = cluster_range(matrix_->node_count, d + 1, child).begin;
    couple(b, (child % 2 == 0 ? above.left : above.right)
                  .middleRows(3 * Eigen::Index{range.begin - first}, 3 * Eigen::Index{range.size()}));
  }
  return true;
}

void HodlrFactor::couple(std::size_t b, Eigen::Ref<MatrixXd> y) const {
  const ScaledHodlr::Block &block = matrix_->blocks[b], &solved = solved_[b];
  const Coupling& coupling = couplings_[b];
  if (coupling.left_gram.rows() == 0 || y.cols() == 0) return;
  auto first = y.topRows(block.left.rows());
  auto second = y.bottomRows(block.right.rows());
  const MatrixXd from_first = block.left.transpose() * first;
  const MatrixXd from_second = block.right.transpose() * second;
  const MatrixXd w2 = coupling.difference.solve(from_first - coupling.left_gram * from_second);
  const MatrixXd w1 = from_second - coupling.right_gram * w2;
  first.noalias() -= solved.left * w1;
  second.noalias() -= solved.right * w2;
}

void HodlrFactor::solve(Eigen::Ref<MatrixXd> x) const {
  const auto rows_of = [&](int depth, Index cluster) {
    const ClusterRange range = cluster_range(matrix_->node_count, depth, cluster);
    return x.middleRows(3 * Eigen::Index{range.begin}, 3 * Eigen::Index{range.size()});
  };
  for (std::size_t leaf = 0; leaf < leaves_.size(); ++leaf) {
    auto rows = rows_of(matrix_->depth, Index(leaf));
    leaves_[leaf].solveInPlace(rows);
  }
  for (int d = matrix_->depth - 1; d >= 0; --d)
    for (Index cluster = 0; cluster < (Index{1} << d); ++cluster)
      couple(std::size_t(block_of_cluster(d, cluster)), rows_of(d, cluster));
}

double least_positive_shift(const ScaledHodlr& matrix, double resolution, WorkerPool& pool) {
  // `low` is known to be too little.
  double low = 0, high = 0;
  auto factor = HodlrFactor::create(matrix, high, pool);
  if (factor) return 0;
  for (high = first_shift * resolution;; low = high, high *= 2) {
    factor = HodlrFactor::create(matrix, high, pool);
    if (factor) break;
    if (!std::isfinite(high)) return high;
  }
  const EigenvalueRange inverse = extreme_eigenvalues(
      [&](const MatrixXd& x, MatrixXd& y) {
        y = x;
        factor->solve(y);
      },
      3 * Eigen::Index{matrix.node_count}, 1, inverse_steps);
  // Lanczos finds the least eigenvalue from above.
  low = std::max(low, high - 1 / inverse.largest);
  for (double step = resolution; low + step < high; low += step, step *= 2)
    if (HodlrFactor::create(matrix, low + step, pool)) return low + step;
  return high;
}

}  // namespace souple
