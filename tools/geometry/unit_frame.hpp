// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <vector>

#include "formats/core/mesh.hpp"

namespace souple {

/// Brings points to unit size, rounded to 2^-26 of the longest side (3 nm on a body of 0.2 m): the
/// rounding of other units or another origin vanishes in it, so that everything decided afterwards is
/// the same in mm and in m.
class UnitFrame {
 public:
  /// Of these points; their extent must be positive.
  explicit UnitFrame(const std::vector<Point>& points);

  double length_m() const { return length_m_; }  ///< of one unit: the longest side
  Point to_unit(const Point& p) const;
  Point to_metres(const Point& q) const;
  std::vector<Point> to_unit(const std::vector<Point>& points) const;
  std::vector<Point> to_metres(const std::vector<Point>& points) const;

 private:
  Point origin_{};  ///< m, middle of the box
  double length_m_ = 1;
};

/// Rounded to the grid of UnitFrame.
Point on_unit_grid(const Point& p);

}  // namespace souple
