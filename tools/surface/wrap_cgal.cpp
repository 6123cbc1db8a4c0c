// SPDX-License-Identifier: GPL-3.0-or-later
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/alpha_wrap_3.h>

#include <array>

#include "tools/surface/mend_steps.hpp"
#include "tools/surface/surface_conversion.hpp"

namespace souple {

MendStep wrap_triangles(const TriangleMesh& mesh, double alpha, double offset) {
  using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
  using Surface = CGAL::Surface_mesh<Kernel::Point_3>;
  std::vector<Kernel::Point_3> points;
  for (const Point& p : mesh.vertices) points.emplace_back(p[0], p[1], p[2]);
  std::vector<std::array<std::size_t, 3>> faces;
  for (const Triangle& t : mesh.triangles)
    faces.push_back({static_cast<std::size_t>(t[0]), static_cast<std::size_t>(t[1]),
                     static_cast<std::size_t>(t[2])});
  Surface wrap;
  CGAL::alpha_wrap_3(points, faces, alpha, offset, wrap);
  TriangleMesh plain = to_plain(wrap);
  const std::size_t count = plain.triangles.size();
  return {std::move(plain), count};
}

}  // namespace souple
