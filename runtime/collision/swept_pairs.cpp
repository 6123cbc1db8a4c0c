// SPDX-License-Identifier: MIT
#include "runtime/collision/swept_pairs.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

#include "runtime/collision/box_features.hpp"
#include "runtime/collision/conservative_advance.hpp"
#include "runtime/collision/leaf_pairs.hpp"
#include "runtime/collision/ray_pick.hpp"
#include "runtime/collision/segment_distance.hpp"

namespace souple {
namespace {

// Numbers of a shape's features, as in find_shape_minima.
constexpr Index first_point = 1, capsule_side = 3, first_box_edge = 9;

constexpr double infinite = std::numeric_limits<double>::infinity();

struct Path {
  Vec3 start = Vec3::Zero(), end = Vec3::Zero();
  Vec3 at(double t) const { return start + t * (end - start); }
  Vec3 way() const { return end - start; }
};

/// A surface and where it goes.
struct MovingSurface {
  const DeformedSurface& s;
  const Eigen::VectorXd& end;
  Path path(Index vertex) const {
    return {s.position(vertex), node_entry(end, s.topology().nodes[vertex])};
  }
  std::array<Path, 3> triangle(Index t) const {
    const auto& c = s.topology().corners[t];
    return {path(c[0]), path(c[1]), path(c[2])};
  }
  std::array<Path, 2> edge(Index e) const {
    const auto& v = s.topology().edges[e].vertex;
    return {path(v[0]), path(v[1])};
  }
};

template <std::size_t count>
double longest_way(const std::array<Path, count>& paths, const Vec3& shared) {
  double longest = 0;
  for (const Path& p : paths) longest = std::max(longest, (p.way() - shared).norm());
  return longest;
}

template <std::size_t count>
Vec3 sum_of_ways(const std::array<Path, count>& paths) {
  Vec3 sum = Vec3::Zero();
  for (const Path& p : paths) sum += p.way();
  return sum;
}

template <std::size_t count>
FloatBox path_box(const std::array<Path, count>& paths, double margin) {
  FloatBox box{{3e38F, 3e38F, 3e38F, 0}, {-3e38F, -3e38F, -3e38F, 0}};
  for (const Path& p : paths)
    for (int k = 0; k < 3; ++k) {
      const double low = std::min(p.start[k], p.end[k]), high = std::max(p.start[k], p.end[k]);
      const double rounding = 1e-6 * std::max(std::abs(low), std::abs(high)) + margin;
      box.low[k] = std::min(box.low[k], float(low - rounding));
      box.high[k] = std::max(box.high[k], float(high + rounding));
    }
  return box;
}

// Boxes of every tree node over the whole step.
void sweep_boxes(const MovingSurface& moving, std::vector<FloatBox>& boxes) {
  const auto tree = moving.s.tree().tree();
  boxes.resize(tree.size());
  for (std::size_t n = tree.size(); n-- > 0;) {
    FloatBox box;
    if (tree[n].is_leaf()) {
      box = moving.s.box(static_cast<Index>(n));
      for (const Index v : moving.s.tree().leaf_corners(tree[n])) {
        const FloatBox end = path_box(std::array{moving.path(v)}, 0);
        for (int k = 0; k < 3; ++k) {
          box.low[k] = std::min(box.low[k], end.low[k]);
          box.high[k] = std::max(box.high[k], end.high[k]);
        }
      }
    } else {
      const FloatBox &left = boxes[tree[n].left], &right = boxes[tree[n].right];
      for (int k = 0; k < 3; ++k) {
        box.low[k] = std::min(left.low[k], right.low[k]);
        box.high[k] = std::max(left.high[k], right.high[k]);
      }
    }
    boxes[n] = box;
  }
}

/// Two points that meet, and where they were.
struct Meeting {
  double time = 0;
  Vec3 direction = Vec3::UnitZ();  ///< unit, from the second to the first at that time
  std::array<double, 3> weight{};  ///< in the triangle
  int feature = 6;
  double along_first = 0, along_second = 0;  ///< on segments
  double end_depth = infinite;               ///< as in SweptPair
};

Vec3 between(const std::array<Path, 2>& segment, double along, double t) {
  return segment[0].at(t) + along * (segment[1].at(t) - segment[0].at(t));
}

std::optional<Meeting> point_meets_triangle(const Path& point, const std::array<Path, 3>& corners,
                                            double radius, double alarm) {
  const auto closest_at = [&](double t) {
    return closest_on_triangle(point.at(t), corners[0].at(t), corners[1].at(t), corners[2].at(t));
  };
  const auto distance_at = [&](double t) {
    return (point.at(t) - closest_at(t).point).norm() - radius;
  };
  const Vec3 shared = 0.25 * (point.way() + sum_of_ways(corners));
  const double speed = (point.way() - shared).norm() + longest_way(corners, shared);
  const double start = distance_at(0);
  if (!(start > alarm) || start > speed) return std::nullopt;
  const auto time = time_of_meeting(distance_at, speed);
  if (!time) return std::nullopt;
  const ClosestOnTriangle closest = closest_at(*time);
  Meeting meeting{*time, (point.at(*time) - closest.point).normalized(), closest.weight,
                  closest.feature};
  const auto area_at = [&](double t) {
    return Vec3((corners[1].at(t) - corners[0].at(t)).cross(corners[2].at(t) - corners[0].at(t)));
  };
  // From behind, a point leaves.
  const Vec3 area = area_at(*time);
  if (meeting.direction.dot(area) < -1e-3 * area.norm()) return std::nullopt;
  meeting.end_depth = radius - (point.end - corners[0].end).dot(area_at(1).normalized());
  return meeting;
}

std::optional<Meeting> segments_meet(const std::array<Path, 2>& a, const std::array<Path, 2>& b,
                                     double radius, double alarm) {
  const auto closest_at = [&](double t) {
    return closest_of_segments(a[0].at(t), a[1].at(t), b[0].at(t), b[1].at(t));
  };
  const auto distance_at = [&](double t) {
    const SegmentPair pair = closest_at(t);
    return (pair.a - pair.b).norm() - radius;
  };
  const Vec3 shared = 0.25 * (sum_of_ways(a) + sum_of_ways(b));
  const double speed = longest_way(a, shared) + longest_way(b, shared);
  const double start = distance_at(0);
  if (!(start > alarm) || start > speed) return std::nullopt;
  const auto time = time_of_meeting(distance_at, speed);
  if (!time) return std::nullopt;
  const SegmentPair pair = closest_at(*time);
  // At the ends, vertices meet.
  if (!(pair.along_a > 0 && pair.along_a < 1 && pair.along_b > 0 && pair.along_b < 1))
    return std::nullopt;
  return Meeting{*time, (pair.a - pair.b).normalized(), {}, 6, pair.along_a, pair.along_b};
}

// Sets normal, point and gap from where the two points are at the start.
void settle(LocalMinimum& m, const Vec3& start_a, const Vec3& start_b, const Vec3& direction) {
  const Vec3 offset = start_a - start_b;
  m.normal = direction;
  if (!(offset.dot(direction) > 1e-3 * offset.norm())) m.normal = offset.normalized();
  m.point_b = start_b;
  m.gap = offset.dot(m.normal);
}

SurfacePoint triangle_point(const DeformedSurface& s, Index t, const std::array<double, 3>& weight) {
  const auto& corners = s.tree().triangles()[t];
  SurfacePoint point;
  for (int k = 0; k < 3; ++k) {
    if (!(weight[k] > 0)) continue;
    point.node[point.count] = corners[k];
    point.weight[point.count++] = weight[k];
  }
  return point;
}

Vec3 start_of(const DeformedSurface& s, Index t, const std::array<double, 3>& weight) {
  return weight[0] * s.corner(t, 0) + weight[1] * s.corner(t, 1) + weight[2] * s.corner(t, 2);
}

SurfacePoint edge_point(const DeformedSurface& s, Index edge, double along) {
  const auto& ends = s.topology().edges[edge].vertex;
  return {2, {s.topology().nodes[ends[0]], s.topology().nodes[ends[1]], 0}, {1 - along, along, 0}};
}

Index feature_of(const DeformedSurface& s, Index t, int feature) {
  if (feature == 6) return s.tree().face_feature(t);
  if (feature < 3) return s.tree().vertex_feature(s.topology().corners[t][feature]);
  return s.tree().edge_feature(s.topology().triangle_edges[t][feature - 3]);
}

// Appends of every owner (the vertex, or an edge) the earliest of `found`.
template <class Owner>
void keep_earliest(std::vector<SweptPair>& found, const Owner& owner, std::vector<SweptPair>& out) {
  std::ranges::sort(found, {}, [&](const SweptPair& p) {
    return std::tuple(owner(p), p.time, p.minimum.feature_a, p.minimum.feature_b);
  });
  for (std::size_t k = 0; k < found.size(); ++k)
    if (k == 0 || owner(found[k]) != owner(found[k - 1])) out.push_back(found[k]);
}

void sort_pairs(std::vector<SweptPair>& out, std::size_t first) {
  const auto begin = out.begin() + std::ptrdiff_t(first);
  const auto key = [](const SweptPair& p) {
    return std::tuple(p.minimum.feature_a, p.minimum.feature_b, p.time);
  };
  std::sort(begin, out.end(), [&](const auto& p, const auto& q) { return key(p) < key(q); });
  out.erase(std::unique(begin, out.end(),
                        [](const auto& p, const auto& q) {
                          return p.minimum.feature_a == q.minimum.feature_a &&
                                 p.minimum.feature_b == q.minimum.feature_b;
                        }),
            out.end());
}

// Vertices of `x` against triangles of `y`; `flipped`: x is B.
void sweep_vertices(const MovingSurface& x, const MovingSurface& y, bool flipped, double alarm,
                    const ProximityWork::Arrays& work, std::vector<SweptPair>& found) {
  for (const TreeNodePair& pair : work.leaves) {
    const Index leaf_x = flipped ? pair.b : pair.a, leaf_y = flipped ? pair.a : pair.b;
    const FloatBox& box_y = (flipped ? work.boxes_a : work.boxes_b)[leaf_y];
    for (const Index v : x.s.tree().leaf_vertices(x.s.tree().tree()[leaf_x])) {
      const Path point = x.path(v);
      if (squared_distance(path_box(std::array{point}, 0), box_y) > 0) continue;
      for (const Index t : y.s.tree().leaf_triangles(y.s.tree().tree()[leaf_y])) {
        const auto meeting = point_meets_triangle(point, y.triangle(t), 0, alarm);
        if (!meeting) continue;
        const SurfacePoint vertex{1, {x.s.topology().nodes[v], 0, 0}, {1, 0, 0}};
        const SurfacePoint face = triangle_point(y.s, t, meeting->weight);
        const Vec3 foot = start_of(y.s, t, meeting->weight);
        SweptPair swept;
        swept.time = meeting->time;
        swept.end_depth = meeting->end_depth;
        LocalMinimum& m = swept.minimum;
        m.a = flipped ? face : vertex;
        m.b = flipped ? vertex : face;
        const Index feature = feature_of(y.s, t, meeting->feature);
        m.feature_a = flipped ? feature : x.s.tree().vertex_feature(v);
        m.feature_b = flipped ? x.s.tree().vertex_feature(v) : feature;
        if (flipped) {
          settle(m, foot, point.start, -meeting->direction);
        } else {
          settle(m, point.start, foot, meeting->direction);
        }
        found.push_back(swept);
      }
    }
  }
}

void sweep_edges(const MovingSurface& a, const MovingSurface& b, double alarm,
                 const ProximityWork::Arrays& work, std::vector<SweptPair>& found) {
  for (const TreeNodePair& pair : work.leaves)
    for (const Index e : a.s.tree().leaf_edges(a.s.tree().tree()[pair.a])) {
      const auto path_a = a.edge(e);
      const FloatBox box = path_box(path_a, 0);
      if (squared_distance(box, work.boxes_b[pair.b]) > 0) continue;
      const auto ridge_a = ridge_of(a.s, e);
      if (!ridge_a) continue;
      for (const Index f : b.s.tree().leaf_edges(b.s.tree().tree()[pair.b])) {
        const auto path_b = b.edge(f);
        if (squared_distance(box, path_box(path_b, 0)) > 0) continue;
        const auto ridge_b = ridge_of(b.s, f);
        if (!ridge_b) continue;
        const auto meeting = segments_meet(path_a, path_b, 0, alarm);
        if (!meeting || meeting->direction.dot(ridge_b->outward) < edge_cone_slack ||
            meeting->direction.dot(ridge_a->outward) > -edge_cone_slack)
          continue;
        SweptPair swept;
        swept.time = meeting->time;
        swept.end_depth = meeting->end_depth;
        swept.minimum.a = edge_point(a.s, e, meeting->along_first);
        swept.minimum.b = edge_point(b.s, f, meeting->along_second);
        swept.minimum.feature_a = a.s.tree().edge_feature(e);
        swept.minimum.feature_b = b.s.tree().edge_feature(f);
        settle(swept.minimum, between(path_a, meeting->along_first, 0),
               between(path_b, meeting->along_second, 0), meeting->direction);
        found.push_back(swept);
      }
    }
}

Vec3 carried(const Vec3& local, const RigidPlacement& at) {
  return at.rotation * local + at.translation;
}

/// A surface against an analytic shape that moves.
class ShapeSweep {
 public:
  ShapeSweep(const MovingSurface& surface, const RigidShape& shape, const RigidPlacement& start,
             const RigidPlacement& end, double alarm, ProximityWork::Arrays& work,
             std::vector<SweptPair>& out)
      : m_(surface), shape_(shape), start_(start), end_(end), alarm_(alarm), work_(work), out_(out) {}

  void run() {
    for (Index v = 0; v < m_.s.topology().vertex_count(); ++v) sweep_vertex(v);
    sweep_boxes(m_, work_.boxes_a);
    const double length = shape_.half_length_m, radius = shape_.radius_m;
    switch (shape_.kind) {
      case RigidShapeKind::sphere:
        sweep_point(Vec3::Zero(), radius, first_point);
        break;
      case RigidShapeKind::capsule:
        sweep_point({0, 0, -length}, radius, first_point);
        sweep_point({0, 0, length}, radius, first_point + 1);
        sweep_segment({0, 0, -length}, {0, 0, length}, radius, capsule_side);
        break;
      case RigidShapeKind::box:
        sweep_box();
        break;
      default:
        break;
    }
  }

 private:
  void sweep_vertex(Index v) {
    const Path path = m_.path(v);
    const Vec3 from = start_.rotation.transpose() * (path.start - start_.translation);
    const Vec3 to = end_.rotation.transpose() * (path.end - end_.translation);
    const double length = (to - from).norm();
    if (!(length > 0)) return;
    const SignedDistance here = signed_distance(shape_, {}, from);
    if (!(here.distance > alarm_) || here.distance > length) return;
    const auto hit = pick(shape_, {}, {from, (to - from) / length, length});
    if (!hit) return;
    const Vec3 point = carried(from + hit->distance / length * (to - from), start_);
    SweptPair swept;
    swept.time = hit->distance / length;
    swept.end_depth = -signed_distance(shape_, {}, to).distance;
    swept.minimum.a = {1, {m_.s.topology().nodes[v], 0, 0}, {1, 0, 0}};
    swept.minimum.feature_a = m_.s.tree().vertex_feature(v);
    settle(swept.minimum, path.start, point, start_.rotation * hit->normal);
    out_.push_back(swept);
  }

  template <class Use>
  void for_leaves_near(const FloatBox& box, Use&& use) {
    work_.open.assign(work_.boxes_a.empty() ? 0 : 1, 0);
    while (!work_.open.empty()) {
      const Index self = work_.open.back();
      work_.open.pop_back();
      if (squared_distance(work_.boxes_a[self], box) > 0) continue;
      const auto& node = m_.s.tree().tree()[self];
      if (node.is_leaf()) {
        use(node);
      } else {
        work_.open.push_back(node.right);
        work_.open.push_back(node.left);
      }
    }
  }

  Path path_of(const Vec3& local) const { return {carried(local, start_), carried(local, end_)}; }

  // A point of the shape with a ball around it.
  void sweep_point(const Vec3& local, double radius, Index feature) {
    const Path point = path_of(local);
    std::optional<SweptPair> first;
    for_leaves_near(path_box(std::array{point}, radius), [&](const SurfaceTree::TreeNode& leaf) {
      for (const Index t : m_.s.tree().leaf_triangles(leaf)) {
        const auto meeting = point_meets_triangle(point, m_.triangle(t), radius, alarm_);
        if (!meeting || (first && meeting->time >= first->time)) continue;
        first.emplace();
        first->time = meeting->time;
        first->end_depth = meeting->end_depth;
        first->minimum.a = triangle_point(m_.s, t, meeting->weight);
        first->minimum.feature_a = feature_of(m_.s, t, meeting->feature);
        first->minimum.feature_b = feature;
        settle(first->minimum, start_of(m_.s, t, meeting->weight),
               point.start - radius * meeting->direction, -meeting->direction);
      }
    });
    if (first && first->minimum.a.count > 1) out_.push_back(*first);
  }

  void sweep_segment(const Vec3& from, const Vec3& to, double radius, Index feature) {
    const std::array<Path, 2> segment = {path_of(from), path_of(to)};
    std::optional<SweptPair> first;
    for_leaves_near(path_box(segment, radius), [&](const SurfaceTree::TreeNode& leaf) {
      for (const Index e : m_.s.tree().leaf_edges(leaf)) {
        const auto ridge = ridge_of(m_.s, e);
        if (!ridge) continue;
        const auto edge = m_.edge(e);
        const auto meeting = segments_meet(edge, segment, radius, alarm_);
        if (!meeting || (first && meeting->time >= first->time)) continue;
        if (meeting->direction.dot(ridge->outward) > -edge_cone_slack) continue;
        first.emplace();
        first->time = meeting->time;
        first->end_depth = meeting->end_depth;
        first->minimum.a = edge_point(m_.s, e, meeting->along_first);
        first->minimum.feature_a = m_.s.tree().edge_feature(e);
        first->minimum.feature_b = feature;
        settle(first->minimum, between(edge, meeting->along_first, 0),
               between(segment, meeting->along_second, 0) + radius * meeting->direction,
               meeting->direction);
      }
    });
    if (first) out_.push_back(*first);
  }

  void sweep_box() {
    const RigidPlacement own;
    const PlacedBox box(shape_, own);
    for (int k = 0; k < 8; ++k) sweep_point(box.corner(k), 0, first_point + k);
    for (int k = 0; k < 12; ++k) sweep_segment(box.edge(k).from, box.edge(k).to, 0, first_box_edge + k);
  }

  const MovingSurface& m_;
  const RigidShape& shape_;
  const RigidPlacement &start_, &end_;
  double alarm_;
  ProximityWork::Arrays& work_;
  std::vector<SweptPair>& out_;
};

}  // namespace

void find_swept_pairs(const DeformedSurface& a, const Eigen::VectorXd& xa_end, const DeformedSurface& b,
                      const Eigen::VectorXd& xb_end, double alarm_distance, ProximityWork& work,
                      std::vector<SweptPair>& out) {
  auto& arrays = work.arrays();
  const std::size_t first = out.size();
  const MovingSurface moving_a{a, xa_end}, moving_b{b, xb_end};
  sweep_boxes(moving_a, arrays.boxes_a);
  sweep_boxes(moving_b, arrays.boxes_b);
  find_leaf_pairs(a.tree(), arrays.boxes_a, b.tree(), arrays.boxes_b, 0, arrays);
  const auto of_a = [](const SweptPair& p) { return p.minimum.feature_a; };
  const auto of_b = [](const SweptPair& p) { return p.minimum.feature_b; };
  arrays.swept.clear();
  sweep_vertices(moving_a, moving_b, false, alarm_distance, arrays, arrays.swept);
  keep_earliest(arrays.swept, of_a, out);
  arrays.swept.clear();
  sweep_vertices(moving_b, moving_a, true, alarm_distance, arrays, arrays.swept);
  keep_earliest(arrays.swept, of_b, out);
  arrays.swept.clear();
  sweep_edges(moving_a, moving_b, alarm_distance, arrays, arrays.swept);
  keep_earliest(arrays.swept, of_a, out);
  keep_earliest(arrays.swept, of_b, out);
  sort_pairs(out, first);
}

void find_swept_shape(const DeformedSurface& surface, const Eigen::VectorXd& x_end,
                      const RigidShape& shape, const RigidPlacement& start, const RigidPlacement& end,
                      double alarm_distance, ProximityWork& work, std::vector<SweptPair>& out) {
  if (shape.kind == RigidShapeKind::mesh) return;
  const std::size_t first = out.size();
  const MovingSurface moving{surface, x_end};
  ShapeSweep(moving, shape, start, end, alarm_distance, work.arrays(), out).run();
  sort_pairs(out, first);
}

}  // namespace souple
