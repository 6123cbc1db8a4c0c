// SPDX-License-Identifier: MIT
#include "runtime/collision/surface_tree.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace souple {
namespace {

constexpr Index leaf_size = 4;

struct DirectedEdge {
  Index from, to, triangle;
  int corner;
};

std::vector<std::array<Index, 3>> triangle_neighbours(std::span<const Triangle> triangles) {
  std::vector<DirectedEdge> edges;
  for (std::size_t t = 0; t < triangles.size(); ++t)
    for (int k = 0; k < 3; ++k)
      edges.push_back({triangles[t][k], triangles[t][(k + 1) % 3], static_cast<Index>(t), k});
  const auto by_ends = [](const DirectedEdge& e) { return std::pair(e.from, e.to); };
  std::ranges::sort(edges, {}, by_ends);
  std::vector<std::array<Index, 3>> neighbours(triangles.size(), {-1, -1, -1});
  for (const auto& edge : edges) {
    const auto twin = std::ranges::lower_bound(edges, std::pair(edge.to, edge.from), {}, by_ends);
    if (twin != edges.end() && twin->from == edge.to && twin->to == edge.from)
      neighbours[edge.triangle][edge.corner] = twin->triangle;
  }
  return neighbours;
}

}  // namespace

SurfaceTree::SurfaceTree(std::span<const Point> rest_positions, std::vector<Triangle> boundary)
    : triangles_(std::move(boundary)),
      neighbours_(triangle_neighbours(triangles_)),
      nodes_(used_nodes(triangles_)),
      order_(triangles_.size()) {
  std::iota(order_.begin(), order_.end(), 0);
  std::vector<Vec3> centres;
  for (const auto& t : triangles_)
    centres.push_back((as_vec3(rest_positions[t[0]]) + as_vec3(rest_positions[t[1]]) +
                       as_vec3(rest_positions[t[2]])) /
                      3);
  if (!triangles_.empty()) build(centres, 0, static_cast<Index>(triangles_.size()));
}

// Median split along the longest side of the centres' box: depth log2 of the count.
void SurfaceTree::build(std::span<const Vec3> centres, Index first, Index last) {
  const auto self = tree_.size();
  tree_.push_back({first, last - first, -1, -1});
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

std::size_t SurfaceTree::bytes() const {
  return triangles_.size() * (sizeof(Triangle) + sizeof(neighbours_[0]) + sizeof(Index)) +
         nodes_.size() * sizeof(Index) + tree_.size() * sizeof(TreeNode);
}

DeformedSurface::DeformedSurface(const SurfaceTree& tree) : tree_(&tree), boxes_(tree.tree_.size()) {
  const Index last = tree.nodes_.empty() ? -1 : tree.nodes_.back();
  vertex_normals_.assign(std::size_t(last + 1), Vec3::Zero());
}

Vec3 DeformedSurface::corner(Index triangle, int k) const {
  return node_entry(*x_, tree_->triangles_[triangle][k]);
}

Vec3 DeformedSurface::face_normal(Index triangle) const {
  return (corner(triangle, 1) - corner(triangle, 0))
      .cross(corner(triangle, 2) - corner(triangle, 0))
      .normalized();
}

void DeformedSurface::refit(const Eigen::VectorXd& x) {
  x_ = &x;
  for (std::size_t n = tree_->tree_.size(); n-- > 0;) {
    const auto& node = tree_->tree_[n];
    Eigen::AlignedBox3d box;
    for (Index k = node.first; k < node.first + node.count; ++k)
      for (int c = 0; c < 3; ++c) box.extend(corner(tree_->order_[k], c));
    if (node.count == 0) box = boxes_[node.left].merged(boxes_[node.right]);
    boxes_[n] = box;
  }
  update_normals();
}

void DeformedSurface::update_normals() {
  for (const Index node : tree_->nodes_) vertex_normals_[node].setZero();
  for (std::size_t t = 0; t < tree_->triangles_.size(); ++t) {
    const auto triangle = static_cast<Index>(t);
    const Vec3 normal = face_normal(triangle);
    for (int k = 0; k < 3; ++k) {
      const Vec3 u = corner(triangle, (k + 1) % 3) - corner(triangle, k);
      const Vec3 v = corner(triangle, (k + 2) % 3) - corner(triangle, k);
      vertex_normals_[tree_->triangles_[t][k]] += std::atan2(u.cross(v).norm(), u.dot(v)) * normal;
    }
  }
  for (const Index node : tree_->nodes_) vertex_normals_[node].normalize();
}

SurfaceHit DeformedSurface::closest(const Vec3& point, double radius) const {
  SurfaceHit hit;
  double best = radius * radius;
  std::array<Index, 64> stack;  // depth is log2(triangles / leaf_size) + 1
  int top = 0;
  if (!boxes_.empty()) stack[top++] = 0;
  while (top > 0) {
    const auto& node = tree_->tree_[stack[--top]];
    for (Index k = node.first; k < node.first + node.count; ++k) {
      const Index t = tree_->order_[k];
      const auto closest = closest_on_triangle(point, corner(t, 0), corner(t, 1), corner(t, 2));
      const double distance2 = (point - closest.point).squaredNorm();
      if (distance2 < best) {
        best = distance2;
        hit = {t, closest, 0};
      }
    }
    if (node.count > 0) continue;
    const double left = boxes_[node.left].squaredExteriorDistance(point);
    const double right = boxes_[node.right].squaredExteriorDistance(point);
    // The nearer child is pushed last, so that it is searched first.
    if (std::max(left, right) < best) stack[top++] = left < right ? node.right : node.left;
    if (std::min(left, right) < best) stack[top++] = left < right ? node.left : node.right;
  }
  hit.distance = std::sqrt(best);
  return hit;
}

Vec3 DeformedSurface::pseudo_normal(const SurfaceHit& hit) const {
  const int feature = hit.closest.feature;
  if (feature < 3) return vertex_normals_[tree_->triangles_[hit.triangle][feature]];
  const Vec3 own = face_normal(hit.triangle);
  if (feature == 6) return own;
  const Index neighbour = tree_->neighbours_[hit.triangle][feature - 3];
  return neighbour < 0 ? own : Vec3((own + face_normal(neighbour)).normalized());
}

}  // namespace souple
