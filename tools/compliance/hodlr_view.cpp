// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/compliance/hodlr_view.hpp"

#include <algorithm>

#include "tools/compliance/hodlr_product.hpp"

namespace souple {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

// Of one piece: few enough that their doubles stay in the cache for a product.
constexpr Eigen::Index piece_rows = 768;
// Multiplied at once: what the pieces of a level give is held for so many.
constexpr Eigen::Index product_columns = 16;

}  // namespace

HodlrView::HodlrView(const HodlrMatrix& matrix, const QuantisedMatrix* quantised, WorkerPool& pool)
    : matrix_(matrix), quantised_(quantised), pool_(pool), scales_(ordered_scales(matrix)) {
  for (int level = 0; level < matrix.depth; ++level) levels_.push_back(make_level(level));
}

HodlrView::Level HodlrView::make_level(int level) const {
  Level out;
  out.first_block = std::size_t(block_of_cluster(level, 0));
  for (Index child = 0; child < Index{2} << level; ++child) {
    out.side_begin.push_back(out.pieces.size());
    const ClusterRange range = cluster_range(Index(matrix_.order.size()), level + 1, child);
    const Eigen::Index rows = 3 * Eigen::Index{range.size()};
    for (Eigen::Index first = 0; first < rows; first += piece_rows)
      out.pieces.push_back({std::size_t(child), first, std::min(piece_rows, rows - first),
                            3 * Eigen::Index{range.begin} + first});
  }
  out.side_begin.push_back(out.pieces.size());
  return out;
}

ClusterRange HodlrView::leaf_range(std::size_t leaf) const {
  return cluster_range(Index(matrix_.order.size()), matrix_.depth, static_cast<Index>(leaf));
}

MatrixXd HodlrView::plain_rows(const Level& level, const Piece& piece) const {
  const std::size_t b = level.first_block + piece.side / 2;
  const LowRankBlock& block = matrix_.blocks[b];
  const Eigen::MatrixXf& all = piece.side % 2 == 0 ? block.left : block.right;
  if (!quantised_) return all.middleRows(piece.first, piece.count).cast<double>();
  return side_integers(block, quantised_->blocks[b], all, piece.first, piece.count).cast<double>();
}

MatrixXd HodlrView::scaled_rows(const Level& level, const Piece& piece) const {
  MatrixXd rows = plain_rows(level, piece);
  scale(false, rows, piece.begin);
  return rows;
}

VectorXd HodlrView::middle(std::size_t block) const {
  const LowRankBlock& terms = matrix_.blocks[block];
  if (!quantised_) return terms.singular.cast<double>();
  const QuantisedBlock& quantised = quantised_->blocks[block];
  const double step = quantised.step;
  return step * step * kept_singular(terms, quantised).cast<double>().cwiseInverse();
}

void HodlrView::scale(bool transposed, Eigen::Ref<MatrixXd> rows, Eigen::Index begin) const {
  for (Eigen::Index r = 0; r < rows.rows(); r += 3) {
    const Eigen::Matrix3d& stored = scales_[std::size_t((begin + r) / 3)];
    const Eigen::Matrix3d l = transposed ? Eigen::Matrix3d(stored.transpose()) : stored;
    rows.middleRows<3>(r) = (l * rows.middleRows<3>(r)).eval();
  }
}

MatrixXd HodlrView::scaled_leaf(std::size_t leaf) const {
  const Eigen::MatrixXf& sampled = matrix_.leaves[leaf];
  MatrixXd out = sampled.cast<double>();
  if (quantised_) {
    const float step = quantised_->leaf_step[leaf];
    out = double(step) * leaf_integers(sampled, step).cast<double>();
  }
  const Eigen::Index begin = 3 * Eigen::Index{leaf_range(leaf).begin};
  scale(false, out, begin);
  out.transposeInPlace();
  scale(false, out, begin);
  return 0.5 * (out + out.transpose());
}

void HodlrView::add_product(double factor, const MatrixXd& x, MatrixXd& y) const {
  for (Eigen::Index c = 0; c < x.cols(); c += product_columns) {
    const Eigen::Index count = std::min(product_columns, x.cols() - c);
    add_blocks(factor, x.middleCols(c, count), y.middleCols(c, count));
  }
  pool_.run(matrix_.leaves.size(), [&](std::size_t leaf, unsigned) {
    const Eigen::Index begin = 3 * Eigen::Index{leaf_range(leaf).begin};
    const MatrixXd own = scaled_leaf(leaf);
    y.middleRows(begin, own.rows()).noalias() += factor * (own * x.middleRows(begin, own.rows()));
  });
}

void HodlrView::add_blocks(double factor, const Eigen::Ref<const MatrixXd>& x,
                           Eigen::Ref<MatrixXd> y) const {
  MatrixXd forces = x, image = MatrixXd::Zero(x.rows(), x.cols());
  scale(true, forces, 0);
  for (const Level& level : levels_) {
    std::vector<MatrixXd> inner(level.pieces.size()), sums(level.side_begin.size() - 1);
    pool_.run(inner.size(), [&](std::size_t p, unsigned) {
      const Piece& piece = level.pieces[p];
      inner[p].noalias() =
          plain_rows(level, piece).transpose() * forces.middleRows(piece.begin, piece.count);
    });
    for (std::size_t s = 0; s < sums.size(); ++s) {
      MatrixXd sum = std::move(inner[level.side_begin[s]]);
      for (std::size_t p = level.side_begin[s] + 1; p < level.side_begin[s + 1]; ++p) sum += inner[p];
      sums[s] = (factor * middle(level.first_block + s / 2)).asDiagonal() * sum;
    }
    pool_.run(inner.size(), [&](std::size_t p, unsigned) {
      const Piece& piece = level.pieces[p];
      image.middleRows(piece.begin, piece.count).noalias() +=
          plain_rows(level, piece) * sums[piece.side ^ 1];
    });
  }
  scale(false, image, 0);
  y += image;
}

// The squared norms of the rows of S_I L M (S_J R)^T are the diagonal of (S_I L M) G (S_I L M)^T, G the
// Gram matrix of S_J R.
void HodlrView::add_squares(const Level& level, VectorXd& squares) const {
  std::vector<MatrixXd> gram(level.side_begin.size() - 1);
  pool_.run(gram.size(), [&](std::size_t s, unsigned) {
    for (std::size_t p = level.side_begin[s]; p < level.side_begin[s + 1]; ++p) {
      const MatrixXd rows = scaled_rows(level, level.pieces[p]);
      if (p == level.side_begin[s]) gram[s].setZero(rows.cols(), rows.cols());
      gram[s].noalias() += rows.transpose() * rows;
    }
  });
  pool_.run(level.pieces.size(), [&](std::size_t p, unsigned) {
    const Piece& piece = level.pieces[p];
    const MatrixXd rows =
        scaled_rows(level, piece) * middle(level.first_block + piece.side / 2).asDiagonal();
    squares.segment(piece.begin, piece.count) +=
        (rows * gram[piece.side ^ 1]).cwiseProduct(rows).rowwise().sum();
  });
}

VectorXd HodlrView::column_norms() const {
  VectorXd squares = VectorXd::Zero(size());
  for (const Level& level : levels_) add_squares(level, squares);
  pool_.run(matrix_.leaves.size(), [&](std::size_t leaf, unsigned) {
    const MatrixXd own = scaled_leaf(leaf);
    squares.segment(3 * Eigen::Index{leaf_range(leaf).begin}, own.rows()) +=
        own.colwise().squaredNorm().transpose();
  });
  return squares.cwiseMax(0).cwiseSqrt();
}

}  // namespace souple
