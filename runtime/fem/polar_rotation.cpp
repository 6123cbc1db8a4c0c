// SPDX-License-Identifier: MIT
#include "runtime/fem/polar_rotation.hpp"

#include <Eigen/SVD>
#include <cmath>

namespace souple {
namespace {

// Smallest det f / ||f||^3 for the Newton iteration; a rotation has 1 / 3^1.5 = 0.19.
constexpr double newton_min_relative_det = 1e-4;

Mat3 cofactor(const Mat3& m) {
  Mat3 c;
  c.col(0) = m.col(1).cross(m.col(2));
  c.col(1) = m.col(2).cross(m.col(0));
  c.col(2) = m.col(0).cross(m.col(1));
  return c;
}

// Scaled Newton iteration X <- (g X + X^-T / g) / 2 (Higham 1986): quadratic, 5 steps as a rule.
bool newton_rotation(const Mat3& f, Mat3& rotation) {
  Mat3 x = f;
  for (int iteration = 0; iteration < 20; ++iteration) {
    const Mat3 c = cofactor(x);
    const double det = x.col(0).dot(c.col(0));
    const Mat3 inverse_transpose = c / det;
    const double scale = std::sqrt(inverse_transpose.norm() / x.norm());
    const Mat3 next = 0.5 * (scale * x + inverse_transpose / scale);
    const double change = (next - x).squaredNorm();
    x = next;
    // The error after this step is about change^2: 1e-7 leaves it at round-off.
    if (change < 1e-14) {
      rotation = x;
      return true;
    }
  }
  return false;
}

Mat3 svd_rotation(const Mat3& f) {
  const Eigen::JacobiSVD<Mat3> svd(f, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Mat3 u = svd.matrixU();
  if ((u * svd.matrixV().transpose()).determinant() < 0) u.col(2) = -u.col(2);
  return u * svd.matrixV().transpose();
}

}  // namespace

Mat3 polar_rotation(const Mat3& f) {
  const double norm = f.norm();
  Mat3 rotation;
  if (f.determinant() > newton_min_relative_det * norm * norm * norm && newton_rotation(f, rotation))
    return rotation;
  return svd_rotation(f);
}

}  // namespace souple
