// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <span>
#include <vector>

#include "runtime/collision/triangle_distance.hpp"

namespace souple {

/// The constant part of a body's collision surface: its boundary triangles, their neighbours and a
/// bounding-volume hierarchy over them, built in the rest shape.
class SurfaceTree {
 public:
  SurfaceTree() = default;
  SurfaceTree(std::span<const Point> rest_positions, std::vector<Triangle> boundary);

  std::span<const Triangle> triangles() const { return triangles_; }
  std::span<const Index> nodes() const { return nodes_; }  ///< on the surface, ascending
  std::size_t tree_node_count() const { return tree_.size(); }
  std::size_t bytes() const;

 private:
  friend class DeformedSurface;
  struct TreeNode {
    Index first, count;  ///< leaf: triangles order_[first, first + count); else count = 0 and
    Index left, right;   ///< children, both after their parent
  };
  void build(std::span<const Vec3> centres, Index first, Index last);

  std::vector<Triangle> triangles_;
  std::vector<std::array<Index, 3>> neighbours_;  ///< across edge k to k+1 of every triangle, or -1
  std::vector<Index> nodes_;
  std::vector<Index> order_;
  std::vector<TreeNode> tree_;
};

struct SurfaceHit {
  Index triangle = -1;  ///< -1: nothing within the radius
  ClosestOnTriangle closest;
  double distance = 0;  ///< unsigned, m
};

/// The same surface in its present shape. Owns the boxes and normals of one instance; refit and the
/// queries allocate nothing.
class DeformedSurface {
 public:
  explicit DeformedSurface(const SurfaceTree& tree);

  /// Boxes and vertex normals for positions `x` (3 per node of the mesh); `x` must outlive the queries.
  void refit(const Eigen::VectorXd& x);
  const Eigen::AlignedBox3d& bounds() const { return boxes_.front(); }
  /// The nearest triangle closer than `radius`.
  SurfaceHit closest(const Vec3& point, double radius) const;
  /// Outward pseudo-normal of the feature that was hit (Baerentzen and Aanaes 2005): the sign of
  /// (point - hit) . normal tells outside from inside.
  Vec3 pseudo_normal(const SurfaceHit& hit) const;
  Vec3 vertex_normal(Index node) const { return vertex_normals_[node]; }

 private:
  Vec3 corner(Index triangle, int k) const;
  Vec3 face_normal(Index triangle) const;
  void update_normals();

  const SurfaceTree* tree_;
  const Eigen::VectorXd* x_ = nullptr;
  std::vector<Eigen::AlignedBox3d> boxes_;
  std::vector<Vec3> vertex_normals_;  ///< by mesh node, unit, angle-weighted
};

}  // namespace souple
