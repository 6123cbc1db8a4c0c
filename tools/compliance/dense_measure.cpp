// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "tools/compliance/blas_calls.hpp"
#include "tools/compliance/error_measure.hpp"
#include "tools/compliance/extreme_eigenvalues.hpp"

namespace souple {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr Index strip_nodes = 64;
constexpr int search_steps = 12, certificate_steps = 24;
constexpr double lanczos_margin = 1.02;

/// Columns [begin, end) of a block below the diagonal of the tree, or a leaf.
struct Strip {
  ClusterRange rows, columns;  ///< positions
  std::size_t item = 0;        ///< block in heap order, or leaf
  Eigen::Index first = 0;      ///< its first column within the block
  bool is_leaf = false;
};

std::vector<Strip> make_strips(Index count, int depth) {
  std::vector<Strip> strips;
  for (int d = 0; d < depth; ++d)
    for (Index i = 0; i < (Index{1} << d); ++i) {
      const ClusterRange left = cluster_range(count, d + 1, 2 * i);
      const ClusterRange right = cluster_range(count, d + 1, 2 * i + 1);
      for (Index begin = right.begin; begin < right.end; begin += strip_nodes)
        strips.push_back({left,
                          {begin, std::min(begin + strip_nodes, right.end)},
                          std::size_t(block_of_cluster(d, i)),
                          3 * Eigen::Index{begin - right.begin},
                          false});
    }
  for (Index leaf = 0; leaf < (Index{1} << depth); ++leaf) {
    const ClusterRange range = cluster_range(count, depth, leaf);
    strips.push_back({range, range, std::size_t(leaf), 0, true});
  }
  return strips;
}

class DenseMeasure final : public ErrorMeasure {
 public:
  DenseMeasure(const HodlrMatrix& matrix, const SymmetricSource& source, ErrorNorm norm,
               WorkerPool& pool)
      : matrix_(matrix),
        source_(source),
        norm_(norm),
        pool_(pool),
        strips_(make_strips(Index(matrix.order.size()), matrix.depth)),
        difference_(strips_.size()),
        scales_(ordered_scales(matrix)) {
    blas::use_one_thread_per_call();
    measure_source();
  }

  void set_stored(const QuantisedMatrix& stored) override {
    subtract(scaled_hodlr(matrix_, stored, pool_));
  }

  ComplianceError estimate(double shift) override {
    ComplianceError error;
    if (norm_ == ErrorNorm::scaled_spectral)
      error.scaled_spectral = spectral(shift, search_steps);
    else
      fill_sums(shift, error);
    return error;
  }

  ComplianceError certify(double shift) override {
    ComplianceError error;
    fill_sums(shift, error);
    error.scaled_spectral = spectral(shift, certificate_steps);
    return error;
  }

  double shift_above() override {
    return std::max(0.0, lanczos_margin * eigenvalues(scales_, 0, certificate_steps).largest);
  }

  const VectorXd& column_norms() const override { return column_norms_; }

 private:
  Eigen::Index size() const { return 3 * Eigen::Index(matrix_.order.size()); }

  MatrixXd read(const Strip& strip) const {
    const std::span order(matrix_.order);
    MatrixXd c(3 * Eigen::Index{strip.rows.size()}, 3 * Eigen::Index{strip.columns.size()});
    source_.read(order.subspan(std::size_t(strip.rows.begin), std::size_t(strip.rows.size())),
                 order.subspan(std::size_t(strip.columns.begin), std::size_t(strip.columns.size())), c);
    return c;
  }

  // Sums over the entries of every strip, added up in order: by columns and, off the diagonal, by rows.
  template <class SquaresOf>
  VectorXd column_sums(const SquaresOf& squares_of) const {
    std::vector<VectorXd> by_column(strips_.size()), by_row(strips_.size());
    pool_.run(strips_.size(), [&](std::size_t s, unsigned) {
      const MatrixXd squares = squares_of(s);
      by_column[s] = squares.colwise().sum().transpose();
      if (!strips_[s].is_leaf) by_row[s] = squares.rowwise().sum();
    });
    VectorXd sums = VectorXd::Zero(size());
    for (std::size_t s = 0; s < strips_.size(); ++s) {
      sums.segment(3 * Eigen::Index{strips_[s].columns.begin}, by_column[s].size()) += by_column[s];
      if (!strips_[s].is_leaf)
        sums.segment(3 * Eigen::Index{strips_[s].rows.begin}, by_row[s].size()) += by_row[s];
    }
    return sums;
  }

  void measure_source() {
    diagonal_factors_.resize(matrix_.order.size());
    column_norms_ = column_sums([&](std::size_t s) {
                      const MatrixXd c = read(strips_[s]);
                      if (strips_[s].is_leaf) factor_diagonal(c, strips_[s].rows.begin);
                      return MatrixXd(c.cwiseAbs2());
                    }).cwiseSqrt();
  }

  void factor_diagonal(const MatrixXd& leaf, Index first) {
    for (Eigen::Index a = 0; 3 * a < leaf.rows(); ++a) {
      const Eigen::Matrix3d block = leaf.block<3, 3>(3 * a, 3 * a);
      diagonal_factors_[std::size_t(first + a)] = block.llt().matrixL();
    }
  }

  // difference_ = C - S C~ S^T.
  void subtract(const ScaledHodlr& stored) {
    pool_.run(strips_.size(), [&](std::size_t s, unsigned) {
      const Strip& strip = strips_[s];
      MatrixXd c = read(strip);
      if (strip.is_leaf) {
        c -= stored.leaves[strip.item];
      } else {
        const auto& block = stored.blocks[strip.item];
        const MatrixXd right = block.right.middleRows(strip.first, c.cols()).transpose();
        if (right.rows() > 0)
          blas::subtract_product(c.rows(), c.cols(), right.rows(), block.left.data(), c.rows(),
                                 right.data(), right.rows(), c.data(), c.rows());
      }
      difference_[s] = c.cast<float>();
    });
  }

  // Frobenius and columns of the difference less shift S S^T.
  void fill_sums(double shift, ComplianceError& error) const {
    VectorXd squares =
        column_sums([&](std::size_t s) { return MatrixXd(difference_[s].cast<double>().cwiseAbs2()); });
    for (std::size_t s = 0; s < strips_.size(); ++s) {
      if (!strips_[s].is_leaf) continue;
      for (Eigen::Index a = 0; 3 * a < difference_[s].rows(); ++a) {
        const Eigen::Index position = strips_[s].rows.begin + a;
        const auto& l = scales_[std::size_t(position)];
        const Eigen::Matrix3d before = difference_[s].block<3, 3>(3 * a, 3 * a).cast<double>();
        const Eigen::Matrix3d after = before - shift * l * l.transpose();
        squares.segment<3>(3 * position) +=
            (after.colwise().squaredNorm() - before.colwise().squaredNorm()).transpose();
      }
    }
    squares = squares.cwiseMax(0);
    error.frobenius = std::sqrt(squares.sum()) / column_norms_.norm();
    error.worst_column = squares.cwiseSqrt().cwiseQuotient(column_norms_).maxCoeff();
  }

  double spectral(double shift, int steps) const {
    const EigenvalueRange range = eigenvalues(diagonal_factors_, shift, steps);
    return lanczos_margin * std::max(std::abs(range.smallest), std::abs(range.largest));
  }

  // Of L^-1 (difference - shift S S^T) L^-T, L = blockdiag of `factors`.
  EigenvalueRange eigenvalues(const std::vector<Eigen::Matrix3d>& factors, double shift,
                              int steps) const {
    return extreme_eigenvalues(
        [&](const MatrixXd& x, MatrixXd& y) {
          VectorXd scaled = x.col(0);
          for (std::size_t a = 0; a < factors.size(); ++a)
            factors[a].transpose().triangularView<Eigen::Upper>().solveInPlace(
                scaled.segment<3>(3 * Eigen::Index(a)));
          VectorXd image = apply_difference(scaled);
          for (std::size_t a = 0; a < factors.size(); ++a) {
            auto part = image.segment<3>(3 * Eigen::Index(a));
            part -= shift *
                    (scales_[a] * (scales_[a].transpose() * scaled.segment<3>(3 * Eigen::Index(a))));
            factors[a].triangularView<Eigen::Lower>().solveInPlace(part);
          }
          y.col(0) = image;
        },
        size(), 1, steps);
  }

  VectorXd apply_difference(const VectorXd& x) const {
    const Eigen::VectorXf single = x.cast<float>();
    std::vector<Eigen::VectorXf> to_columns(strips_.size()), to_rows(strips_.size());
    pool_.run(strips_.size(), [&](std::size_t s, unsigned) {
      const Strip& strip = strips_[s];
      const auto& e = difference_[s];
      to_columns[s].noalias() =
          e.transpose() * single.segment(3 * Eigen::Index{strip.rows.begin}, e.rows());
      if (!strip.is_leaf)
        to_rows[s].noalias() = e * single.segment(3 * Eigen::Index{strip.columns.begin}, e.cols());
    });
    VectorXd y = VectorXd::Zero(size());
    for (std::size_t s = 0; s < strips_.size(); ++s) {
      y.segment(3 * Eigen::Index{strips_[s].columns.begin}, to_columns[s].size()) +=
          to_columns[s].cast<double>();
      if (!strips_[s].is_leaf)
        y.segment(3 * Eigen::Index{strips_[s].rows.begin}, to_rows[s].size()) +=
            to_rows[s].cast<double>();
    }
    return y;
  }

  const HodlrMatrix& matrix_;
  const SymmetricSource& source_;
  const ErrorNorm norm_;
  WorkerPool& pool_;
  const std::vector<Strip> strips_;
  std::vector<Eigen::MatrixXf> difference_;        ///< of every strip, m/N
  const std::vector<Eigen::Matrix3d> scales_;      ///< S
  std::vector<Eigen::Matrix3d> diagonal_factors_;  ///< Cholesky factors of D
  VectorXd column_norms_;
};

}  // namespace

double error_in(const ComplianceError& error, ErrorNorm norm) {
  switch (norm) {
    case ErrorNorm::frobenius:
      return error.frobenius;
    case ErrorNorm::worst_column:
      return error.worst_column;
    case ErrorNorm::scaled_spectral:
      break;
  }
  return error.scaled_spectral;
}

std::unique_ptr<ErrorMeasure> make_dense_measure(const HodlrMatrix& matrix,
                                                 const SymmetricSource& source, ErrorNorm norm,
                                                 WorkerPool& pool) {
  return std::make_unique<DenseMeasure>(matrix, source, norm, pool);
}

}  // namespace souple
