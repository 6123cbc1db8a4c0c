// SPDX-License-Identifier: MIT
#pragma once
#include <Eigen/Core>
#include <vector>

#include "runtime/compliance/rest_compliance.hpp"

namespace souple::test {

/// A compliance from any symmetric matrix, by the contract and nothing else: a low-rank one stands in
/// for a compressed representation. Counts what is asked of it.
class FakeCompliance final : public RestCompliance {
 public:
  explicit FakeCompliance(const Eigen::MatrixXd& c) : c_(c) {}

  Index row_count() const override { return Index(c_.rows() / 3); }
  bool ready(std::span<const Index> rows) const override {
    for (const Index row : rows)
      if (row == missing_row) return false;
    return true;
  }
  void gather(std::span<const Index> rows, std::span<double> out) const override {
    for (std::size_t i = 0; i < 3 * rows.size(); ++i)
      for (std::size_t j = 0; j < 3 * rows.size(); ++j)
        out[i * 3 * rows.size() + j] = value(rows, i, rows, j);
  }
  void gather_block(std::span<const Index> rows, std::span<const Index> columns, float* out,
                    std::size_t stride, ComplianceWork&) const override {
    evaluated += rows.size() * columns.size();
    for (std::size_t i = 0; i < 3 * rows.size(); ++i)
      for (std::size_t j = 0; j < 3 * columns.size(); ++j)
        out[i * stride + j] = float(value(rows, i, columns, j));
  }
  void apply(std::span<const Index> rows, std::span<const double> force, std::span<double> displacement,
             ComplianceWork&) const override {
    Eigen::VectorXd f = Eigen::VectorXd::Zero(c_.rows());
    for (std::size_t k = 0; k < force.size(); ++k) f[at(rows, k)] += force[k];
    Eigen::Map<Eigen::VectorXd>(displacement.data(), Eigen::Index(displacement.size())) = c_ * f;
  }
  Index order_of(Index row) const override { return backwards ? row_count() - 1 - row : row; }
  std::size_t resident_bytes() const override { return std::size_t(c_.size()) * sizeof(double); }

  bool backwards = false;             ///< order_of
  Index missing_row = -1;             ///< not in memory
  mutable std::size_t evaluated = 0;  ///< 3x3 blocks so far

 private:
  static Eigen::Index at(std::span<const Index> rows, std::size_t k) {
    return Eigen::Index(3 * std::size_t(rows[k / 3]) + k % 3);
  }
  double value(std::span<const Index> rows, std::size_t i, std::span<const Index> columns,
               std::size_t j) const {
    return c_(at(rows, i), at(columns, j));
  }

  Eigen::MatrixXd c_;
};

/// Symmetric, positive semi-definite, of this rank; exactly symmetric.
inline Eigen::MatrixXd random_compliance(Index node_count, Index rank, unsigned seed) {
  std::srand(seed);
  const Eigen::MatrixXd factor = Eigen::MatrixXd::Random(3 * node_count, rank);
  const Eigen::MatrixXd c = factor * factor.transpose();
  return 0.5 * (c + c.transpose());
}

}  // namespace souple::test
