// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <Eigen/SVD>
#include <random>

#include "runtime/fem/polar_rotation.hpp"

namespace souple {
namespace {

Mat3 random_matrix(std::mt19937& random, double size = 1) {
  std::normal_distribution<double> normal(0, size);
  Mat3 m;
  for (int i = 0; i < 9; ++i) m.data()[i] = normal(random);
  return m;
}

Mat3 random_rotation(std::mt19937& random) {
  std::normal_distribution<double> normal;
  return Eigen::Quaterniond(normal(random), normal(random), normal(random), normal(random))
      .normalized()
      .toRotationMatrix();
}

void expect_rotation(const Mat3& r) {
  EXPECT_LT((r.transpose() * r - Mat3::Identity()).norm(), 1e-12);
  EXPECT_GT(r.determinant(), 0.5);
}

TEST(PolarRotation, IsTheOrthogonalFactorOfThousandRandomMatrices) {
  std::mt19937 random(1);
  for (int k = 0; k < 1000; ++k) {
    Mat3 f = random_matrix(random);
    if (f.determinant() < 0) f.col(0) = -f.col(0);
    const Eigen::JacobiSVD<Mat3> svd(f, Eigen::ComputeFullU | Eigen::ComputeFullV);
    if (svd.singularValues()[2] < 1e-3) continue;
    const Mat3 expected = svd.matrixU() * svd.matrixV().transpose();
    EXPECT_LT((polar_rotation(f) - expected).norm(), 1e-10) << f;
  }
}

TEST(PolarRotation, ReturnsARotationUnchanged) {
  std::mt19937 random(2);
  for (int k = 0; k < 200; ++k) {
    const Mat3 r = random_rotation(random);
    EXPECT_LT((polar_rotation(r) - r).norm(), 1e-14);
  }
}

TEST(PolarRotation, TurnsWithItsArgument) {
  std::mt19937 random(3);
  for (int k = 0; k < 200; ++k) {
    const Mat3 r = random_rotation(random), f = Mat3::Identity() + random_matrix(random, 0.2);
    EXPECT_LT((polar_rotation(r * f) - r * polar_rotation(f)).norm(), 1e-11);
  }
}

TEST(PolarRotation, StaysARotationForFlatInvertedAndZeroMatrices) {
  std::mt19937 random(4);
  expect_rotation(polar_rotation(Mat3::Zero()));
  expect_rotation(polar_rotation(-Mat3::Identity()));
  expect_rotation(polar_rotation(Vec3(1, 1, 0).asDiagonal()));
  expect_rotation(polar_rotation(Vec3(1, 0, 0).asDiagonal()));
  for (int k = 0; k < 500; ++k) {
    Mat3 f = random_matrix(random);
    if (f.determinant() > 0) f.col(0) = -f.col(0);
    expect_rotation(polar_rotation(f));
    f.col(2) = f.col(0) + f.col(1);
    expect_rotation(polar_rotation(f));
    expect_rotation(polar_rotation(1e-200 * random_matrix(random)));
    expect_rotation(polar_rotation(1e+100 * random_matrix(random)));
  }
}

TEST(PolarRotation, IsContinuousWhereAnElementInverts) {
  // Squeezed along z through zero: the rotation stays the identity.
  for (const double s : {1e-1, 1e-3, 1e-6, -1e-6, -1e-3, -1e-1})
    EXPECT_LT((polar_rotation(Vec3(1.2, 1.0, s).asDiagonal()) - Mat3::Identity()).norm(), 1e-9) << s;
}

}  // namespace
}  // namespace souple
