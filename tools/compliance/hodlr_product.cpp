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

ScaledHodlr scaled_hodlr(const HodlrMatrix& matrix, const QuantisedMatrix& quantised,
                         WorkerPool& pool) {
  const std::vector<Eigen::Matrix3d> scales = ordered_scales(matrix);
  ScaledHodlr scaled;
  scaled.node_count = Index(matrix.order.size());
  scaled.depth = matrix.depth;
  scaled.blocks.resize(matrix.blocks.size());
  scaled.leaves.resize(matrix.leaves.size());
  pool.run(scaled.blocks.size() + scaled.leaves.size(), [&](std::size_t item, unsigned) {
    if (item < scaled.blocks.size()) {
      auto [left, right] = factors_of(matrix.blocks[item], quantised.blocks[item]);
      scaled.blocks[item] = scaled_block(std::move(left), std::move(right), scales,
                                         range_of_block(scaled.node_count, item));
    } else {
      const std::size_t leaf = item - scaled.blocks.size();
      scaled.leaves[leaf] =
          scaled_leaf(leaf_of(matrix, quantised, leaf), scales,
                      cluster_range(scaled.node_count, scaled.depth, static_cast<Index>(leaf)));
    }
  });
  return scaled;
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

}  // namespace souple
