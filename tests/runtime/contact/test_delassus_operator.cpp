// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <random>
#include <vector>

#include "runtime/contact/contact.hpp"
#include "runtime/contact/delassus_operator.hpp"

namespace souple {
namespace {

using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

DelassusTarget<double> target(Matrix& w) { return {w.data(), std::size_t(w.cols())}; }

TEST(ContactFrame, IsOrthonormalWithTheNormalFirst) {
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  for (int k = 0; k < 100; ++k) {
    const Vec3 n = Vec3(normal(random), normal(random), normal(random)).normalized();
    const Mat3 frame = contact_frame(n);
    EXPECT_LT((frame.transpose() * frame - Mat3::Identity()).norm(), 1e-14);
    EXPECT_EQ(frame.col(0), n);
  }
}

// Some contacts of a body, nodes shared between them, and the same as matrices.
struct Fixture {
  static constexpr int nodes = 7, contacts = 5;
  std::mt19937 random{2};
  std::normal_distribution<double> normal;
  Matrix c0, h = Matrix::Zero(3 * contacts, 3 * nodes), r = Matrix::Zero(3 * nodes, 3 * nodes);
  std::vector<Mat3> rotations, frames;
  std::vector<Touch> touches;

  Fixture() {
    c0 = Matrix::NullaryExpr(3 * nodes, 3 * nodes, [&] { return normal(random); });
    c0 = (c0 * c0.transpose()).eval();
    for (int k = 0; k < nodes; ++k) {
      rotations.push_back(
          Eigen::Quaterniond(normal(random), normal(random), normal(random), normal(random))
              .normalized()
              .toRotationMatrix());
      r.block<3, 3>(3 * k, 3 * k) = rotations.back();
    }
    std::uniform_real_distribution<double> uniform(0, 1);
    for (int i = 0; i < contacts; ++i) {
      frames.push_back(
          contact_frame(Vec3(normal(random), normal(random), normal(random)).normalized()));
      for (int k = 0; k < 1 + i % 3; ++k) {
        const Index node = Index((2 * i + 3 * k) % nodes);
        const double weight = (i % 2 ? -1 : 1) * uniform(random);
        touches.push_back({Index(i), node, weight});
        h.block<3, 3>(3 * i, 3 * node) += weight * frames.back().transpose();
      }
    }
  }

  /// The operator with C0 stored in these slots, blocks above the diagonal missing.
  template <class Scalar>
  Matrix delassus(const std::vector<Index>& slots, double factor) const {
    const std::size_t stride = 3 * nodes + 5;
    std::vector<Scalar> stored(3 * nodes * stride, Scalar(NAN));
    for (std::size_t a = 0; a < 3 * nodes; ++a)
      for (std::size_t b = 0; b < 3 * nodes; ++b)
        if (slots[b / 3] <= slots[a / 3])
          stored[(3 * std::size_t(slots[a / 3]) + a % 3) * stride + 3 * std::size_t(slots[b / 3]) +
                 b % 3] = Scalar(c0(Eigen::Index(a), Eigen::Index(b)));
    Matrix w = Matrix::Zero(3 * contacts, 3 * contacts);
    DelassusWork<Scalar> work;
    add_to_delassus<Scalar>({touches, frames, rotations}, {stored.data(), stride, slots}, factor,
                            target(w), work);
    mirror_delassus(contacts, target(w));
    return w;
  }
};

TEST(DelassusOperator, EqualsTheExplicitTripleProductWithWarpedCompliance) {
  const Fixture f;
  const Matrix expected = 1.5 * f.h * f.r * f.c0 * f.r.transpose() * f.h.transpose();
  const std::vector<Index> slots{0, 1, 2, 3, 4, 5, 6};
  const Matrix w = f.delassus<double>(slots, 1.5), single = f.delassus<float>(slots, 1.5);
  EXPECT_LT((w - expected).norm() / expected.norm(), 1e-13);
  EXPECT_LT((single - expected).norm() / expected.norm(), 1e-6);
  EXPECT_EQ((w - w.transpose()).norm(), 0);
  EXPECT_EQ((single - single.transpose()).norm(), 0);
}

TEST(DelassusOperator, DependsOnTheSlotsByRoundingOnly) {
  const Fixture f;
  const Matrix some = f.delassus<double>({0, 1, 2, 3, 4, 5, 6}, 1),
               others = f.delassus<double>({3, 6, 0, 5, 1, 2, 4}, 1);
  EXPECT_LT((some - others).norm() / some.norm(), 1e-13);
  EXPECT_EQ(f.delassus<float>({3, 6, 0, 5, 1, 2, 4}, 1), f.delassus<float>({3, 6, 0, 5, 1, 2, 4}, 1));
}

TEST(DelassusOperator, AddsTheRigidPartLikeTheExplicitProduct) {
  const Fixture f;
  std::vector<Point> rest;
  std::vector<Vec3> points;
  for (int k = 0; k < Fixture::nodes; ++k) {
    points.emplace_back(0.1 * k, 0.05 * (k % 3), 0.03 * (k % 2));
    rest.push_back(as_point(points.back()));
  }
  const RigidModes modes(rest, std::vector<double>(rest.size(), 0.2));
  Matrix rigid(3 * Fixture::nodes, 3 * Fixture::nodes);
  for (int a = 0; a < Fixture::nodes; ++a)
    for (int b = 0; b < Fixture::nodes; ++b)
      rigid.block<3, 3>(3 * a, 3 * b) = modes.block(points[std::size_t(a)], points[std::size_t(b)]);
  const Matrix expected = -0.7 * f.h * f.r * rigid * f.r.transpose() * f.h.transpose();
  Matrix w = Matrix::Zero(expected.rows(), expected.cols());
  DelassusWork<double> work;
  add_rigid_to_delassus({f.touches, f.frames, f.rotations}, modes, points, -0.7, target(w), work);
  mirror_delassus(Fixture::contacts, target(w));
  EXPECT_LT((w - expected).norm() / expected.norm(), 1e-13);
}

TEST(DelassusOperator, MirrorsEverySize) {
  for (const std::size_t count : {1, 2, 5, 6, 11, 16, 17}) {
    const auto size = Eigen::Index(3 * count);
    Matrix w = Matrix::Zero(size, size);
    for (Eigen::Index i = 0; i < size; ++i)
      for (Eigen::Index j = 0; j <= i; ++j) w(i, j) = double(100 * i + j + 1);
    const Matrix lower = w.triangularView<Eigen::Lower>();
    mirror_delassus(count, target(w));
    EXPECT_EQ(w, w.transpose());
    EXPECT_EQ(Matrix(w.triangularView<Eigen::Lower>()), lower);
  }
}

}  // namespace
}  // namespace souple
