// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/volume/unit_surface.hpp"

#include <array>
#include <cmath>

#include "tools/geometry/surface_measure.hpp"
#include "tools/geometry/vector.hpp"

namespace souple {
namespace {

constexpr double grid = 0x1p20;
using Corners = std::array<Point, 3>;

Corners corners_of(const TriangleMesh& mesh, const Triangle& t) {
  return {mesh.vertices[static_cast<std::size_t>(t[0])], mesh.vertices[static_cast<std::size_t>(t[1])],
          mesh.vertices[static_cast<std::size_t>(t[2])]};
}

bool has_area(const TriangleMesh& mesh, const Triangle& t) {
  const Corners c = corners_of(mesh, t);
  // Exact on the grid: products of 21-bit integers.
  return cross(subtract(c[1], c[0]), subtract(c[2], c[0])) != Point{};
}

}  // namespace

Result<UnitSurface> to_unit_surface(const TriangleMesh& surface) {
  if (const Status valid = check_closed_oriented_manifold(surface); !valid) return valid.issue();
  const double extent = longest_side(bounding_box(surface.vertices));
  if (!(extent > 0) || !std::isfinite(extent))
    return make_issue(IssueCode::surface_no_volume, "all vertices lie in one point");
  UnitSurface unit{{}, UnitFrame::along_axes_of(surface)};
  for (const Point& p : surface.vertices) {
    const Point q = scaled(unit.frame.to_unit(p), grid);
    unit.mesh.vertices.push_back(
        {std::nearbyint(q[0]) / grid, std::nearbyint(q[1]) / grid, std::nearbyint(q[2]) / grid});
  }
  for (const Triangle& t : surface.triangles)
    if (has_area(unit.mesh, t)) unit.mesh.triangles.push_back(t);
  const double volume = signed_volume(unit.mesh);
  if (!(volume > 1e-9))
    return make_issue(IssueCode::surface_no_volume,
                      "the volume is " + std::to_string(volume * 1e9) + "e-9 of the cube of its size");
  return unit;
}

}  // namespace souple
