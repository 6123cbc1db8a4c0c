// SPDX-License-Identifier: MIT
#include "runtime/world/rigid_path.hpp"

#include <algorithm>
#include <cmath>

#include "runtime/fem/linear_algebra.hpp"

namespace souple {
namespace {

constexpr double largest_length = 1e6;  // m: beyond, doubles no longer resolve contact gaps

Eigen::Quaterniond quaternion(const Pose& p) {
  return Eigen::Quaterniond(p.rotation[0], p.rotation[1], p.rotation[2], p.rotation[3]).normalized();
}

}  // namespace

Pose pose_at(const std::vector<Keyframe>& path, double time_s) {
  const auto after = std::ranges::upper_bound(path, time_s, {}, &Keyframe::time_s);
  if (after == path.begin()) return path.front().pose;
  if (after == path.end()) return path.back().pose;
  const Keyframe &from = *(after - 1), &to = *after;
  const double fraction = (time_s - from.time_s) / (to.time_s - from.time_s);
  const Eigen::Quaterniond q = quaternion(from.pose).slerp(fraction, quaternion(to.pose));
  const Vec3 translation =
      (1 - fraction) * as_vec3(from.pose.translation) + fraction * as_vec3(to.pose.translation);
  return {{q.w(), q.x(), q.y(), q.z()}, as_point(translation)};
}

Status check_pose(const Pose& pose, IssueCode code, const std::string& where) {
  double norm2 = 0;
  for (const double c : pose.rotation) norm2 += c * c;
  if (!(std::abs(norm2 - 1) < 1e-3))
    return make_issue(code, "the rotation is not a unit quaternion", where);
  for (const double c : pose.translation)
    if (!(std::abs(c) <= largest_length))
      return make_issue(code, "the position is out of range", where);
  return {};
}

Status check_path(const std::vector<Keyframe>& path, IssueCode code, const std::string& where) {
  if (path.empty()) return make_issue(code, "a path needs at least one pose", where);
  for (std::size_t k = 0; k < path.size(); ++k) {
    if (auto status = check_pose(path[k].pose, code, where); !status) return status;
    if (!std::isfinite(path[k].time_s) || (k > 0 && !(path[k].time_s > path[k - 1].time_s)))
      return make_issue(code, "the times of the path do not ascend", where);
  }
  return {};
}

}  // namespace souple
