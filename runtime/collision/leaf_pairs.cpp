// SPDX-License-Identifier: MIT
#include "runtime/collision/leaf_pairs.hpp"

#include <algorithm>
#include <cmath>

namespace souple {
namespace {

FloatBox joined(const FloatBox& a, const FloatBox& b) {
  FloatBox box;
  _mm_store_ps(box.low.data(), _mm_min_ps(_mm_load_ps(a.low.data()), _mm_load_ps(b.low.data())));
  _mm_store_ps(box.high.data(), _mm_max_ps(_mm_load_ps(a.high.data()), _mm_load_ps(b.high.data())));
  return box;
}

// The unit normal of a triangle, rounded outward; of one without area, all directions.
FloatBox normal_bounds(const DeformedSurface& s, Index t) {
  const auto& c = s.topology().corners[t];
  const Vec3 a = s.position(c[0]);
  const Vec3 area = (s.position(c[1]) - a).cross(s.position(c[2]) - a);
  const double length2 = area.squaredNorm();
  if (!(length2 > 0)) return {{-1, -1, -1, 0}, {1, 1, 1, 0}};
  const double scale = 1 / std::sqrt(length2);
  FloatBox box;
  for (int k = 0; k < 3; ++k) {
    box.low[k] = float(area[k] * scale) - 1e-6F;
    box.high[k] = float(area[k] * scale) + 1e-6F;
  }
  return box;
}

// The narrowest round cone around the mean of the same normals of a leaf: tighter than the box, dearer
// to join, so for leaves alone.
void bound_leaf_cones(const DeformedSurface& s, ProximityWork::Arrays& work) {
  const auto& topology = s.topology();
  work.face_normals.resize(topology.corners.size());
  for (std::size_t t = 0; t < topology.corners.size(); ++t)
    work.face_normals[t] = s.face_normal(static_cast<Index>(t)).cast<float>();
  work.cones.resize(std::size_t(s.tree().leaf_count()));
  for (const auto& node : s.tree().tree()) {
    if (!node.is_leaf()) continue;
    Eigen::Vector3f axis = Eigen::Vector3f::Zero();
    for (const Index t : s.tree().leaf_triangles(node)) axis += work.face_normals[t];
    axis.normalize();
    float cosine = 1;
    for (const Index v : s.tree().leaf_corners(node))
      for (const Index t : topology.fan(v)) cosine = std::min(cosine, axis.dot(work.face_normals[t]));
    work.cones[node.leaf] = {axis, std::acos(std::max(cosine, -1.0F)) + 1e-3F};
  }
}

bool may_face(const NormalCone& a, const NormalCone& b) {
  const float rest = std::acos(float(same_side_cosine)) - a.half_angle - b.half_angle;
  return !(rest > 0) || a.axis.dot(b.axis) < std::cos(rest);
}

// Bounds of the normals of all triangles that touch a leaf: a box in the space of normals holds a cone
// of them, and two boxes join by minima and maxima alone.
void bound_normals(const DeformedSurface& s, ProximityWork::Arrays& work) {
  const auto tree = s.tree().tree();
  const auto& topology = s.topology();
  auto& of_vertex = work.vertex_normals;
  of_vertex.assign(std::size_t(topology.vertex_count()), {{2, 2, 2, 0}, {-2, -2, -2, 0}});
  for (std::size_t t = 0; t < topology.corners.size(); ++t) {
    const FloatBox normal = normal_bounds(s, static_cast<Index>(t));
    for (const Index v : topology.corners[t]) of_vertex[v] = joined(of_vertex[v], normal);
  }
  work.normals.resize(tree.size());
  for (std::size_t n = tree.size(); n-- > 0;) {
    if (!tree[n].is_leaf()) {
      work.normals[n] = joined(work.normals[tree[n].left], work.normals[tree[n].right]);
      continue;
    }
    const auto corners = s.tree().leaf_corners(tree[n]);
    FloatBox box = of_vertex[corners[0]];
    for (const Index v : corners.subspan(1)) box = joined(box, of_vertex[v]);
    work.normals[n] = box;
  }
}

// Whether normals of the two boxes may have a cosine below `same_side_cosine`.
bool may_face(const FloatBox& a, const FloatBox& b) {
  const __m128 al = _mm_load_ps(a.low.data()), ah = _mm_load_ps(a.high.data());
  const __m128 bl = _mm_load_ps(b.low.data()), bh = _mm_load_ps(b.high.data());
  const __m128 products = _mm_min_ps(_mm_min_ps(_mm_mul_ps(al, bl), _mm_mul_ps(al, bh)),
                                     _mm_min_ps(_mm_mul_ps(ah, bl), _mm_mul_ps(ah, bh)));
  const float least = _mm_cvtss_f32(_mm_dp_ps(products, _mm_set1_ps(1), 0x71));
  return least < float(same_side_cosine) + 1e-5F;
}

float diagonal2(const FloatBox& box) {
  float sum = 0;
  for (int k = 0; k < 3; ++k) sum += (box.high[k] - box.low[k]) * (box.high[k] - box.low[k]);
  return sum;
}

}  // namespace

void find_leaf_pairs(const SurfaceTree& a, std::span<const FloatBox> boxes_a, const SurfaceTree& b,
                     std::span<const FloatBox> boxes_b, double distance, ProximityWork::Arrays& work) {
  work.leaves.clear();
  work.stack.clear();
  if (boxes_a.empty() || boxes_b.empty()) return;
  const float radius2 = box_radius(distance);
  const auto tree_a = a.tree(), tree_b = b.tree();
  const auto offer = [&](Index i, Index j) {
    if (squared_distance(boxes_a[i], boxes_b[j]) <= radius2) work.stack.push_back({i, j});
  };
  offer(0, 0);
  while (!work.stack.empty()) {
    const auto pair = work.stack.back();
    work.stack.pop_back();
    const auto &i = tree_a[pair.a], &j = tree_b[pair.b];
    if (i.is_leaf() && j.is_leaf()) {
      work.leaves.push_back(pair);
    } else if (j.is_leaf() ||
               (!i.is_leaf() && diagonal2(boxes_a[pair.a]) > diagonal2(boxes_b[pair.b]))) {
      offer(i.left, pair.b);
      offer(i.right, pair.b);
    } else {
      offer(pair.a, j.left);
      offer(pair.a, j.right);
    }
  }
}

void find_self_leaf_pairs(const DeformedSurface& s, double distance, ProximityWork::Arrays& work) {
  work.leaves.clear();
  work.stack.clear();
  const auto tree = s.tree().tree();
  if (tree.empty()) return;
  bound_normals(s, work);
  bound_leaf_cones(s, work);
  const float radius2 = box_radius(distance);
  const auto offer = [&](Index i, Index j) {
    if (may_face(work.normals[i], work.normals[j]) && squared_distance(s.box(i), s.box(j)) <= radius2)
      work.stack.push_back({i, j});
  };
  offer(0, 0);
  while (!work.stack.empty()) {
    const auto pair = work.stack.back();
    work.stack.pop_back();
    const auto &i = tree[pair.a], &j = tree[pair.b];
    if (i.is_leaf() && j.is_leaf()) {
      if (may_face(work.cones[i.leaf], work.cones[j.leaf])) work.leaves.push_back(pair);
    } else if (pair.a == pair.b) {
      offer(i.left, i.left);
      offer(i.left, i.right);
      offer(i.right, i.right);
    } else if (j.is_leaf() || (!i.is_leaf() && diagonal2(s.box(pair.a)) > diagonal2(s.box(pair.b)))) {
      offer(i.left, pair.b);
      offer(i.right, pair.b);
    } else {
      offer(pair.a, j.left);
      offer(pair.a, j.right);
    }
  }
}

}  // namespace souple
