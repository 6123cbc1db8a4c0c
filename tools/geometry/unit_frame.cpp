// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/geometry/unit_frame.hpp"

#include <cmath>

#include "tools/geometry/principal_axes.hpp"
#include "tools/geometry/surface_measure.hpp"
#include "tools/geometry/vector.hpp"

namespace souple {
namespace {

constexpr double grid = 0x1p26;

Point along(const std::array<Point, 3>& axes, const Point& d) {
  return {dot(d, axes[0]), dot(d, axes[1]), dot(d, axes[2])};
}

Point from(const std::array<Point, 3>& axes, const Point& u) {
  return add_scaled(add_scaled(scaled(axes[0], u[0]), u[1], axes[1]), u[2], axes[2]);
}

/// -0 becomes 0.
double rounded(double x) { return std::nearbyint(x * grid) / grid + 0.0; }

}  // namespace

UnitFrame::UnitFrame(const std::vector<Point>& points) {
  const Box box = bounding_box(points);
  origin_ = scaled(add(box.low, box.high), 0.5);
  length_m_ = longest_side(box);
}

UnitFrame UnitFrame::along_axes_of(const TriangleMesh& surface) {
  UnitFrame frame(surface.vertices);
  frame.axes_ = principal_axes(surface, frame.origin_, frame.length_m_);
  std::vector<Point> turned;
  turned.reserve(surface.vertices.size());
  for (const Point& p : surface.vertices)
    turned.push_back(along(frame.axes_, scaled(subtract(p, frame.origin_), 1 / frame.length_m_)));
  const Box box = bounding_box(turned);
  const Point middle = scaled(add(box.low, box.high), 0.5);
  frame.origin_ = add_scaled(frame.origin_, frame.length_m_, from(frame.axes_, middle));
  frame.length_m_ *= longest_side(box);
  return frame;
}

Point UnitFrame::to_unit(const Point& p) const {
  const Point q = along(axes_, subtract(p, origin_));
  return on_unit_grid({q[0] / length_m_, q[1] / length_m_, q[2] / length_m_});
}

Point on_unit_grid(const Point& p) { return {rounded(p[0]), rounded(p[1]), rounded(p[2])}; }

Point UnitFrame::to_metres(const Point& q) const {
  return add_scaled(origin_, length_m_, from(axes_, q));
}

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
