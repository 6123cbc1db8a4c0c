// SPDX-License-Identifier: GPL-3.0-or-later
// Products with blocks that stay in single precision or in integers, against dense matrices.
#include "tools/compliance/hodlr_view.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <numeric>
#include <random>

#include "tools/compliance/node_scale.hpp"

namespace souple {
namespace {

using Eigen::MatrixXd;
using Eigen::MatrixXf;

MatrixXf random_matrix(Eigen::Index rows, Eigen::Index columns, std::mt19937& random) {
  std::normal_distribution<float> normal;
  MatrixXf m(rows, columns);
  for (float& value : m.reshaped()) value = normal(random) / std::sqrt(float(rows));
  return m;
}

/// Blocks of falling singular values, the last of which quantising drops; one block has no terms.
HodlrMatrix make_matrix(Index nodes, int depth) {
  std::mt19937 random(17);
  HodlrMatrix matrix;
  matrix.depth = depth;
  matrix.order.resize(std::size_t(nodes));
  std::iota(matrix.order.rbegin(), matrix.order.rend(), Index{0});
  std::uniform_real_distribution<float> size(0.5F, 2);
  for (Index row = 0; row < nodes; ++row)
    matrix.scale.push_back({size(random), 0.1F, size(random), -0.2F, 0.3F, size(random)});
  for (int level = 0; level < depth; ++level)
    for (Index i = 0; i < Index{1} << level; ++i) {
      const Eigen::Index left = 3 * Eigen::Index{cluster_range(nodes, level + 1, 2 * i).size()};
      const Eigen::Index right = 3 * Eigen::Index{cluster_range(nodes, level + 1, 2 * i + 1).size()};
      const Eigen::Index rank =
          level == 2 && i == 1 ? 0 : std::min<Eigen::Index>(7, std::min(left, right));
      LowRankBlock block{random_matrix(left, rank, random), Eigen::VectorXf(rank),
                         random_matrix(right, rank, random)};
      for (Eigen::Index k = 0; k < rank; ++k) block.singular[k] = 10 * std::pow(0.2F, float(k));
      matrix.blocks.push_back(std::move(block));
    }
  for (Index leaf = 0; leaf < Index{1} << depth; ++leaf) {
    const Eigen::Index rows = 3 * Eigen::Index{cluster_range(nodes, depth, leaf).size()};
    const MatrixXf half = random_matrix(rows, rows, random);
    matrix.leaves.push_back(half + half.transpose());
  }
  return matrix;
}

QuantisedMatrix quantised_of(const HodlrMatrix& matrix, WorkerPool& pool) {
  const StepShares shares{Eigen::VectorXd::Ones(Eigen::Index(matrix.blocks.size())),
                          Eigen::VectorXd::Constant(Eigen::Index(matrix.leaves.size()), 0.5)};
  auto quantised = quantise(matrix, shares, 0.01, pool);
  EXPECT_TRUE(quantised.has_value());
  return quantised.value_or(QuantisedMatrix{});
}

/// S C~ S^T entry by entry, in cluster order; what is rounded is rounded here once more.
MatrixXd dense_of(const HodlrMatrix& matrix, const QuantisedMatrix* quantised) {
  const auto n = Index(matrix.order.size());
  MatrixXd dense = MatrixXd::Zero(3 * n, 3 * n);
  const auto rows_of = [](ClusterRange range) {
    return Eigen::seqN(3 * range.begin, 3 * range.size());
  };
  const auto rounded = [](double value, double step) { return std::round(value / step) * step; };
  for (int level = 0; level < matrix.depth; ++level)
    for (Index i = 0; i < Index{1} << level; ++i) {
      const auto b = std::size_t(block_of_cluster(level, i));
      const LowRankBlock& block = matrix.blocks[b];
      MatrixXd sum = MatrixXd::Zero(block.left.rows(), block.right.rows());
      for (Eigen::Index k = 0; k < block.singular.size(); ++k) {
        const double value = block.singular[k];
        Eigen::VectorXd left = value * block.left.col(k).cast<double>();
        Eigen::VectorXd right = value * block.right.col(k).cast<double>();
        if (quantised) {
          if (std::ranges::count(quantised->blocks[b].kept, k) == 0) continue;
          const double step = quantised->blocks[b].step;
          for (double& entry : left) entry = rounded(entry, step);
          for (double& entry : right) entry = rounded(entry, step);
        }
        sum += left * right.transpose() / value;
      }
      const auto left = rows_of(cluster_range(n, level + 1, 2 * i));
      const auto right = rows_of(cluster_range(n, level + 1, 2 * i + 1));
      dense(left, right) = sum;
      dense(right, left) = sum.transpose();
    }
  for (std::size_t leaf = 0; leaf < matrix.leaves.size(); ++leaf) {
    const auto own = rows_of(cluster_range(n, matrix.depth, static_cast<Index>(leaf)));
    MatrixXd values = matrix.leaves[leaf].cast<double>();
    if (quantised)
      for (double& entry : values.reshaped())
        entry = rounded(entry, double(quantised->leaf_step[leaf]));
    dense(own, own) = values;
  }
  MatrixXd scale = MatrixXd::Zero(3 * n, 3 * n);
  for (Index p = 0; p < n; ++p)
    scale.block<3, 3>(3 * p, 3 * p) =
        scale_matrix<double>(matrix.scale[std::size_t(matrix.order[std::size_t(p)])]);
  return scale * dense * scale.transpose();
}

TEST(HodlrView, MultipliesLikeTheDenseMatrix) {
  WorkerPool pool(2);
  for (const auto& [nodes, depth] : {std::pair<Index, int>(1, 0), {90, 3}, {600, 1}}) {
    const HodlrMatrix matrix = make_matrix(nodes, depth);
    const QuantisedMatrix quantised = quantised_of(matrix, pool);
    const MatrixXd x = MatrixXd::Random(3 * nodes, 21);
    for (const QuantisedMatrix* stored : {static_cast<const QuantisedMatrix*>(nullptr), &quantised}) {
      const MatrixXd dense = dense_of(matrix, stored), before = MatrixXd::Random(3 * nodes, 21);
      MatrixXd y = before;
      HodlrView(matrix, stored, pool).add_product(-2, x, y);
      const MatrixXd expected = before - 2 * dense * x;
      EXPECT_LE((y - expected).norm(), 1e-12 * expected.norm()) << nodes << " " << (stored != nullptr);
    }
  }
}

TEST(HodlrView, RoundingChangesTheMatrixAboutAsMuchAsItsSteps) {
  WorkerPool pool(2);
  const HodlrMatrix matrix = make_matrix(90, 3);
  const QuantisedMatrix quantised = quantised_of(matrix, pool);
  EXPECT_LT(quantised.blocks[0].kept.size(), std::size_t(matrix.blocks[0].singular.size()));
  const double change = (dense_of(matrix, &quantised) - dense_of(matrix, nullptr)).norm();
  EXPECT_GT(change, 0.1 * 0.01 * 270 / std::sqrt(12.0));
  EXPECT_LT(change, 10 * 0.01 * 270 / std::sqrt(12.0));
}

TEST(HodlrView, KnowsTheNormsOfTheColumns) {
  WorkerPool pool(2);
  for (const auto& [nodes, depth] : {std::pair<Index, int>(90, 3), {600, 1}}) {
    const HodlrMatrix matrix = make_matrix(nodes, depth);
    const Eigen::VectorXd expected = dense_of(matrix, nullptr).colwise().norm();
    const Eigen::VectorXd norms = HodlrView(matrix, nullptr, pool).column_norms();
    EXPECT_LE((norms - expected).cwiseQuotient(expected).cwiseAbs().maxCoeff(), 1e-12);
  }
}

TEST(HodlrView, BitsDoNotDependOnTheThreads) {
  const HodlrMatrix matrix = make_matrix(1400, 3);
  const MatrixXd x = MatrixXd::Random(4200, 5);
  const auto product = [&](unsigned threads) {
    WorkerPool pool(threads);
    const QuantisedMatrix quantised = quantised_of(matrix, pool);
    MatrixXd y = MatrixXd::Zero(4200, 5);
    HodlrView(matrix, &quantised, pool).add_product(1, x, y);
    return y;
  };
  EXPECT_EQ(product(1), product(3));
}

}  // namespace
}  // namespace souple
