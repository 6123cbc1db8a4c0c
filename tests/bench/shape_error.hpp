// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <Eigen/Geometry>
#include <Eigen/SVD>
#include <span>

#include "runtime/fem/linear_algebra.hpp"

namespace souple::bench {

using Points = Eigen::Matrix3Xd;

inline Points as_matrix(std::span<const Point> points) {
  return Eigen::Map<const Points>(points.front().data(), 3, Eigen::Index(points.size()));
}

/// The rest shape moved rigidly as near to `x` as possible (Kabsch).
inline Points best_rigid_fit(const Points& rest, const Points& x) {
  const Vec3 rest_mean = rest.rowwise().mean(), mean = x.rowwise().mean();
  const Mat3 covariance = (x.colwise() - mean) * (rest.colwise() - rest_mean).transpose();
  const Eigen::JacobiSVD<Mat3> svd(covariance, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Mat3 flip = Mat3::Identity();
  flip(2, 2) = (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0 ? -1 : 1;
  const Mat3 rotation = svd.matrixU() * flip * svd.matrixV().transpose();
  return (rotation * (rest.colwise() - rest_mean)).colwise() + mean;
}

/// ||x - x_ref|| over ||x_ref - best rigid fit of the rest shape||.
inline double shape_error(const Points& x, const Points& x_ref, const Points& rest) {
  return (x - x_ref).norm() / (x_ref - best_rigid_fit(rest, x_ref)).norm();
}

}  // namespace souple::bench
