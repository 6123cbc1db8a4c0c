// SPDX-License-Identifier: MIT
#include "runtime/collision/surface_tree.hpp"

#include <immintrin.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

namespace souple {
namespace {

constexpr Index leaf_size = 4;

}  // namespace

SurfaceTree::SurfaceTree(std::span<const Point> rest_positions, std::vector<Triangle> boundary)
    : triangles_(std::move(boundary)), topology_(triangles_), order_(triangles_.size()) {
  std::iota(order_.begin(), order_.end(), 0);
  for (const Index node : topology_.nodes) rest_.push_back(as_vec3(rest_positions[node]));
  std::vector<Vec3> centres;
  for (const auto& t : topology_.corners)
    centres.push_back((rest_[t[0]] + rest_[t[1]] + rest_[t[2]]) / 3);
  if (!triangles_.empty()) build(centres, 0, static_cast<Index>(triangles_.size()));
  assign_features();
}

// Median split along the longest side of the centres' box: depth log2 of the count.
void SurfaceTree::build(std::span<const Vec3> centres, Index first, Index last) {
  const auto self = tree_.size();
  tree_.push_back({first, last - first, -1, -1, -1});
  if (last - first <= leaf_size) return;
  Eigen::AlignedBox3d box;
  for (Index k = first; k < last; ++k) box.extend(centres[order_[k]]);
  Eigen::Index axis = 0;
  box.sizes().maxCoeff(&axis);
  const Index middle = first + (last - first) / 2;
  std::nth_element(order_.begin() + first, order_.begin() + middle, order_.begin() + last,
                   [&](Index a, Index b) {
                     const double ca = centres[a][axis], cb = centres[b][axis];
                     return ca != cb ? ca < cb : a < b;
                   });
  tree_[self].count = 0;
  tree_[self].left = static_cast<Index>(tree_.size());
  build(centres, first, middle);
  tree_[self].right = static_cast<Index>(tree_.size());
  build(centres, middle, last);
}

void SurfaceTree::assign_features() {
  std::vector<char> vertex_taken(std::size_t(topology_.vertex_count()), 0);
  std::vector<char> edge_taken(std::size_t(topology_.edge_count()), 0);
  const auto close_leaf = [&] {
    vertex_start_.push_back(static_cast<Index>(own_vertices_.size()));
    edge_start_.push_back(static_cast<Index>(own_edges_.size()));
    corner_start_.push_back(static_cast<Index>(corner_vertices_.size()));
  };
  close_leaf();
  for (TreeNode& node : tree_) {
    if (!node.is_leaf()) continue;
    node.leaf = static_cast<Index>(vertex_start_.size()) - 1;
    for (const Index t : leaf_triangles(node)) {
      for (const Index v : topology_.corners[t]) {
        corner_vertices_.push_back(v);
        if (!std::exchange(vertex_taken[v], 1)) own_vertices_.push_back(v);
      }
      for (const Index e : topology_.triangle_edges[t])
        if (!std::exchange(edge_taken[e], 1)) own_edges_.push_back(e);
    }
    const auto corners = corner_vertices_.begin() + corner_start_.back();
    std::sort(corners, corner_vertices_.end());
    corner_vertices_.erase(std::unique(corners, corner_vertices_.end()), corner_vertices_.end());
    close_leaf();
  }
}

std::size_t SurfaceTree::bytes() const {
  return topology_.bytes() + triangles_.size() * sizeof(Triangle) + rest_.size() * sizeof(Vec3) +
         tree_.size() * sizeof(TreeNode) +
         (order_.size() + own_vertices_.size() + own_edges_.size() + corner_vertices_.size() +
          3 * vertex_start_.size()) *
             sizeof(Index);
}

DeformedSurface::DeformedSurface(const SurfaceTree& tree)
    : tree_(&tree), boxes_(tree.tree().size()), points_(tree.nodes().size()) {}

Vec3 DeformedSurface::face_normal(Index triangle) const {
  const Vec3 a = corner(triangle, 0);
  return (corner(triangle, 1) - a).cross(corner(triangle, 2) - a).normalized();
}

void DeformedSurface::convert_points() {
  const double* x = x_->data();
  const auto nodes = tree_->nodes();
  const __m128 sign = _mm_set1_ps(-0.0F);
  const __m256i three = _mm256_set_epi64x(0, -1, -1, -1);
  __m128 largest = _mm_setzero_ps();
  for (std::size_t v = 0; v < nodes.size(); ++v) {
    const __m128 at = _mm256_cvtpd_ps(_mm256_maskload_pd(x + 3 * std::ptrdiff_t{nodes[v]}, three));
    _mm_store_ps(points_[v].at.data(), at);
    largest = _mm_max_ps(largest, _mm_andnot_ps(sign, at));
  }
  alignas(16) std::array<float, 4> sides;
  _mm_store_ps(sides.data(), largest);
  // Half a unit in the last place, twice over for the subtraction that widens the boxes.
  rounding_ = std::max({sides[0], sides[1], sides[2]}) * 0x1p-22F + 1e-37F;
}

void DeformedSurface::refit(const Eigen::VectorXd& x) {
  x_ = &x;
  convert_points();
  const auto tree = tree_->tree();
  const __m128 margin = _mm_set_ps(0, rounding_, rounding_, rounding_);
  for (std::size_t n = tree.size(); n-- > 0;) {
    __m128 low, high;
    if (tree[n].is_leaf()) {
      const auto corners = tree_->leaf_corners(tree[n]);
      low = high = _mm_load_ps(points_[corners[0]].at.data());
      for (const Index v : corners.subspan(1)) {
        const __m128 at = _mm_load_ps(points_[v].at.data());
        low = _mm_min_ps(low, at);
        high = _mm_max_ps(high, at);
      }
      low = _mm_sub_ps(low, margin);
      high = _mm_add_ps(high, margin);
    } else {
      const FloatBox& left = boxes_[tree[n].left];
      const FloatBox& right = boxes_[tree[n].right];
      low = _mm_min_ps(_mm_load_ps(left.low.data()), _mm_load_ps(right.low.data()));
      high = _mm_max_ps(_mm_load_ps(left.high.data()), _mm_load_ps(right.high.data()));
    }
    _mm_store_ps(boxes_[n].low.data(), low);
    _mm_store_ps(boxes_[n].high.data(), high);
  }
  bounds_.setEmpty();
  if (boxes_.empty()) return;
  for (int k = 0; k < 3; ++k) {
    bounds_.min()[k] = double(boxes_[0].low[k]);
    bounds_.max()[k] = double(boxes_[0].high[k]);
  }
}

Vec3 DeformedSurface::normal_of_vertex(Index vertex) const {
  Vec3 sum = Vec3::Zero();
  for (const Index t : topology().fan(vertex)) {
    const auto& c = topology().corners[t];
    const int k = c[0] == vertex ? 0 : (c[1] == vertex ? 1 : 2);
    const Vec3 at = corner(t, k);
    const Vec3 u = corner(t, (k + 1) % 3) - at, v = corner(t, (k + 2) % 3) - at;
    const Vec3 area = u.cross(v);
    const double length = area.norm();
    if (length > 0) sum += (std::atan2(length, u.dot(v)) / length) * area;
  }
  return sum.normalized();
}

SurfaceHit DeformedSurface::closest(const Vec3& point, double radius) const {
  SurfaceHit hit;
  double best = radius * radius;
  std::array<Index, 64> stack;  // depth is log2(triangles / leaf_size) + 1
  int top = 0;
  if (!boxes_.empty()) stack[top++] = 0;
  while (top > 0) {
    const auto& node = tree_->tree()[stack[--top]];
    for (const Index t : tree_->leaf_triangles(node)) {
      const auto closest = closest_on(t, point);
      const double distance2 = (point - closest.point).squaredNorm();
      if (distance2 < best) {
        best = distance2;
        hit = {t, closest, 0};
      }
    }
    if (node.is_leaf()) continue;
    const double left = squared_distance(boxes_[node.left], point);
    const double right = squared_distance(boxes_[node.right], point);
    // The nearer child is pushed last, so that it is searched first.
    if (std::max(left, right) < best) stack[top++] = left < right ? node.right : node.left;
    if (std::min(left, right) < best) stack[top++] = left < right ? node.left : node.right;
  }
  hit.distance = std::sqrt(best);
  return hit;
}

Vec3 DeformedSurface::pseudo_normal(Index triangle, const ClosestOnTriangle& closest) const {
  const int feature = closest.feature;
  if (feature < 3) return normal_of_vertex(topology().corners[triangle][feature]);
  if (feature == 6) return face_normal(triangle);
  const auto& edge = topology().edges[topology().triangle_edges[triangle][feature - 3]];
  const Vec3 first = face_normal(edge.triangle[0]);
  return edge.triangle[1] < 0 ? first : Vec3((first + face_normal(edge.triangle[1])).normalized());
}

}  // namespace souple
