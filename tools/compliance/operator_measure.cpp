// SPDX-License-Identifier: GPL-3.0-or-later
// Products with C are solves, so few are made: the search measures against the sampled blocks, which
// are close to C, and only the certificate against C.
#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <optional>
#include <random>

#include "tools/compliance/error_measure.hpp"
#include "tools/compliance/extreme_eigenvalues.hpp"
#include "tools/compliance/hodlr_view.hpp"

namespace souple {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr Eigen::Index probe_count = 64, lanczos_columns = 8;
constexpr int search_steps = 3, certificate_steps = 8;
constexpr double frobenius_margin = 1.05, column_margin = 1.25, lanczos_margin = 1.1;

MatrixXd random_signs(Eigen::Index rows, Eigen::Index columns) {
  std::mt19937 random(41);
  MatrixXd signs(rows, columns);
  for (Eigen::Index k = 0; k < signs.size(); ++k) signs.data()[k] = random() % 2 == 0 ? 1 : -1;
  return signs;
}

class OperatorMeasure final : public ErrorMeasure {
 public:
  OperatorMeasure(const HodlrMatrix& matrix, const SymmetricOperator& exact, ErrorNorm norm,
                  WorkerPool& pool)
      : order_(matrix.order),
        exact_(exact),
        norm_(norm),
        matrix_(matrix),
        pool_(pool),
        sampled_(matrix, nullptr, pool),
        scales_(ordered_scales(matrix)),
        column_norms_(sampled_.column_norms()),
        signs_(random_signs(size(), probe_count)) {
    for (std::size_t leaf = 0; leaf < matrix.leaves.size(); ++leaf) {
      const MatrixXd own = sampled_.scaled_leaf(leaf);
      for (Eigen::Index a = 0; 3 * a < own.rows(); ++a)
        diagonal_factors_.push_back(Eigen::Matrix3d(own.block<3, 3>(3 * a, 3 * a)).llt().matrixL());
    }
    floor_ = exact.least_share(scales_by_row());
    sampled_signs_ = MatrixXd::Zero(size(), probe_count);
    sampled_.add_product(1, signs_, sampled_signs_);
  }

  void set_stored(const QuantisedMatrix& stored) override { stored_.emplace(matrix_, &stored, pool_); }

  ComplianceError estimate(double shift) override {
    return measure(shift, sampled_signs_, search_steps, norm_ == ErrorNorm::scaled_spectral,
                   [&](const MatrixXd& x, MatrixXd& y) { sampled_.add_product(1, x, y); });
  }

  ComplianceError certify(double shift) override {
    if (exact_signs_.size() == 0) exact_signs_ = apply_exact(signs_);
    return measure(shift, exact_signs_, certificate_steps, true,
                   [&](const MatrixXd& x, MatrixXd& y) { y += apply_exact(x); });
  }

  double shift_above() override {
    return shift_over([&](const MatrixXd& x, MatrixXd& y) { y += apply_exact(x); }, certificate_steps);
  }

  double guessed_shift() override {
    return shift_over([&](const MatrixXd& x, MatrixXd& y) { sampled_.add_product(1, x, y); },
                      search_steps);
  }

  bool knows_floor() const override { return floor_ > 0; }

  const VectorXd& column_norms() const override { return column_norms_; }

 private:
  Eigen::Index size() const { return 3 * Eigen::Index(order_.size()); }

  std::vector<Eigen::Matrix3d> scales_by_row() const {
    std::vector<Eigen::Matrix3d> scales(order_.size());
    for (std::size_t p = 0; p < order_.size(); ++p) scales[std::size_t(order_[p])] = scales_[p];
    return scales;
  }

  // The operator counts rows, we positions.
  MatrixXd apply_exact(const MatrixXd& x) const {
    MatrixXd by_row(x.rows(), x.cols()), image = MatrixXd::Zero(x.rows(), x.cols()),
                                         y(x.rows(), x.cols());
    for (std::size_t p = 0; p < order_.size(); ++p)
      by_row.middleRows<3>(3 * Eigen::Index{order_[p]}) = x.middleRows<3>(3 * Eigen::Index(p));
    exact_.apply(by_row, image);
    for (std::size_t p = 0; p < order_.size(); ++p)
      y.middleRows<3>(3 * Eigen::Index(p)) = image.middleRows<3>(3 * Eigen::Index{order_[p]});
    return y;
  }

  template <class AddReference>
  double shift_over(const AddReference& add_reference, int steps) const {
    const EigenvalueRange range = eigenvalues(
        [&](const MatrixXd& x, MatrixXd& y) {
          y.setZero(x.rows(), x.cols());
          add_reference(x, y);
          stored_->add_product(-1, x, y);
        },
        scales_, 0, steps);
    return std::max(0.0, lanczos_margin * range.largest - floor_);
  }

  template <class AddReference>
  ComplianceError measure(double shift, const MatrixXd& reference_signs, int steps, bool with_spectral,
                          const AddReference& add_reference) const {
    const auto difference = [&](const MatrixXd& x, MatrixXd& y) {
      y.setZero(x.rows(), x.cols());
      add_reference(x, y);
      stored_->add_product(-1, x, y);
    };
    ComplianceError error;
    MatrixXd image = reference_signs;
    stored_->add_product(-1, signs_, image);
    add_shift(-shift, signs_, image);
    const VectorXd squares = image.rowwise().squaredNorm() / double(probe_count);
    error.frobenius = frobenius_margin * std::sqrt(squares.sum()) / column_norms_.norm();
    error.worst_column = column_margin * squares.cwiseSqrt().cwiseQuotient(column_norms_).maxCoeff();
    if (with_spectral) {
      const EigenvalueRange total = eigenvalues(difference, diagonal_factors_, shift, steps);
      error.scaled_spectral =
          lanczos_margin * std::max(std::abs(total.smallest), std::abs(total.largest));
    }
    return error;
  }

  void add_shift(double shift, const MatrixXd& x, MatrixXd& y) const {
    for (std::size_t a = 0; a < scales_.size(); ++a)
      y.middleRows<3>(3 * Eigen::Index(a)) +=
          shift * (scales_[a] * (scales_[a].transpose() * x.middleRows<3>(3 * Eigen::Index(a))));
  }

  template <class Difference>
  EigenvalueRange eigenvalues(const Difference& difference, const std::vector<Eigen::Matrix3d>& factors,
                              double shift, int steps) const {
    return extreme_eigenvalues(
        [&](const MatrixXd& x, MatrixXd& y) {
          MatrixXd scaled = x;
          for (std::size_t a = 0; a < factors.size(); ++a)
            factors[a].transpose().triangularView<Eigen::Upper>().solveInPlace(
                scaled.middleRows<3>(3 * Eigen::Index(a)));
          difference(scaled, y);
          add_shift(-shift, scaled, y);
          for (std::size_t a = 0; a < factors.size(); ++a)
            factors[a].triangularView<Eigen::Lower>().solveInPlace(
                y.middleRows<3>(3 * Eigen::Index(a)));
        },
        size(), lanczos_columns, steps);
  }

  const std::vector<Index> order_;
  const SymmetricOperator& exact_;
  const ErrorNorm norm_;
  const HodlrMatrix& matrix_;
  WorkerPool& pool_;
  const HodlrView sampled_;
  const std::vector<Eigen::Matrix3d> scales_;
  const VectorXd column_norms_;
  const MatrixXd signs_;
  double floor_ = 0;  ///< C - floor S S^T is positive semi-definite
  std::optional<HodlrView> stored_;
  MatrixXd sampled_signs_, exact_signs_;
  std::vector<Eigen::Matrix3d> diagonal_factors_;
};

}  // namespace

std::unique_ptr<ErrorMeasure> make_operator_measure(const HodlrMatrix& matrix,
                                                    const SymmetricOperator& exact, ErrorNorm norm,
                                                    WorkerPool& pool) {
  return std::make_unique<OperatorMeasure>(matrix, exact, norm, pool);
}

}  // namespace souple
