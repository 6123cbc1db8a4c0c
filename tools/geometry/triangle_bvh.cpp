// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/geometry/triangle_bvh.hpp"

#include <algorithm>
#include <array>

#include "tools/geometry/vector.hpp"

namespace souple {
namespace {

Point closest_point_on_segment(const Point& p, const Point& a, const Point& b) {
  const Point ab = subtract(b, a);
  const double length2 = squared_norm(ab);
  if (length2 <= 0) return a;
  return add_scaled(a, std::clamp(dot(subtract(p, a), ab) / length2, 0.0, 1.0), ab);
}

Point closest_point_on_edges(const Point& p, const Point& a, const Point& b, const Point& c) {
  Point best = closest_point_on_segment(p, a, b);
  for (const Point& q : {closest_point_on_segment(p, b, c), closest_point_on_segment(p, c, a)})
    if (squared_norm(subtract(q, p)) < squared_norm(subtract(best, p))) best = q;
  return best;
}

double squared_distance_to_box(const Point& p, const Box& box) {
  double sum = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const double d = std::max({box.low[k] - p[k], 0.0, p[k] - box.high[k]});
    sum += d * d;
  }
  return sum;
}

bool nearer(const ClosestPoint& a, const ClosestPoint& b) {
  return a.squared_distance != b.squared_distance ? a.squared_distance < b.squared_distance
                                                  : a.triangle < b.triangle;
}

/// Inserts into the ascending list `out` whose last entry falls off.
void insert_sorted(std::span<ClosestPoint> out, const ClosestPoint& candidate) {
  if (out.back().triangle >= 0 && !nearer(candidate, out.back())) return;
  std::size_t i = out.size() - 1;
  for (; i > 0 && (out[i - 1].triangle < 0 || nearer(candidate, out[i - 1])); --i) out[i] = out[i - 1];
  out[i] = candidate;
}

std::vector<std::array<Point, 3>> corners_of(const TriangleMesh& mesh) {
  std::vector<std::array<Point, 3>> corners;
  corners.reserve(mesh.triangles.size());
  for (const Triangle& t : mesh.triangles)
    corners.push_back({mesh.vertices[static_cast<std::size_t>(t[0])],
                       mesh.vertices[static_cast<std::size_t>(t[1])],
                       mesh.vertices[static_cast<std::size_t>(t[2])]});
  return corners;
}

BoxTree tree_of(const std::vector<std::array<Point, 3>>& triangles) {
  std::vector<Box> boxes;
  std::vector<Point> centroids;
  boxes.reserve(triangles.size());
  centroids.reserve(triangles.size());
  for (const auto& c : triangles) {
    boxes.push_back(bounding_box(c));
    centroids.push_back(scaled(add(add(c[0], c[1]), c[2]), 1.0 / 3.0));
  }
  return {boxes, centroids, 0};
}

}  // namespace

Point closest_point_on_triangle(const Point& p, const Point& a, const Point& b, const Point& c) {
  const Point ab = subtract(b, a), ac = subtract(c, a), ap = subtract(p, a);
  const double d1 = dot(ab, ap), d2 = dot(ac, ap);
  if (d1 <= 0 && d2 <= 0) return a;
  const Point bp = subtract(p, b);
  const double d3 = dot(ab, bp), d4 = dot(ac, bp);
  if (d3 >= 0 && d4 <= d3) return b;
  const Point cp = subtract(p, c);
  const double d5 = dot(ab, cp), d6 = dot(ac, cp);
  if (d6 >= 0 && d5 <= d6) return c;
  const double va = d3 * d6 - d5 * d4, vb = d5 * d2 - d1 * d6, vc = d1 * d4 - d3 * d2;
  if (va <= 0 || vb <= 0 || vc <= 0) return closest_point_on_edges(p, a, b, c);
  const double sum = va + vb + vc;
  return add_scaled(add_scaled(a, vb / sum, ab), vc / sum, ac);
}

TriangleBvh::TriangleBvh(const TriangleMesh& mesh)
    : corners_(corners_of(mesh)), tree_(tree_of(corners_)) {}

std::size_t TriangleBvh::nearest(const Point& p, std::span<ClosestPoint> out) const {
  std::ranges::fill(out, ClosestPoint{});
  const auto nodes = tree_.nodes();
  if (nodes.empty() || out.empty()) return 0;
  struct Pending {
    Index node;
    double squared_distance;
  };
  std::array<Pending, BoxTree::deepest_walk> stack;
  std::size_t height = 0;
  const auto push = [&](Index index) {
    stack[height++] = {index, squared_distance_to_box(p, nodes[static_cast<std::size_t>(index)].box)};
  };
  push(0);
  while (height > 0) {
    const Pending pending = stack[--height];
    if (pending.squared_distance > out.back().squared_distance) continue;
    const BoxTree::Node& node = nodes[static_cast<std::size_t>(pending.node)];
    for (Index i = 0; i < node.count; ++i) {
      const Index t = tree_.order()[static_cast<std::size_t>(node.first + i)];
      const auto& c = corners_[static_cast<std::size_t>(t)];
      const Point q = closest_point_on_triangle(p, c[0], c[1], c[2]);
      insert_sorted(out, {q, squared_norm(subtract(q, p)), t});
    }
    if (node.count > 0) continue;
    push(node.first);
    push(pending.node + 1);
    if (stack[height - 1].squared_distance > stack[height - 2].squared_distance)
      std::swap(stack[height - 1], stack[height - 2]);
  }
  return std::min(out.size(), corners_.size());
}

ClosestPoint TriangleBvh::closest(const Point& p) const {
  ClosestPoint best;
  nearest(p, {&best, 1});
  return best;
}

}  // namespace souple
