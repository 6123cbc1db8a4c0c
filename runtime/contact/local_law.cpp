// SPDX-License-Identifier: MIT
#include "runtime/contact/local_law.hpp"

#include <Eigen/Eigenvalues>
#include <cmath>

namespace souple {
namespace {

// Inverse of the symmetric part on the span of its eigenvectors that are not lost in round-off.
Mat3 safe_inverse(const Mat3& block) {
  constexpr double lost = 1e-12;
  const Eigen::SelfAdjointEigenSolver<Mat3> eigen(0.5 * (block + block.transpose()));
  const Vec3& values = eigen.eigenvalues();
  Mat3 inverse = Mat3::Zero();
  for (int k = 0; k < 3; ++k) {
    if (values[k] <= lost * values[2]) continue;
    const Vec3 axis = eigen.eigenvectors().col(k);
    inverse += (1 / values[k]) * axis * axis.transpose();
  }
  return inverse;
}

// 1/x where that is a usable number, 0 otherwise.
double usable_inverse(double x) {
  const double inverse = 1 / x;
  return x > 0 && std::isfinite(inverse) ? inverse : 0;
}

}  // namespace

Vec3 project_onto_cone(const Vec3& r, double friction) {
  const double tangential = r.tail<2>().norm();
  if (tangential <= friction * r[0]) return r;
  if (friction * tangential <= -r[0]) return Vec3::Zero();
  const double normal = (r[0] + friction * tangential) / (1 + friction * friction);
  Vec3 projected(normal, 0, 0);
  if (tangential > 0) projected.tail<2>() = r.tail<2>() * (friction * normal / tangential);
  return projected;
}

LocalLaw::LocalLaw(const ConstraintLaw& law, const Mat3& block)
    : bilateral_(law.kind == ConstraintLaw::Kind::bilateral), friction_(law.friction) {
  if (!block.allFinite() || (!bilateral_ && usable_inverse(block(0, 0)) == 0)) return;
  rho_ = 3 * usable_inverse(block.trace());
  if (bilateral_) {
    if (rho_ > 0) softness_ = law.softness / rho_;
    if (rho_ > 0) inverse_ = safe_inverse(block + softness_ * Mat3::Identity());
    return;
  }
  inverse_normal_ = usable_inverse(block(0, 0));
  inverse_tangential_ = usable_inverse(0.5 * (block(1, 1) + block(2, 2)));
  coupling_[0] = block(1, 0);
  coupling_[1] = block(2, 0);
}

Vec3 LocalLaw::next_force(const Vec3& gap, const Vec3& force) const {
  if (bilateral_) return force - inverse_ * (gap + softness_ * force);
  const double change = -gap[0] * inverse_normal_, normal = force[0] + change;
  if (!(normal > 0)) return Vec3::Zero();
  if (friction_ == 0) return {normal, 0, 0};
  double t = force[1] - (gap[1] + coupling_[0] * change) * inverse_tangential_;
  double s = force[2] - (gap[2] + coupling_[1] * change) * inverse_tangential_;
  const double length2 = t * t + s * s, limit = friction_ * normal;
  if (length2 > limit * limit) {
    const double scale = limit / std::sqrt(length2);
    t *= scale;
    s *= scale;
  }
  return {normal, t, s};
}

Vec3 LocalLaw::natural_map(const Vec3& gap, const Vec3& force) const {
  if (bilateral_) return rho_ * (gap + softness_ * force);
  Vec3 step = gap;
  step[0] += friction_ * gap.tail<2>().norm();
  return force - project_onto_cone(force - rho_ * step, friction_);
}

}  // namespace souple
