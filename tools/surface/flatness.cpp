// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/surface/flatness.hpp"

#include <algorithm>

#include "tools/geometry/vector.hpp"

namespace souple {
namespace {

constexpr double relative_thickness = 1e-7;

/// The point where `measure` is greatest, the first of several.
template <class Measure>
const Point& farthest(const std::vector<Point>& points, const Measure& measure) {
  return *std::ranges::max_element(points, {}, measure);
}

}  // namespace

bool is_flat(const std::vector<Point>& points) {
  if (points.size() < 4) return true;
  const auto from = [](const Point& origin) {
    return [origin](const Point& p) { return squared_norm(subtract(p, origin)); };
  };
  const Point a = farthest(points, from(points.front()));
  const Point b = farthest(points, from(a));
  const Point ab = subtract(b, a);
  const double extent = norm(ab);
  if (!(extent > 0)) return true;
  const Point direction = scaled(ab, 1 / extent);
  const auto off_line = [&](const Point& p) { return norm(cross(direction, subtract(p, a))); };
  const Point c = farthest(points, off_line);
  if (!(off_line(c) > relative_thickness * extent)) return true;
  const Point across = cross(direction, subtract(c, a));
  const Point normal = scaled(across, 1 / norm(across));
  const auto off_plane = [&](const Point& p) { return std::abs(dot(normal, subtract(p, a))); };
  return !(off_plane(farthest(points, off_plane)) > relative_thickness * extent);
}

}  // namespace souple
