// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <vector>

#include "formats/core/mesh.hpp"

namespace souple {

/// Brings points to unit size, rounded to 2^-26 of the longest side (3 nm on a body of 0.2 m): the
/// rounding of other units, another origin or (along principal axes) another attitude vanishes in it,
/// so that everything decided afterwards is the same. x = origin + length_m * (u_0 axes[0] +
/// u_1 axes[1] + u_2 axes[2]).
class UnitFrame {
 public:
  /// Of these points, along x, y, z; their extent must be positive.
  explicit UnitFrame(const std::vector<Point>& points);
  /// Along the principal axes of the surface; its extent must be positive.
  static UnitFrame along_axes_of(const TriangleMesh& surface);

  double length_m() const { return length_m_; }  ///< of one unit: the longest side
  Point to_unit(const Point& p) const;
  Point to_metres(const Point& q) const;
  std::vector<Point> to_unit(const std::vector<Point>& points) const;
  std::vector<Point> to_metres(const std::vector<Point>& points) const;

 private:
  std::array<Point, 3> axes_{Point{1, 0, 0}, Point{0, 1, 0}, Point{0, 0, 1}};  ///< right-handed
  Point origin_{};       ///< m, middle of the box along the axes
  double length_m_ = 1;  ///< longest side of that box
};

/// Rounded to the grid of UnitFrame.
Point on_unit_grid(const Point& p);

}  // namespace souple
