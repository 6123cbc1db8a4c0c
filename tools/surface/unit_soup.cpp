// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/surface/unit_soup.hpp"

#include <utility>

#include "tools/surface/clean_soup.hpp"

namespace souple {

UnitSoup::UnitSoup(const TriangleMesh& surface) : frame_(clean_soup(surface).mesh.vertices) {
  const TriangleMesh exact = clean_soup(surface).mesh;
  TriangleMesh unit{{}, exact.triangles};
  for (const Point& p : exact.vertices) {
    unit.vertices.push_back(frame_.to_unit(p));
    metres_of_.emplace(unit.vertices.back(), p);
  }
  mesh_ = clean_soup(unit).mesh;
  merged_vertex_count_ = surface.vertices.size() - mesh_.vertices.size();
  dropped_triangle_count_ = surface.triangles.size() - mesh_.triangles.size();
}

TriangleMesh UnitSoup::in_metres(const TriangleMesh& unit) const {
  TriangleMesh mesh{{}, unit.triangles};
  mesh.vertices.reserve(unit.vertices.size());
  for (const Point& q : unit.vertices) {
    const auto known = metres_of_.find(q);
    mesh.vertices.push_back(known != metres_of_.end() ? known->second : frame_.to_metres(q));
  }
  return mesh;
}

TriangleMesh UnitSoup::on_grid_in_metres(const TriangleMesh& unit) const {
  TriangleMesh mesh = unit;
  for (Point& p : mesh.vertices) p = frame_.to_metres(p);
  return mesh;
}

}  // namespace souple
