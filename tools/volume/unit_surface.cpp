// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/volume/unit_surface.hpp"

#include <cmath>

#include "tools/geometry/surface_measure.hpp"
#include "tools/geometry/vector.hpp"

namespace souple {
namespace {

constexpr double grid = 0x1p26;

bool has_area(const TriangleMesh& mesh, const Triangle& t) {
  const Point &a = mesh.vertices[static_cast<std::size_t>(t[0])],
              &b = mesh.vertices[static_cast<std::size_t>(t[1])],
              &c = mesh.vertices[static_cast<std::size_t>(t[2])];
  // Exact on the grid: products of 27-bit integers.
  return cross(subtract(b, a), subtract(c, a)) != Point{};
}

}  // namespace

Result<UnitSurface> to_unit_surface(const TriangleMesh& surface) {
  if (const Status valid = check_closed_oriented_manifold(surface); !valid) return valid.issue();
  const Box box = bounding_box(surface.vertices);
  UnitSurface unit;
  unit.origin = scaled(add(box.low, box.high), 0.5);
  unit.length_m = longest_side(box);
  for (const Point& p : surface.vertices) {
    const Point q = scaled(subtract(p, unit.origin), grid / unit.length_m);
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
