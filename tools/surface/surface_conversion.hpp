// SPDX-License-Identifier: GPL-3.0-or-later
// Between plain triangles and a CGAL::Surface_mesh of any kernel; templates, so that no CGAL header is
// needed here.
#pragma once
#include <cstddef>
#include <vector>

#include "formats/core/mesh.hpp"

namespace souple {

/// Faces and vertices keep their order; a triangle that would not be manifold is left out.
template <class Surface>
Surface to_surface(const TriangleMesh& mesh) {
  Surface surface;
  std::vector<typename Surface::Vertex_index> v;
  v.reserve(mesh.vertices.size());
  for (const Point& p : mesh.vertices)
    v.push_back(surface.add_vertex(typename Surface::Point(p[0], p[1], p[2])));
  const auto at = [&](Index i) { return v[static_cast<std::size_t>(i)]; };
  for (const Triangle& t : mesh.triangles) surface.add_face(at(t[0]), at(t[1]), at(t[2]));
  return surface;
}

/// Collects the garbage first; `to_double` rounds a coordinate. Vertices without a triangle are kept.
template <class Surface, class ToDouble>
TriangleMesh to_plain(Surface& surface, const ToDouble& to_double) {
  surface.collect_garbage();
  TriangleMesh mesh;
  mesh.vertices.reserve(surface.number_of_vertices());
  for (const auto v : surface.vertices()) {
    const auto& p = surface.point(v);
    mesh.vertices.push_back({to_double(p.x()), to_double(p.y()), to_double(p.z())});
  }
  mesh.triangles.reserve(surface.number_of_faces());
  for (const auto f : surface.faces()) {
    Triangle& triangle = mesh.triangles.emplace_back();
    std::size_t k = 0;
    for (const auto v : surface.vertices_around_face(surface.halfedge(f)))
      triangle[k++] = static_cast<Index>(v.idx());
  }
  return mesh;
}

template <class Surface>
TriangleMesh to_plain(Surface& surface) {
  return to_plain(surface, [](double x) { return x; });
}

}  // namespace souple
