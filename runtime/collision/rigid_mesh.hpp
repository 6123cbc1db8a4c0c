// SPDX-License-Identifier: MIT
#pragma once
#include <span>
#include <vector>

#include "formats/core/result.hpp"
#include "runtime/collision/mass_properties.hpp"
#include "runtime/collision/rigid_distance.hpp"
#include "runtime/collision/surface_tree.hpp"

namespace souple {

/// The surface of a rigid body: closed, wound outward, in the body's own frame. Constant; shared by all
/// bodies of that shape.
class RigidMesh {
 public:
  /// Issue rigid_mesh_invalid: not finite, an index out of range, a degenerate triangle, an edge that
  /// does not have exactly one triangle on each side, wound inward, or without volume.
  static Result<RigidMesh> make(TriangleMesh mesh);

  std::span<const Point> vertices() const { return mesh_.vertices; }
  std::span<const Triangle> triangles() const { return mesh_.triangles; }
  const SurfaceTree& tree() const { return tree_; }
  const MassProperties& mass() const { return mass_; }
  std::size_t bytes() const;

 private:
  RigidMesh(TriangleMesh mesh, const MassProperties& mass);

  TriangleMesh mesh_;
  SurfaceTree tree_;
  MassProperties mass_;
};

/// A rigid mesh at a place in the world, ready for the searches.
class PlacedMesh {
 public:
  /// `mesh` must outlive this.
  explicit PlacedMesh(const RigidMesh& mesh);
  PlacedMesh(const PlacedMesh&) = delete;
  PlacedMesh& operator=(const PlacedMesh&) = delete;

  /// Refits the surface, if `at` differs from where it was. Allocates nothing.
  void move_to(const RigidPlacement& at);
  const DeformedSurface& surface() const { return surface_; }
  const RigidPlacement& placement() const { return at_; }
  /// Positions of the vertices at another place, for swept tests; `x` is resized.
  void positions_at(const RigidPlacement& at, Eigen::VectorXd& x) const;

 private:
  const RigidMesh* mesh_;
  RigidPlacement at_;
  bool placed_ = false;
  Eigen::VectorXd x_;
  DeformedSurface surface_;
};

}  // namespace souple
