// SPDX-License-Identifier: MIT
#include "runtime/collision/shape_minima.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

#include "runtime/collision/box_features.hpp"
#include "runtime/collision/leaf_pairs.hpp"
#include "runtime/collision/segment_distance.hpp"

namespace souple {
namespace {

// A point inside a face or an edge counts if it is deeper than the ends by this part of the longest
// side. Of a box by no more than a hair: a corner that is dropped while it bears a force comes back in
// the next step, and nothing comes to rest. Of a ball on a coarse folded surface the nearest place
// jumps from face to face, and nothing comes to rest either, so it counts only where it is small beside
// the face.
constexpr double deeper_part_box = 1e-3, deeper_part_round = 0.25;
// Of the alarm distance: as near as this is a touch.
constexpr double touch_part = 0.05;

// Numbers of the shape's features, as B: 0 is the shape as a whole.
constexpr Index first_point = 1;  // centre, ends of the axis, corners
constexpr Index capsule_side = 3;
constexpr Index first_box_edge = 9;

class ShapeSearch {
 public:
  ShapeSearch(const DeformedSurface& surface, const RigidShape& shape, const RigidPlacement& at,
              double alarm_distance, ProximityWork::Arrays& work, std::vector<LocalMinimum>& out)
      : s_(surface), shape_(shape), at_(at), alarm_(alarm_distance), work_(work), out_(out) {}

  void run() {
    if (s_.boxes().empty() || shape_.kind == RigidShapeKind::mesh) return;
    find_leaves();
    for (const TreeNodePair& leaf : work_.leaves)
      for (const Index v : s_.tree().leaf_vertices(s_.tree().tree()[leaf.a])) add_vertex(v);
    if (work_.leaves.empty()) return;
    switch (shape_.kind) {
      case RigidShapeKind::sphere:
        add_point(at_.translation, shape_.radius_m, first_point);
        break;
      case RigidShapeKind::capsule:
        add_capsule();
        break;
      case RigidShapeKind::box:
        add_box();
        break;
      default:
        break;
    }
  }

 private:
  // The signed distance changes by no more than the way: a bound for the ball around a box.
  void find_leaves() {
    work_.leaves.clear();
    work_.open.assign(1, 0);
    while (!work_.open.empty()) {
      const Index self = work_.open.back();
      work_.open.pop_back();
      const FloatBox& box = s_.box(self);
      const Vec3 low(box.low[0], box.low[1], box.low[2]), high(box.high[0], box.high[1], box.high[2]);
      const double reach = 0.5 * (high - low).norm();
      if (signed_distance(shape_, at_, 0.5 * (low + high)).distance - reach > alarm_) continue;
      const auto& node = s_.tree().tree()[self];
      if (node.is_leaf()) {
        work_.leaves.push_back({self, 0});
      } else {
        work_.open.push_back(node.right);
        work_.open.push_back(node.left);
      }
    }
  }

  void add_vertex(Index v) {
    const Vec3 point = s_.position(v);
    SignedDistance found = signed_distance(shape_, at_, point);
    if (!(found.distance < alarm_)) return;
    if (shape_.kind == RigidShapeKind::box)
      face_vertex(point, s_.vertex_normal(s_.topology().nodes[v]), found);
    LocalMinimum m;
    m.a = {1, {s_.topology().nodes[v], 0, 0}, {1, 0, 0}};
    m.feature_a = s_.tree().vertex_feature(v);
    m.normal = found.normal;
    m.point_b = point - found.distance * found.normal;
    m.gap = found.distance;
    out_.push_back(m);
  }

  // A vertex that touches a box where two of its faces meet is held by the one that faces it most:
  // which of them is nearest is chance there, and changes from step to step.
  void face_vertex(const Vec3& point, const Vec3& vertex_normal, SignedDistance& found) const {
    const double touch = touch_part * alarm_;
    if (found.distance > touch) return;
    const Vec3 local = at_.rotation.transpose() * (point - at_.translation);
    const Vec3 beyond = local.cwiseAbs() - as_vec3(shape_.half_extents_m);
    double best = std::numeric_limits<double>::infinity();
    for (int axis = 0; axis < 3; ++axis) {
      if (beyond[axis] < beyond.maxCoeff() - 2 * touch) continue;
      const Vec3 normal = (local[axis] < 0 ? -1.0 : 1.0) * at_.rotation.col(axis);
      if (normal.dot(vertex_normal) >= best) continue;
      best = normal.dot(vertex_normal);
      found = {beyond[axis], normal};
    }
  }

  double deeper_part() const {
    return shape_.kind == RigidShapeKind::box ? deeper_part_box : deeper_part_round;
  }

  double gap_at(const Vec3& point) const { return signed_distance(shape_, at_, point).distance; }

  // How deep inside the surface a point of the shape is looked for: its thickness, not farther.
  double depth_limit() const {
    return alarm_ + (shape_.kind == RigidShapeKind::box ? as_vec3(shape_.half_extents_m).minCoeff()
                                                        : shape_.radius_m);
  }

  // Minima of distance between a point of the shape, with a ball around it, and the surface.
  void add_point(const Vec3& centre, double radius, Index feature, const PlacedBox* box = nullptr) {
    work_.near.clear();
    const double reach = std::max(alarm_ + radius, depth_limit());
    s_.for_triangles_near(centre, reach, [&](Index t) {
      const PointMinima minima = point_minima(s_, t, centre, reach, beside_part * alarm_);
      for (int k = 0; k < minima.count; ++k) work_.near.push_back(minima.found[k]);
    });
    std::ranges::sort(work_.near, {}, [](const PointMinimum& m) {
      return std::tuple(std::abs(m.gap), m.feature, m.triangle);
    });
    const int corner = feature - first_point;
    const auto faces = [&](const PointMinimum& m) {
      return !box || m.normal.dot(box->corner_normal(corner)) <= same_side_cosine;
    };
    const auto judged = std::ranges::find_if(work_.near, [&](const PointMinimum& m) {
      return m.gap < 0 || m.gap > beside_part * alarm_ || faces(m);
    });
    const bool inside = judged == work_.near.end() || judged->gap < 0;
    std::size_t count = 0;  // of those taken, moved to the front
    for (const PointMinimum& m : work_.near) {
      if ((m.gap < 0) != inside || !faces(m) || m.gap - radius >= alarm_) continue;
      if (!inside && box && !box->in_corner_cone(corner, -m.normal)) continue;
      const bool is_known = std::any_of(
          work_.near.begin(), work_.near.begin() + std::ptrdiff_t(count),
          [&](const PointMinimum& other) { return other.normal.dot(m.normal) > merging_cosine; });
      if (is_known) continue;
      add_point_pair(centre, radius, feature, m);
      if (inside) return;
      work_.near[count++] = m;
    }
  }

  void add_point_pair(const Vec3& centre, double radius, Index feature, const PointMinimum& found) {
    LocalMinimum m;
    m.a = surface_point(s_, found);
    if (m.a.count == 1) return;  // a vertex has its own
    m.feature_a = found.feature;
    m.feature_b = feature;
    m.normal = -found.normal;
    m.point_b = centre - radius * found.normal;
    m.gap = found.gap - radius;
    double least_end = std::numeric_limits<double>::infinity(), side = 0;
    for (int k = 0; k < 3; ++k) {
      least_end = std::min(least_end, gap_at(s_.corner(found.triangle, k)));
      side = std::max(side,
                      (s_.corner(found.triangle, k) - s_.corner(found.triangle, (k + 1) % 3)).norm());
    }
    if (m.gap < least_end - deeper_part() * side) out_.push_back(m);
  }

  template <class Use>
  void for_ridges_near(const Vec3& from, const Vec3& to, double reach, Use&& use) {
    for (const TreeNodePair& leaf : work_.leaves) {
      const FloatBox& box = s_.box(leaf.a);
      bool apart = false;
      for (int k = 0; k < 3; ++k)
        apart = apart || std::min(from[k], to[k]) - reach > double(box.high[k]) ||
                std::max(from[k], to[k]) + reach < double(box.low[k]);
      if (apart) continue;
      for (const Index e : s_.tree().leaf_edges(s_.tree().tree()[leaf.a]))
        if (const auto ridge = ridge_of(s_, e)) use(e, *ridge);
    }
  }

  void add_edge_pair(Index edge, const Ridge& ridge, double along, Index feature, const Vec3& normal,
                     const Vec3& point_b, double gap) {
    const double least_end = std::min(gap_at(ridge.from), gap_at(ridge.to));
    if (!(gap < alarm_ && gap < least_end - deeper_part() * (ridge.to - ridge.from).norm())) return;
    const auto& ends = s_.topology().edges[edge].vertex;
    LocalMinimum m;
    m.a = {2, {s_.topology().nodes[ends[0]], s_.topology().nodes[ends[1]], 0}, {1 - along, along, 0}};
    m.feature_a = s_.tree().edge_feature(edge);
    m.feature_b = feature;
    m.normal = normal;
    m.point_b = point_b;
    m.gap = gap;
    out_.push_back(m);
  }

  void add_capsule() {
    const Vec3 arm = shape_.half_length_m * at_.rotation.col(2);
    const Vec3 from = at_.translation - arm, to = at_.translation + arm;
    add_point(from, shape_.radius_m, first_point);
    add_point(to, shape_.radius_m, first_point + 1);
    for_ridges_near(from, to, alarm_ + shape_.radius_m, [&](Index e, const Ridge& ridge) {
      const SegmentPair pair = closest_of_segments(ridge.from, ridge.to, from, to);
      if (!(pair.along_a > 0 && pair.along_a < 1 && pair.along_b > 0 && pair.along_b < 1)) return;
      const Vec3 offset = pair.a - pair.b;
      const double distance = offset.norm();
      if (!(distance > 0) || -offset.dot(ridge.inward[0]) > edge_cone_slack * distance ||
          -offset.dot(ridge.inward[1]) > edge_cone_slack * distance)
        return;
      const Vec3 normal = offset / distance;
      add_edge_pair(e, ridge, pair.along_a, capsule_side, normal, pair.b + shape_.radius_m * normal,
                    distance - shape_.radius_m);
    });
  }

  void add_box() {
    const PlacedBox box(shape_, at_);
    for (int k = 0; k < 8; ++k) add_point(box.corner(k), 0, first_point + k, &box);
    for (int k = 0; k < 12; ++k) {
      const Ridge edge = box.edge(k);
      for_ridges_near(edge.from, edge.to, alarm_, [&](Index e, const Ridge& ridge) {
        const auto found = edge_minimum(ridge, edge);
        if (!found) return;
        const Vec3 point = edge.from + found->along_b * (edge.to - edge.from);
        const Vec3 between = lens_point(ridge, edge, *found);
        const double depth = -lens_part * found->gap;
        if (found->gap < 0 && (-gap_at(between) <= depth || depth_inside(s_, between) <= depth)) return;
        add_edge_pair(e, ridge, found->along_a, first_box_edge + k, found->normal, point, found->gap);
      });
    }
  }

  const DeformedSurface& s_;
  const RigidShape& shape_;
  const RigidPlacement& at_;
  double alarm_;
  ProximityWork::Arrays& work_;
  std::vector<LocalMinimum>& out_;
};

}  // namespace

void find_shape_minima(const DeformedSurface& surface, const RigidShape& shape,
                       const RigidPlacement& at, double alarm_distance, ProximityWork& work,
                       std::vector<LocalMinimum>& out) {
  const std::size_t start = out.size();
  ShapeSearch(surface, shape, at, alarm_distance, work.arrays(), out).run();
  std::sort(out.begin() + std::ptrdiff_t(start), out.end(), [](const auto& p, const auto& q) {
    return std::tuple(p.feature_a, p.feature_b, p.gap) < std::tuple(q.feature_a, q.feature_b, q.gap);
  });
}

}  // namespace souple
