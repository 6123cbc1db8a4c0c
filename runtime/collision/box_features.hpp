// SPDX-License-Identifier: MIT
#pragma once
#include <array>

#include "runtime/collision/feature_minima.hpp"
#include "runtime/collision/rigid_distance.hpp"

namespace souple {

/// A box at its place, by features: corner k has the sign of bit i of k on axis i; edge 4 axis + j runs
/// along that axis; face 2 axis + (0 low, 1 high).
class PlacedBox {
 public:
  PlacedBox(const RigidShape& shape, const RigidPlacement& at)
      : half_(as_vec3(shape.half_extents_m)), at_(at) {}

  Vec3 axis(int k) const { return at_.rotation.col(k); }
  double half(int k) const { return half_[k]; }
  Vec3 to_local(const Vec3& point) const {
    return at_.rotation.transpose() * (point - at_.translation);
  }
  const Vec3& centre() const { return at_.translation; }
  Vec3 corner(int k) const { return at_.rotation * local_corner(k) + at_.translation; }
  /// Out of the corner along the diagonal of a cube.
  Vec3 corner_normal(int k) const {
    return at_.rotation * Vec3(sign(k, 0), sign(k, 1), sign(k, 2)).normalized();
  }
  /// Whether the corner is (nearly) foremost along `direction`.
  bool in_corner_cone(int k, const Vec3& direction) const {
    for (int i = 0; i < 3; ++i)
      if (-sign(k, i) * axis(i).dot(direction) > vertex_cone_slack) return false;
    return true;
  }
  Ridge edge(int k) const;

 private:
  static double sign(int corner, int axis) { return (corner >> axis & 1) != 0 ? 1 : -1; }
  Vec3 local_corner(int k) const {
    return {sign(k, 0) * half_[0], sign(k, 1) * half_[1], sign(k, 2) * half_[2]};
  }

  Vec3 half_;
  const RigidPlacement& at_;
};

/// The axis on which the shadows of two boxes are farthest apart (Gottschalk 1996). Its gap is no more
/// than their distance, and positive whenever they are apart; else it is the least way out, negative.
struct SeparatingAxis {
  Vec3 axis = Vec3::UnitZ();  ///< unit, from B to A
  double gap = 0;
};
SeparatingAxis widest_gap(const PlacedBox& a, const PlacedBox& b);

}  // namespace souple
