// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <limits>

#include "runtime/collision/box_features.hpp"
#include "runtime/collision/conservative_advance.hpp"
#include "runtime/collision/proximity_arrays.hpp"
#include "runtime/collision/segment_distance.hpp"
#include "runtime/collision/shape_minima.hpp"
#include "runtime/collision/swept_pairs.hpp"

namespace souple {
namespace {

struct Motion {
  const RigidShape& shape;
  const RigidPlacement &start, &end;

  double turn() const {
    return Eigen::AngleAxisd(Mat3(start.rotation.transpose() * end.rotation)).angle();
  }
  // Translation is linear, rotation slerped.
  RigidPlacement at(double t) const {
    const Eigen::Quaterniond from(start.rotation), to(end.rotation);
    return {from.slerp(t, to).toRotationMatrix(),
            start.translation + t * (end.translation - start.translation)};
  }
  // Of the shape around its own origin.
  double reach() const {
    switch (shape.kind) {
      case RigidShapeKind::sphere:
        return 0;  // turning does not move it
      case RigidShapeKind::capsule:
        return shape.half_length_m;
      case RigidShapeKind::box:
        return as_vec3(shape.half_extents_m).norm();
      default:
        return 0;
    }
  }
};

double segment_box_distance(const Vec3& p, const Vec3& q, const RigidShape& box,
                            const RigidPlacement& at) {
  // Along the segment the distance from a convex body is convex: the least by thirds.
  double low = 0, high = 1;
  const auto distance = [&](double t) { return signed_distance(box, at, p + t * (q - p)).distance; };
  for (int k = 0; k < 60; ++k) {
    const double third = (high - low) / 3;
    if (distance(low + third) < distance(high - third)) {
      high -= third;
    } else {
      low += third;
    }
  }
  return distance(0.5 * (low + high));
}

struct CapsuleAxis {
  CapsuleAxis(const RigidShape& shape, const RigidPlacement& at)
      : from(at.translation - shape.half_length_m * at.rotation.col(2)),
        to(at.translation + shape.half_length_m * at.rotation.col(2)) {}
  Vec3 from, to;
};

// A lower bound of the distance of two shapes, the first not a plane; positive whenever they are apart.
double distance_bound(const RigidShape& a, const RigidPlacement& at_a, const RigidShape& b,
                      const RigidPlacement& at_b) {
  using enum RigidShapeKind;
  if (a.kind == sphere) return signed_distance(b, at_b, at_a.translation).distance - a.radius_m;
  if (b.kind == sphere) return signed_distance(a, at_a, at_b.translation).distance - b.radius_m;
  if (b.kind == plane) {
    double least = std::numeric_limits<double>::infinity();
    if (a.kind == capsule) {
      const CapsuleAxis axis(a, at_a);
      for (const Vec3& end : {axis.from, axis.to})
        least = std::min(least, signed_distance(b, at_b, end).distance - a.radius_m);
      return least;
    }
    const PlacedBox box(a, at_a);
    for (int k = 0; k < 8; ++k)
      least = std::min(least, signed_distance(b, at_b, box.corner(k)).distance);
    return least;
  }
  if (a.kind == box && b.kind == box) return widest_gap(PlacedBox(a, at_a), PlacedBox(b, at_b)).gap;
  if (a.kind == capsule && b.kind == capsule) {
    const CapsuleAxis p(a, at_a), q(b, at_b);
    const SegmentPair pair = closest_of_segments(p.from, p.to, q.from, q.to);
    return (pair.a - pair.b).norm() - a.radius_m - b.radius_m;
  }
  const bool a_is_box = a.kind == box;
  const RigidShape& capsule_shape = a_is_box ? b : a;
  const CapsuleAxis axis(capsule_shape, a_is_box ? at_b : at_a);
  return segment_box_distance(axis.from, axis.to, a_is_box ? a : b, a_is_box ? at_a : at_b) -
         capsule_shape.radius_m;
}

}  // namespace

std::optional<SweptPair> find_swept_shapes(const RigidShape& a, const RigidPlacement& a_start,
                                           const RigidPlacement& a_end, const RigidShape& b,
                                           const RigidPlacement& b_start, const RigidPlacement& b_end,
                                           double alarm_distance, ProximityWork& work) {
  using enum RigidShapeKind;
  if (a.kind == mesh || b.kind == mesh || (a.kind == plane && b.kind == plane)) return std::nullopt;
  const Motion first{a, a_start, a_end}, second{b, b_start, b_end};
  const bool exchanged = a.kind == plane;
  const auto bound_at = [&](double t) {
    const RigidPlacement p = first.at(t), q = second.at(t);
    return exchanged ? distance_bound(b, q, a, p) : distance_bound(a, p, b, q);
  };
  const Vec3 way =
      (a_end.translation - a_start.translation) - (b_end.translation - b_start.translation);
  double speed = way.norm() + first.turn() * first.reach() + second.turn() * second.reach();
  // A plane that turns moves the more the farther the other is from its origin.
  const double lever = (a_start.translation - b_start.translation).norm() + way.norm() + first.reach() +
                       second.reach() + a.radius_m + b.radius_m;
  if (a.kind == plane) speed += first.turn() * lever;
  if (b.kind == plane) speed += second.turn() * lever;
  const double start = bound_at(0);
  if (!(start > alarm_distance) || start > speed) return std::nullopt;
  const auto time = time_of_meeting(bound_at, speed);
  if (!time) return std::nullopt;

  const RigidPlacement p = first.at(*time), q = second.at(*time);
  auto& found = work.arrays().minima;
  found.clear();
  // Boxes may be farther apart than their bound says: look as far as needed.
  for (double reach = 1e-3 * start; found.empty() && reach < 4 * start; reach *= 4)
    find_rigid_minima(a, p, b, q, reach, found);
  if (found.empty()) return std::nullopt;
  SweptPair swept;
  swept.time = *time;
  swept.minimum = *std::ranges::min_element(found, {}, &LocalMinimum::gap);
  LocalMinimum& m = swept.minimum;
  const auto back = [](const Vec3& point, const RigidPlacement& from, const RigidPlacement& to) {
    return Vec3(to.rotation * (from.rotation.transpose() * (point - from.translation)) +
                to.translation);
  };
  const Vec3 start_a = back(m.point_b + m.gap * m.normal, p, a_start),
             start_b = back(m.point_b, q, b_start);
  const Vec3 offset = start_a - start_b;
  if (!(offset.dot(m.normal) > 1e-3 * offset.norm())) m.normal = offset.normalized();
  m.point_b = start_b;
  m.gap = offset.dot(m.normal);
  return swept;
}

}  // namespace souple
