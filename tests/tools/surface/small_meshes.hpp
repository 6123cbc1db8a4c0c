// SPDX-License-Identifier: GPL-3.0-or-later
// Shapes whose every count is known.
#pragma once
#include <initializer_list>

#include "tools/geometry/vector.hpp"
#include "tools/surface/shells.hpp"

namespace souple {

/// A cube of side 2 r about `middle`, outward.
inline TriangleMesh cube(double r, const Point& middle = {}) {
  TriangleMesh mesh;
  for (int i = 0; i < 8; ++i)
    mesh.vertices.push_back(
        add(middle, {(i & 1) != 0 ? r : -r, (i & 2) != 0 ? r : -r, (i & 4) != 0 ? r : -r}));
  mesh.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                    {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  return mesh;
}

inline TriangleMesh turned(TriangleMesh mesh) {
  for (Triangle& t : mesh.triangles) std::swap(t[1], t[2]);
  return mesh;
}

/// The first `count` triangles left out: a hole.
inline TriangleMesh without_first(TriangleMesh mesh, std::ptrdiff_t count) {
  mesh.triangles.erase(mesh.triangles.begin(), mesh.triangles.begin() + count);
  return mesh;
}

/// Every triangle with vertices of its own, as in an STL file.
inline TriangleMesh as_soup(const TriangleMesh& mesh) {
  TriangleMesh soup;
  for (const Triangle& t : mesh.triangles) {
    Triangle& own = soup.triangles.emplace_back();
    for (std::size_t k = 0; k < 3; ++k) {
      own[k] = static_cast<Index>(soup.vertices.size());
      soup.vertices.push_back(mesh.vertices[static_cast<std::size_t>(t[k])]);
    }
  }
  return soup;
}

}  // namespace souple
