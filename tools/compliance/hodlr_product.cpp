// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/compliance/hodlr_product.hpp"

#include "tools/compliance/node_scale.hpp"

namespace souple {
namespace {

using Eigen::MatrixXd;

void scale_rows(const std::vector<Eigen::Matrix3d>& scales, Index first, Eigen::Ref<MatrixXd> rows) {
  for (Eigen::Index a = 0; 3 * a < rows.rows(); ++a)
    rows.middleRows<3>(3 * a) =
        (scales[std::size_t(first) + std::size_t(a)] * rows.middleRows<3>(3 * a)).eval();
}

// left and right are C~'s; takes S to both sides.
ScaledHodlr::Block scaled_block(MatrixXd left, MatrixXd right,
                                const std::vector<Eigen::Matrix3d>& scales, ClusterRange range) {
  scale_rows(scales, range.begin, left);
  scale_rows(scales, range.begin + Index(left.rows() / 3), right);
  return {std::move(left), std::move(right)};
}

MatrixXd scaled_leaf(MatrixXd leaf, const std::vector<Eigen::Matrix3d>& scales, ClusterRange range) {
  scale_rows(scales, range.begin, leaf);
  leaf.transposeInPlace();
  scale_rows(scales, range.begin, leaf);
  return 0.5 * (leaf + leaf.transpose());
}

// The range of the cluster of block `b` in heap order.
ClusterRange range_of_block(Index node_count, std::size_t b) {
  int depth = 0;
  while ((std::size_t{2} << depth) - 1 <= b) ++depth;
  return cluster_range(node_count, depth, Index(b + 1 - (std::size_t{1} << depth)));
}

template <class BlockOf, class LeafOf>
ScaledHodlr make_scaled(const HodlrMatrix& matrix, WorkerPool& pool, const BlockOf& block_of,
                        const LeafOf& leaf_of) {
  const std::vector<Eigen::Matrix3d> scales = ordered_scales(matrix);
  ScaledHodlr scaled;
  scaled.node_count = Index(matrix.order.size());
  scaled.depth = matrix.depth;
  scaled.blocks.resize(matrix.blocks.size());
  scaled.leaves.resize(matrix.leaves.size());
  pool.run(scaled.blocks.size() + scaled.leaves.size(), [&](std::size_t item, unsigned) {
    if (item < scaled.blocks.size()) {
      auto [left, right] = block_of(item);
      scaled.blocks[item] = scaled_block(std::move(left), std::move(right), scales,
                                         range_of_block(scaled.node_count, item));
    } else {
      const std::size_t leaf = item - scaled.blocks.size();
      scaled.leaves[leaf] =
          scaled_leaf(leaf_of(leaf), scales,
                      cluster_range(scaled.node_count, scaled.depth, static_cast<Index>(leaf)));
    }
  });
  return scaled;
}

// What the integers stand for, without S.
std::pair<MatrixXd, MatrixXd> factors_of(const LowRankBlock& block, const QuantisedBlock& quantised) {
  const double step = quantised.step;
  const auto side = [&](const Eigen::MatrixXf& m) {
    return MatrixXd(side_integers(block, quantised, m, 0, m.rows()).cast<double>());
  };
  return {
      side(block.left) *
          (step * step * kept_singular(block, quantised).cast<double>().cwiseInverse()).asDiagonal(),
      side(block.right)};
}

MatrixXd leaf_of(const HodlrMatrix& matrix, const QuantisedMatrix& quantised, std::size_t leaf) {
  const float step = quantised.leaf_step[leaf];
  return double(step) * leaf_integers(matrix.leaves[leaf], step).cast<double>();
}

}  // namespace

std::vector<Eigen::Matrix3d> ordered_scales(const HodlrMatrix& matrix) {
  std::vector<Eigen::Matrix3d> scales;
  for (const Index row : matrix.order)
    scales.push_back(scale_matrix<double>(matrix.scale[std::size_t(row)]));
  return scales;
}

ScaledHodlr scaled_hodlr(const HodlrMatrix& matrix, WorkerPool& pool) {
  return make_scaled(
      matrix, pool,
      [&](std::size_t b) {
        const LowRankBlock& block = matrix.blocks[b];
        return std::pair<MatrixXd, MatrixXd>(
            block.left.cast<double>() * block.singular.cast<double>().asDiagonal(),
            block.right.cast<double>());
      },
      [&](std::size_t leaf) { return MatrixXd(matrix.leaves[leaf].cast<double>()); });
}

ScaledHodlr scaled_hodlr(const HodlrMatrix& matrix, const QuantisedMatrix& quantised,
                         WorkerPool& pool) {
  return make_scaled(
      matrix, pool, [&](std::size_t b) { return factors_of(matrix.blocks[b], quantised.blocks[b]); },
      [&](std::size_t leaf) { return leaf_of(matrix, quantised, leaf); });
}

ScaledHodlr plain_hodlr(const HodlrMatrix& matrix, const QuantisedMatrix& quantised) {
  ScaledHodlr plain;
  plain.node_count = Index(matrix.order.size());
  plain.depth = matrix.depth;
  for (std::size_t b = 0; b < matrix.blocks.size(); ++b) {
    auto [left, right] = factors_of(matrix.blocks[b], quantised.blocks[b]);
    plain.blocks.push_back({std::move(left), std::move(right)});
  }
  for (std::size_t leaf = 0; leaf < matrix.leaves.size(); ++leaf)
    plain.leaves.push_back(leaf_of(matrix, quantised, leaf));
  return plain;
}

void ScaledHodlr::add_product(double factor, const Eigen::Ref<const MatrixXd>& x,
                              Eigen::Ref<MatrixXd> y) const {
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    const Block& block = blocks[b];
    const Eigen::Index first = 3 * Eigen::Index{range_of_block(node_count, b).begin};
    const Eigen::Index second = first + block.left.rows();
    const MatrixXd from_right =
        factor * (block.right.transpose() * x.middleRows(second, block.right.rows()));
    const MatrixXd from_left =
        factor * (block.left.transpose() * x.middleRows(first, block.left.rows()));
    y.middleRows(first, block.left.rows()).noalias() += block.left * from_right;
    y.middleRows(second, block.right.rows()).noalias() += block.right * from_left;
  }
  for (std::size_t leaf = 0; leaf < leaves.size(); ++leaf) {
    const Eigen::Index first =
        3 * Eigen::Index{cluster_range(node_count, depth, static_cast<Index>(leaf)).begin};
    const Eigen::Index rows = leaves[leaf].rows();
    y.middleRows(first, rows).noalias() += factor * leaves[leaf] * x.middleRows(first, rows);
  }
}

Eigen::VectorXd ScaledHodlr::column_norms() const {
  Eigen::VectorXd norms2 = Eigen::VectorXd::Zero(3 * Eigen::Index{node_count});
  const auto squared = [](const MatrixXd& factor, const MatrixXd& other) {
    const MatrixXd gram = other.transpose() * other;
    return Eigen::VectorXd((factor * gram).cwiseProduct(factor).rowwise().sum());
  };
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    const Block& block = blocks[b];
    const Eigen::Index first = 3 * Eigen::Index{range_of_block(node_count, b).begin};
    norms2.segment(first, block.left.rows()) += squared(block.left, block.right);
    norms2.segment(first + block.left.rows(), block.right.rows()) += squared(block.right, block.left);
  }
  for (std::size_t leaf = 0; leaf < leaves.size(); ++leaf)
    norms2.segment(3 * Eigen::Index{cluster_range(node_count, depth, static_cast<Index>(leaf)).begin},
                   leaves[leaf].rows()) += leaves[leaf].colwise().squaredNorm().transpose();
  return norms2.cwiseMax(0).cwiseSqrt();
}

}  // namespace souple
