// SPDX-License-Identifier: MIT
#include "runtime/fem/integer_products.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <limits>
#include <random>

namespace souple {
namespace {

constexpr float nan_value = std::numeric_limits<float>::quiet_NaN();

struct Stored {
  PackedValues values;
  IntegerBlock block;

  explicit Stored(const Eigen::MatrixXd& matrix) {
    block = append_integers(matrix, values);
    block.values = values.data();
  }
};

Eigen::MatrixXd random_matrix(Eigen::Index rows, Eigen::Index columns, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  return Eigen::MatrixXd::NullaryExpr(rows, columns, [&] { return normal(random); });
}

// M x and M^T x as the block gives them; entries behind the last are kept in view.
Eigen::VectorXf product(const Stored& m, const Eigen::VectorXf& x) {
  Eigen::VectorXf y = Eigen::VectorXf::Zero(Eigen::Index(m.block.rows_padded()));
  std::vector<float> scratch(integer_scratch(m.block.columns));
  add_product(m.block, x.data(), y.data(), scratch.data());
  return y;
}

Eigen::VectorXf transposed_product(const Stored& m, const Eigen::VectorXf& x) {
  Eigen::VectorXf y = Eigen::VectorXf::Zero(Eigen::Index(m.block.columns) + 1);
  std::vector<float> scratch(integer_scratch(m.block.rows));
  subtract_transposed_product(m.block, x.data(), y.data(), scratch.data());
  return -y;
}

TEST(IntegerProducts, AgreeWithDoublesForEveryShape) {
  for (const Eigen::Index rows : {1, 3, 15, 16, 17, 48, 105})
    for (const Eigen::Index columns : {1, 3, 4, 6, 7, 8, 9, 15, 24}) {
      const Eigen::MatrixXd m = random_matrix(rows, columns, unsigned(31 * rows + columns));
      const Stored stored(m);
      ASSERT_EQ(stored.values.size(), stored.block.rows_padded() * std::size_t((columns + 1) / 2 * 2));
      const Eigen::VectorXf x = random_matrix(columns, 1, 5).cast<float>();
      const Eigen::VectorXf z = random_matrix(rows, 1, 6).cast<float>();
      const Eigen::VectorXd y = m * x.cast<double>(), w = m.transpose() * z.cast<double>();
      const Eigen::VectorXf got = product(stored, x), got_w = transposed_product(stored, z);
      const double size = m.cwiseAbs().maxCoeff();
      const auto bound = [&](Eigen::Index count, const Eigen::VectorXf& factor) {
        return 2e-4 * size * std::sqrt(double(count)) * factor.cwiseAbs().maxCoeff();
      };
      EXPECT_LT((got.head(rows).cast<double>() - y).cwiseAbs().maxCoeff(), bound(columns, x));
      EXPECT_LT((got_w.head(columns).cast<double>() - w).cwiseAbs().maxCoeff(), bound(rows, z));
      EXPECT_EQ(got.tail(got.size() - rows).cwiseAbs().sum(), 0) << "padding stays zero";
      EXPECT_EQ(got_w[columns], 0) << "nothing is written behind the last column";
    }
}

// All entries as large as the largest, all of one sign: the sums that come nearest to 32 bits.
TEST(IntegerProducts, DoNotOverflowWhenEverythingIsAtItsLargest) {
  for (const Eigen::Index size : {8, 300, 2000}) {
    const Stored stored(Eigen::MatrixXd::Constant(size, size, -3e5));
    const Eigen::VectorXf x = Eigen::VectorXf::Constant(size, 7e-4F);
    const double expected = -3e5 * 7e-4 * double(size);
    const Eigen::VectorXf y = product(stored, x), z = transposed_product(stored, x);
    EXPECT_NEAR(y.head(size).minCoeff(), expected, 1e-2 * -expected);
    EXPECT_NEAR(y.head(size).maxCoeff(), expected, 1e-2 * -expected);
    EXPECT_NEAR(z.head(size).minCoeff(), expected, 1e-2 * -expected);
    EXPECT_NEAR(z.head(size).maxCoeff(), expected, 1e-2 * -expected);
  }
}

TEST(IntegerProducts, DoNothingForZerosAndPassOnWhatIsNotFinite) {
  const Stored zero(Eigen::MatrixXd::Zero(20, 6)), some(random_matrix(20, 6, 1));
  EXPECT_EQ(product(zero, Eigen::VectorXf::Ones(6)).cwiseAbs().sum(), 0);
  EXPECT_EQ(product(some, Eigen::VectorXf::Zero(6)).cwiseAbs().sum(), 0);
  EXPECT_EQ(transposed_product(some, Eigen::VectorXf::Zero(20)).cwiseAbs().sum(), 0);
  for (const float bad : {nan_value, std::numeric_limits<float>::infinity()}) {
    Eigen::VectorXf x = Eigen::VectorXf::Ones(6), z = Eigen::VectorXf::Ones(20);
    x[5] = z[19] = bad;
    EXPECT_FALSE(product(some, x).head(20).allFinite());
    EXPECT_FALSE(transposed_product(some, z).head(6).allFinite());
  }
  const Stored empty(Eigen::MatrixXd(0, 6));
  EXPECT_EQ(empty.values.size(), 0u);
}

TEST(IntegerProducts, KeepTheirPrecisionAtAnyUnit) {
  const Eigen::MatrixXd m = random_matrix(33, 9, 2);
  const Eigen::VectorXf x = random_matrix(9, 1, 3).cast<float>();
  const Eigen::VectorXf one = product(Stored(m), x);
  for (const double unit : {1e-12, 1e12}) {
    const Eigen::VectorXf scaled = product(Stored(unit * m), (1e-6F * x).eval());
    EXPECT_LT((scaled / float(unit * 1e-6) - one).cwiseAbs().maxCoeff(),
              1e-3 * one.cwiseAbs().maxCoeff());
  }
}

}  // namespace
}  // namespace souple
