// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <limits>

#include "runtime/collision/box_features.hpp"
#include "runtime/collision/segment_distance.hpp"
#include "runtime/collision/shape_minima.hpp"

namespace souple {
namespace {

// Penetrating edges part along the least way out of the boxes, to this cosine.
constexpr double least_along = 0.7;
// Capsules at a smaller angle (sine) touch along a line, which takes two points.
constexpr double nearly_parallel = 0.1;

constexpr Index first_box_edge = 8, first_box_face = 20;
constexpr Index capsule_side = 2;

struct Placed {
  const RigidShape& shape;
  const RigidPlacement& at;
  Vec3 capsule_end(int k) const {
    return at.translation + (k == 0 ? -1 : 1) * shape.half_length_m * at.rotation.col(2);
  }
};

// Contacts of a pair whose shapes may have been exchanged, so that the lower kind is second.
class Manifold {
 public:
  Manifold(double alarm_distance, std::vector<LocalMinimum>& out) : alarm_(alarm_distance), out_(out) {}
  void exchange() { exchanged_ = !exchanged_; }
  double alarm() const { return alarm_; }

  /// `normal` from the second shape to the first, `point` on the second.
  void add(Index feature_first, Index feature_second, const Vec3& normal, const Vec3& point,
           double gap) {
    if (!(gap < alarm_)) return;
    LocalMinimum m;
    m.feature_a = exchanged_ ? feature_second : feature_first;
    m.feature_b = exchanged_ ? feature_first : feature_second;
    m.normal = exchanged_ ? Vec3(-normal) : normal;
    m.point_b = exchanged_ ? Vec3(point + gap * normal) : point;
    m.gap = gap;
    out_.push_back(m);
  }

 private:
  double alarm_;
  bool exchanged_ = false;
  std::vector<LocalMinimum>& out_;
};

// A ball of the first shape against the whole second one.
void ball_against(const Vec3& centre, double radius, Index feature, const Placed& b, Manifold& out) {
  const SignedDistance found = signed_distance(b.shape, b.at, centre);
  out.add(feature, 0, found.normal, centre - found.distance * found.normal, found.distance - radius);
}

void ends_against(const Placed& capsule, const Placed& b, Manifold& out) {
  for (int k = 0; k < 2; ++k) ball_against(capsule.capsule_end(k), capsule.shape.radius_m, k, b, out);
}

void box_against_plane(const Placed& box, const Placed& plane, Manifold& out) {
  const PlacedBox corners(box.shape, box.at);
  for (int k = 0; k < 8; ++k) ball_against(corners.corner(k), 0, k, plane, out);
}

// `pa` and `pb` on the axes of two capsules.
void capsule_points(const Placed& a, const Placed& b, const Vec3& pa, const Vec3& pb, Index feature,
                    Manifold& out) {
  const Vec3 offset = pa - pb;
  const double distance = offset.norm();
  Vec3 normal =
      distance > 0 ? Vec3(offset / distance) : a.at.rotation.col(2).cross(b.at.rotation.col(2));
  if (!(distance > 0)) normal = normal.norm() > 1e-9 ? Vec3(normal.normalized()) : b.at.rotation.col(0);
  out.add(feature, feature, normal, pb + b.shape.radius_m * normal,
          distance - a.shape.radius_m - b.shape.radius_m);
}

// Along nearly parallel axes at both ends of the common stretch; and where they are nearest, unless
// that is nowhere in particular.
void capsule_against_capsule(const Placed& a, const Placed& b, Manifold& out) {
  const Vec3 p = a.capsule_end(0), q = a.capsule_end(1), r = b.capsule_end(0), s = b.capsule_end(1);
  const double sine = a.at.rotation.col(2).cross(b.at.rotation.col(2)).norm();
  const Vec3 along = s - r;
  const double length2 = along.squaredNorm();
  bool has_stretch = false;
  if (sine < nearly_parallel && length2 > 0 && p != q) {
    const double t0 = (p - r).dot(along) / length2, t1 = (q - r).dot(along) / length2;
    const double low = std::max(0.0, std::min(t0, t1)), high = std::min(1.0, std::max(t0, t1));
    has_stretch = high > low;
    for (int k = 0; has_stretch && k < 2; ++k) {
      const double t = k == 0 ? low : high;
      capsule_points(a, b, p + std::clamp((t - t0) / (t1 - t0), 0.0, 1.0) * (q - p), r + t * along, k,
                     out);
    }
  }
  if (has_stretch && sine < 1e-3) return;
  const SegmentPair nearest = closest_of_segments(p, q, r, s);
  capsule_points(a, b, nearest.a, nearest.b, capsule_side, out);
}

// The stretch of the segment inside the box, of [0, 1]; false: none.
bool clip_to_box(const Vec3& half, const Vec3& from, const Vec3& to, double& enter, double& leave) {
  enter = 0;
  leave = 1;
  for (int k = 0; k < 3; ++k) {
    const double step = to[k] - from[k];
    if (step == 0) {
      if (std::abs(from[k]) > half[k]) return false;
      continue;
    }
    const double t0 = (-half[k] - from[k]) / step, t1 = (half[k] - from[k]) / step;
    enter = std::max(enter, std::min(t0, t1));
    leave = std::min(leave, std::max(t0, t1));
  }
  return enter < leave;
}

// An axis that runs through a box leaves it by the face that needs the least way.
void axis_in_box(const Placed& capsule, const Placed& box, const Vec3& from, const Vec3& to,
                 double enter, double leave, Manifold& out) {
  const Vec3 half = as_vec3(box.shape.half_extents_m);
  const Vec3 p = from + enter * (to - from), q = from + leave * (to - from);
  double least = std::numeric_limits<double>::infinity();
  Index face = 0;
  for (int k = 0; k < 6; ++k) {
    const double side = k % 2 == 0 ? -1 : 1;
    const double depth = half[k / 2] - std::min(side * p[k / 2], side * q[k / 2]);
    if (depth < least) least = depth, face = k;
  }
  const Eigen::Index axis = face / 2;
  const double side = face % 2 == 0 ? -1 : 1;
  for (int end = 0; end < 2; ++end) {
    const Vec3 at = end == 0 ? p : q;
    const double height = side * at[axis] - half[axis];
    Vec3 foot = at;
    foot[axis] = side * half[axis];
    out.add(end, first_box_face + face, side * box.at.rotation.col(axis),
            box.at.rotation * foot + box.at.translation, height - capsule.shape.radius_m);
  }
}

void capsule_against_box(const Placed& capsule, const Placed& box, Manifold& out) {
  const PlacedBox features(box.shape, box.at);
  const Vec3 p = capsule.capsule_end(0), q = capsule.capsule_end(1);
  const Vec3 from = features.to_local(p), to = features.to_local(q);
  double enter = 0, leave = 0;
  if (clip_to_box(as_vec3(box.shape.half_extents_m), from, to, enter, leave)) {
    axis_in_box(capsule, box, from, to, enter, leave, out);
    return;
  }
  ends_against(capsule, box, out);
  for (int k = 0; k < 12; ++k) {
    const Ridge edge = features.edge(k);
    const SegmentPair pair = closest_of_segments(p, q, edge.from, edge.to);
    if (!(pair.along_a > 0 && pair.along_a < 1)) continue;
    const Vec3 offset = pair.a - pair.b;
    const double distance = offset.norm();
    if (!(distance > 0) || offset.dot(edge.inward[0]) > edge_cone_slack * distance ||
        offset.dot(edge.inward[1]) > edge_cone_slack * distance)
      continue;
    out.add(capsule_side, first_box_edge + k, offset / distance, pair.b,
            distance - capsule.shape.radius_m);
  }
}

// Corners of the first box against the second: over, or in, the face that faces them; or near its
// edges and corners.
void corners_against_box(const PlacedBox& a, const PlacedBox& b, Manifold& out) {
  const double beside = beside_part * out.alarm();
  for (int k = 0; k < 8; ++k) {
    const Vec3 point = a.corner(k), local = b.to_local(point), own = a.corner_normal(k);
    Vec3 beyond = Vec3::Zero();
    for (int i = 0; i < 3; ++i)
      if (std::abs(local[i]) - b.half(i) > beside)
        beyond[i] = std::copysign(std::abs(local[i]) - b.half(i), local[i]);
    Vec3 normal = Vec3::Zero();
    double gap = -std::numeric_limits<double>::infinity();
    Index feature = first_box_face;
    if (beyond.isZero()) {
      for (int face = 0; face < 6; ++face) {
        const double side = face % 2 == 0 ? -1 : 1;
        const Vec3 outward = side * b.axis(face / 2);
        const double height = side * local[face / 2] - b.half(face / 2);
        if (outward.dot(own) > same_side_cosine || height <= gap) continue;
        gap = height, normal = outward, feature = first_box_face + face;
      }
    } else {
      gap = beyond.norm();
      for (int i = 0; i < 3; ++i) normal += beyond[i] / gap * b.axis(i);
      Eigen::Index axis = 0;
      const bool is_face = beyond.cwiseAbs().maxCoeff(&axis) == gap;
      feature = first_box_face + static_cast<Index>(2 * axis) + (beyond[axis] > 0 ? 1 : 0);
      if (normal.dot(own) > same_side_cosine ||
          (!(is_face && gap <= sure_part * out.alarm()) && !a.in_corner_cone(k, -normal)))
        continue;
    }
    out.add(k, feature, normal, point - gap * normal, gap);
  }
}

void box_against_box(const Placed& a, const Placed& b, Manifold& out) {
  const PlacedBox first(a.shape, a.at), second(b.shape, b.at);
  const Vec3 way_out = widest_gap(first, second).axis;
  corners_against_box(first, second, out);
  out.exchange();
  corners_against_box(second, first, out);
  out.exchange();
  for (Index i = 0; i < 12; ++i)
    for (Index j = 0; j < 12; ++j) {
      const Ridge e = first.edge(i), f = second.edge(j);
      const auto found = edge_minimum(e, f);
      if (!found) continue;
      const Vec3 point = f.from + found->along_b * (f.to - f.from);
      // Edges of other sides than those that touch would be led out a long way.
      if (found->gap < 0 && found->normal.dot(way_out) < least_along) continue;
      out.add(first_box_edge + i, first_box_edge + j, found->normal, point, found->gap);
    }
}

bool is_analytic(const RigidShape& shape) { return shape.kind != RigidShapeKind::mesh; }

}  // namespace

void find_rigid_minima(const RigidShape& a, const RigidPlacement& at_a, const RigidShape& b,
                       const RigidPlacement& at_b, double alarm_distance,
                       std::vector<LocalMinimum>& out) {
  if (!is_analytic(a) || !is_analytic(b)) return;
  using enum RigidShapeKind;
  const auto rank = [](RigidShapeKind kind) {
    return kind == plane ? 0 : (kind == box ? 1 : (kind == capsule ? 2 : 3));
  };
  const std::size_t start = out.size();
  Manifold manifold(alarm_distance, out);
  const bool exchange = rank(a.kind) < rank(b.kind);
  if (exchange) manifold.exchange();
  const Placed first{exchange ? b : a, exchange ? at_b : at_a};
  const Placed second{exchange ? a : b, exchange ? at_a : at_b};
  switch (first.shape.kind) {
    case sphere:
      ball_against(first.at.translation, first.shape.radius_m, 0, second, manifold);
      break;
    case capsule:
      if (second.shape.kind == plane) ends_against(first, second, manifold);
      if (second.shape.kind == box) capsule_against_box(first, second, manifold);
      if (second.shape.kind == capsule) capsule_against_capsule(first, second, manifold);
      break;
    case box:
      if (second.shape.kind == plane) box_against_plane(first, second, manifold);
      if (second.shape.kind == box) box_against_box(first, second, manifold);
      break;
    default:
      break;
  }
  std::sort(out.begin() + std::ptrdiff_t(start), out.end(), [](const auto& p, const auto& q) {
    return std::pair(p.feature_a, p.feature_b) < std::pair(q.feature_a, q.feature_b);
  });
}

Eigen::AlignedBox3d shape_bounds(const RigidShape& shape, const RigidPlacement& at) {
  const Vec3& centre = at.translation;
  Vec3 half = Vec3::Zero();
  switch (shape.kind) {
    case RigidShapeKind::sphere:
      half.setConstant(shape.radius_m);
      break;
    case RigidShapeKind::capsule:
      half = shape.half_length_m * at.rotation.col(2).cwiseAbs() + Vec3::Constant(shape.radius_m);
      break;
    case RigidShapeKind::box:
      half = at.rotation.cwiseAbs() * as_vec3(shape.half_extents_m);
      break;
    case RigidShapeKind::mesh:
      return {};
    case RigidShapeKind::plane: {
      Eigen::AlignedBox3d box(Vec3::Constant(-std::numeric_limits<double>::infinity()),
                              Vec3::Constant(std::numeric_limits<double>::infinity()));
      for (int k = 0; k < 3; ++k) {
        if (at.rotation(k, 2) == 1) box.max()[k] = centre[k];
        if (at.rotation(k, 2) == -1) box.min()[k] = centre[k];
      }
      return box;
    }
  }
  return {centre - half, centre + half};
}

}  // namespace souple
