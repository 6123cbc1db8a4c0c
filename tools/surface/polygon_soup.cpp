// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/surface/polygon_soup.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "tools/geometry/vector.hpp"

namespace souple {
namespace {

constexpr double largest_coordinate = 1e15;

}  // namespace

Status check_polygon_soup(const PolygonSoup& soup) {
  if (soup.points.size() > static_cast<std::size_t>(std::numeric_limits<Index>::max()))
    return make_issue(IssueCode::surface_too_large, std::to_string(soup.points.size()) + " vertices");
  for (std::size_t i = 0; i < soup.points.size(); ++i) {
    const Point& p = soup.points[i];
    if (!is_finite(p))
      return make_issue(IssueCode::surface_not_finite,
                        "vertex " + std::to_string(i) + " has a coordinate that is NaN or infinite");
    if (std::ranges::any_of(p, [](double x) { return std::abs(x) > largest_coordinate; }))
      return make_issue(IssueCode::surface_too_far,
                        "vertex " + std::to_string(i) + " lies more than 1e15 units from the origin");
  }
  for (std::size_t i = 0; i < soup.polygons.size(); ++i)
    for (const std::size_t v : soup.polygons[i])
      if (v >= soup.points.size())
        return make_issue(IssueCode::surface_bad_index,
                          "polygon " + std::to_string(i) + " names a vertex outside the " +
                              std::to_string(soup.points.size()) + " of the file");
  if (std::ranges::none_of(soup.polygons, [](const Polygon& p) { return p.size() >= 3; }))
    return make_issue(IssueCode::surface_no_triangles, "the file has no polygon");
  return {};
}

}  // namespace souple
