// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <Eigen/Core>

#include "tools/compliance/symmetric_source.hpp"

namespace souple::test {

/// A matrix in memory as a source and as an operator.
class DenseSource final : public SymmetricSource, public SymmetricOperator {
 public:
  explicit DenseSource(Eigen::MatrixXd c) : c_(std::move(c)) {}

  Index node_count() const override { return Index(c_.rows() / 3); }
  void read(std::span<const Index> rows, std::span<const Index> columns,
            Eigen::Ref<Eigen::MatrixXf> out) const override {
    read_as(rows, columns, out);
  }
  void read(std::span<const Index> rows, std::span<const Index> columns,
            Eigen::Ref<Eigen::MatrixXd> out) const override {
    read_as(rows, columns, out);
  }
  void apply(const Eigen::Ref<const Eigen::MatrixXd>& x, Eigen::Ref<Eigen::MatrixXd> y) const override {
    y.noalias() = c_ * x;
  }
  const Eigen::MatrixXd& matrix() const { return c_; }

 private:
  template <class Out>
  void read_as(std::span<const Index> rows, std::span<const Index> columns, Out& out) const {
    for (std::size_t a = 0; a < rows.size(); ++a)
      for (std::size_t b = 0; b < columns.size(); ++b)
        out.template block<3, 3>(3 * Eigen::Index(a), 3 * Eigen::Index(b)) =
            c_.block<3, 3>(3 * rows[a], 3 * columns[b]).cast<typename Out::Scalar>();
  }

  Eigen::MatrixXd c_;
};

}  // namespace souple::test
