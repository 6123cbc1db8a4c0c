// SPDX-License-Identifier: MIT
#pragma once
#include <algorithm>
#include <array>
#include <span>
#include <vector>

#include "runtime/collision/surface_topology.hpp"
#include "runtime/collision/triangle_distance.hpp"

namespace souple {

/// The constant part of a body's collision surface: its boundary triangles, how they hang together and
/// a bounding-volume hierarchy over them, built in the rest shape.
class SurfaceTree {
 public:
  struct TreeNode {
    Index first = 0, count = 0;   ///< leaf: positions in leaf_triangles; else count = 0 and
    Index left = -1, right = -1;  ///< children, both after their parent
    Index leaf = -1;              ///< number of the leaf
    bool is_leaf() const { return count > 0; }
  };

  SurfaceTree() = default;
  SurfaceTree(std::span<const Point> rest_positions, std::vector<Triangle> boundary);

  std::span<const Triangle> triangles() const { return triangles_; }
  std::span<const Index> nodes() const { return topology_.nodes; }  ///< on the surface, ascending
  const CollisionTopology& topology() const { return topology_; }
  const Vec3& rest_position(Index vertex) const { return rest_[vertex]; }
  std::size_t tree_node_count() const { return tree_.size(); }
  std::size_t bytes() const;

  /// Numbers of features, unique within the body: vertices, then edges, then triangles.
  Index vertex_feature(Index vertex) const { return vertex; }
  Index edge_feature(Index edge) const { return topology_.vertex_count() + edge; }
  Index face_feature(Index triangle) const {
    return topology_.vertex_count() + topology_.edge_count() + triangle;
  }

  std::span<const TreeNode> tree() const { return tree_; }
  Index leaf_count() const { return static_cast<Index>(vertex_start_.size()) - 1; }
  std::span<const Index> leaf_triangles(const TreeNode& leaf) const {
    return {order_.data() + leaf.first, std::size_t(leaf.count)};
  }
  /// Vertices and edges that belong to this leaf: each belongs to the first of its triangles' leaves.
  std::span<const Index> leaf_vertices(const TreeNode& leaf) const {
    return part(own_vertices_, vertex_start_, leaf.leaf);
  }
  std::span<const Index> leaf_edges(const TreeNode& leaf) const {
    return part(own_edges_, edge_start_, leaf.leaf);
  }
  /// All vertices of the leaf's triangles, each once.
  std::span<const Index> leaf_corners(const TreeNode& leaf) const {
    return part(corner_vertices_, corner_start_, leaf.leaf);
  }

 private:
  static std::span<const Index> part(const std::vector<Index>& all, const std::vector<Index>& start,
                                     Index k) {
    return {all.data() + start[k], all.data() + start[k + 1]};
  }
  void build(std::span<const Vec3> centres, Index first, Index last);
  void assign_features();

  std::vector<Triangle> triangles_;
  CollisionTopology topology_;
  std::vector<Vec3> rest_;
  std::vector<Index> order_;
  std::vector<TreeNode> tree_;
  std::vector<Index> vertex_start_, own_vertices_, edge_start_, own_edges_, corner_start_,
      corner_vertices_;
};

/// A box in single precision that holds what it must: rounded outward. The fourth entries are 0.
struct alignas(32) FloatBox {
  std::array<float, 4> low{}, high{};
};

struct SurfaceHit {
  Index triangle = -1;  ///< -1: nothing within the radius
  ClosestOnTriangle closest;
  double distance = 0;  ///< unsigned, m
};

/// The same surface in its present shape. Owns the boxes of one instance; refit and the queries
/// allocate nothing. Normals are worked out where they are asked for.
class DeformedSurface {
 public:
  explicit DeformedSurface(const SurfaceTree& tree);

  /// Boxes for positions `x` (3 per node of the mesh); `x` must outlive the queries.
  void refit(const Eigen::VectorXd& x);
  const Eigen::AlignedBox3d& bounds() const { return bounds_; }
  /// The nearest triangle closer than `radius`.
  SurfaceHit closest(const Vec3& point, double radius) const;
  /// Outward pseudo-normal of the feature that was hit (Baerentzen and Aanaes 2005): the sign of
  /// (point - hit) . normal tells outside from inside.
  Vec3 pseudo_normal(const SurfaceHit& hit) const { return pseudo_normal(hit.triangle, hit.closest); }
  Vec3 pseudo_normal(Index triangle, const ClosestOnTriangle& closest) const;
  Vec3 vertex_normal(Index node) const {
    return normal_of_vertex(tree_->topology().vertex_of_node[node]);
  }

  const SurfaceTree& tree() const { return *tree_; }
  const CollisionTopology& topology() const { return tree_->topology(); }
  std::span<const FloatBox> boxes() const { return boxes_; }
  const FloatBox& box(Index tree_node) const { return boxes_[tree_node]; }
  float rounding() const { return rounding_; }  ///< how far rough positions may be off, m
  const std::array<float, 4>& rough_position(Index vertex) const { return points_[vertex].at; }
  Vec3 position(Index vertex) const { return node_entry(*x_, topology().nodes[vertex]); }
  Vec3 corner(Index triangle, int k) const { return position(topology().corners[triangle][k]); }
  ClosestOnTriangle closest_on(Index triangle, const Vec3& point) const {
    return closest_on_triangle(point, corner(triangle, 0), corner(triangle, 1), corner(triangle, 2));
  }
  Vec3 face_normal(Index triangle) const;     ///< unit; zero for a triangle without area
  Vec3 normal_of_vertex(Index vertex) const;  ///< unit, weighted by angles

  /// Calls visit(triangle) for every triangle whose leaf comes within `radius` of `point`.
  template <class Visit>
  void for_triangles_near(const Vec3& point, double radius, Visit&& visit) const;

 private:
  struct alignas(16) RoughPoint {
    std::array<float, 4> at{};
  };
  void convert_points();

  const SurfaceTree* tree_;
  const Eigen::VectorXd* x_ = nullptr;
  std::vector<FloatBox> boxes_;
  std::vector<RoughPoint> points_;
  float rounding_ = 0;  ///< of the points, m
  Eigen::AlignedBox3d bounds_;
};

/// Squared distance of a point from a box.
inline double squared_distance(const FloatBox& box, const Vec3& point) {
  double sum = 0;
  for (int k = 0; k < 3; ++k) {
    const double beyond =
        std::max({double(box.low[k]) - point[k], point[k] - double(box.high[k]), 0.0});
    sum += beyond * beyond;
  }
  return sum;
}

template <class Visit>
void DeformedSurface::for_triangles_near(const Vec3& point, double radius, Visit&& visit) const {
  std::array<Index, 64> stack;  // depth is log2(triangles / leaf size) + 1
  int top = 0;
  if (!boxes_.empty()) stack[top++] = 0;
  while (top > 0) {
    const Index self = stack[--top];
    if (squared_distance(boxes_[self], point) > radius * radius) continue;
    const auto& node = tree_->tree()[self];
    for (const Index t : tree_->leaf_triangles(node)) visit(t);
    if (node.is_leaf()) continue;
    stack[top++] = node.right;
    stack[top++] = node.left;
  }
}

}  // namespace souple
