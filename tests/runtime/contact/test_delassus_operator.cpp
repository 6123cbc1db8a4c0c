// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <random>
#include <vector>

#include "runtime/contact/contact.hpp"
#include "runtime/contact/delassus_operator.hpp"

namespace souple {
namespace {

using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

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

TEST(DelassusOperator, EqualsTheExplicitTripleProductWithWarpedCompliance) {
  std::mt19937 random(2);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform(0, 1);
  const int nodes = 7, contacts = 5;
  Matrix c0 = Matrix::NullaryExpr(3 * nodes, 3 * nodes, [&] { return normal(random); });
  c0 = (c0 * c0.transpose()).eval();
  std::vector<Mat3> rotations, frames;
  for (int k = 0; k < nodes; ++k)
    rotations.push_back(
        Eigen::Quaterniond(normal(random), normal(random), normal(random), normal(random))
            .normalized()
            .toRotationMatrix());
  for (int k = 0; k < contacts; ++k)
    frames.push_back(contact_frame(Vec3(normal(random), normal(random), normal(random)).normalized()));
  std::vector<Touch> touches;
  Matrix h = Matrix::Zero(3 * contacts, 3 * nodes), r = Matrix::Zero(3 * nodes, 3 * nodes);
  for (int k = 0; k < nodes; ++k) r.block<3, 3>(3 * k, 3 * k) = rotations[std::size_t(k)];
  for (int i = 0; i < contacts; ++i)
    for (int k = 0; k < 1 + i % 3; ++k) {
      const Index node = Index((2 * i + 3 * k) % nodes);
      const double weight = (i % 2 ? -1 : 1) * uniform(random);
      touches.push_back({Index(i), node, weight});
      h.block<3, 3>(3 * i, 3 * node) += weight * frames[std::size_t(i)].transpose();
    }
  const Matrix expected = h * r * c0 * r.transpose() * h.transpose();

  warp_compliance(rotations, {c0.data(), std::size_t(c0.size())});
  Matrix w = Matrix::Zero(3 * contacts, 3 * contacts);
  std::vector<double> work(9 * nodes);
  add_to_delassus(touches, frames, {c0.data(), std::size_t(c0.size())}, contacts,
                  {w.data(), std::size_t(w.size())}, work);
  mirror_delassus(contacts, {w.data(), std::size_t(w.size())});
  EXPECT_LT((w - expected).norm() / expected.norm(), 1e-13);
  EXPECT_EQ((w - w.transpose()).norm(), 0);
}

}  // namespace
}  // namespace souple
