// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/geometry/unit_frame.hpp"

#include <cmath>

#include "tools/geometry/surface_measure.hpp"
#include "tools/geometry/vector.hpp"

namespace souple {
namespace {

constexpr double grid = 0x1p26;

/// -0 becomes 0.
double rounded(double x) { return std::nearbyint(x * grid) / grid + 0.0; }

}  // namespace

UnitFrame::UnitFrame(const std::vector<Point>& points) {
  const Box box = bounding_box(points);
  origin_ = scaled(add(box.low, box.high), 0.5);
  length_m_ = longest_side(box);
}

Point UnitFrame::to_unit(const Point& p) const {
  const Point q = subtract(p, origin_);
  return on_unit_grid({q[0] / length_m_, q[1] / length_m_, q[2] / length_m_});
}

Point on_unit_grid(const Point& p) { return {rounded(p[0]), rounded(p[1]), rounded(p[2])}; }

Point UnitFrame::to_metres(const Point& q) const { return add_scaled(origin_, length_m_, q); }

std::vector<Point> UnitFrame::to_unit(const std::vector<Point>& points) const {
  std::vector<Point> unit;
  unit.reserve(points.size());
  for (const Point& p : points) unit.push_back(to_unit(p));
  return unit;
}

std::vector<Point> UnitFrame::to_metres(const std::vector<Point>& points) const {
  std::vector<Point> metres;
  metres.reserve(points.size());
  for (const Point& p : points) metres.push_back(to_metres(p));
  return metres;
}

}  // namespace souple
