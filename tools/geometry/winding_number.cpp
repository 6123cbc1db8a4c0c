// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/geometry/winding_number.hpp"

#include <algorithm>
#include <numbers>

#include "tools/geometry/vector.hpp"

namespace souple {
namespace {

constexpr std::size_t leaf_size = 8;
/// A cluster is far beyond this many of its radii. Barill et al. use 2; with 3 the sum over real
/// surfaces stays within 0.05 of a whole number.
constexpr double far_radii = 3;

using Corners = std::array<Point, 3>;

Point area_vector(const Corners& c) {
  return scaled(cross(subtract(c[1], c[0]), subtract(c[2], c[0])), 0.5);
}

Point centroid(const Corners& c) { return scaled(add(add(c[0], c[1]), c[2]), 1.0 / 3.0); }

/// Solid angle under which p sees the triangle, positive from its back (van Oosterom and Strackee
/// 1983).
double solid_angle(const Point& p, const Corners& corners) {
  const Point a = subtract(corners[0], p), b = subtract(corners[1], p), c = subtract(corners[2], p);
  const double la = norm(a), lb = norm(b), lc = norm(c);
  const double below = la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb;
  return 2 * std::atan2(dot(a, cross(b, c)), below);
}

}  // namespace

WindingNumber::WindingNumber(const TriangleMesh& mesh) {
  corners_.reserve(mesh.triangles.size());
  for (const Triangle& t : mesh.triangles)
    corners_.push_back({mesh.vertices[static_cast<std::size_t>(t[0])],
                        mesh.vertices[static_cast<std::size_t>(t[1])],
                        mesh.vertices[static_cast<std::size_t>(t[2])]});
  if (!corners_.empty()) build(corners_, 0);
}

// Median split along the longest side of the centroids' box: the depth is logarithmic whatever the
// input.
Index WindingNumber::build(std::span<Corners> range, std::size_t offset) {
  const auto self = static_cast<Index>(nodes_.size());
  Node node;
  double weight = 0;
  Point low = centroid(range[0]), high = low, middle{};
  for (const Corners& c : range) {
    const Point area = area_vector(c), q = centroid(c);
    node.area = add(node.area, area);
    node.centre = add_scaled(node.centre, norm(area), q);
    weight += norm(area);
    for (std::size_t k = 0; k < 3; ++k) {
      low[k] = std::min(low[k], q[k]);
      high[k] = std::max(high[k], q[k]);
    }
  }
  middle = scaled(add(low, high), 0.5);
  node.centre = weight > 0 ? scaled(node.centre, 1 / weight) : middle;
  for (const Corners& c : range)
    for (const Point& p : c)
      node.squared_far = std::max(node.squared_far, squared_norm(subtract(p, node.centre)));
  node.squared_far *= far_radii * far_radii;
  nodes_.push_back(node);
  if (range.size() <= leaf_size) {
    nodes_.back().first = static_cast<Index>(offset);
    nodes_.back().count = static_cast<Index>(range.size());
    return self;
  }
  const Point side = subtract(high, low);
  const auto axis = static_cast<std::size_t>(std::ranges::max_element(side) - side.begin());
  const std::size_t half = range.size() / 2;
  std::ranges::nth_element(range, range.begin() + static_cast<std::ptrdiff_t>(half),
                           [&](const Corners& a, const Corners& b) {
                             const double ca = centroid(a)[axis], cb = centroid(b)[axis];
                             return ca != cb ? ca < cb : a < b;
                           });
  build(range.first(half), offset);
  const Index right = build(range.subspan(half), offset + half);
  nodes_[static_cast<std::size_t>(self)].first = right;
  return self;
}

double WindingNumber::at(const Point& p) const {
  if (nodes_.empty()) return 0;
  std::array<Index, 64> stack;  // the depth of 2^31 triangles, and one
  std::size_t height = 0;
  stack[height++] = 0;
  double angle = 0;
  while (height > 0) {
    const Index index = stack[--height];
    const Node& node = nodes_[static_cast<std::size_t>(index)];
    const Point to = subtract(node.centre, p);
    const double squared = squared_norm(to);
    if (squared > node.squared_far) {
      angle += dot(node.area, to) / (squared * std::sqrt(squared));
    } else if (node.count > 0) {
      for (Index i = 0; i < node.count; ++i)
        angle += solid_angle(p, corners_[static_cast<std::size_t>(node.first + i)]);
    } else {
      stack[height++] = node.first;
      stack[height++] = index + 1;
    }
  }
  return angle / (4 * std::numbers::pi);
}

}  // namespace souple
