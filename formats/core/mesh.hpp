// SPDX-License-Identifier: MIT
// Plain meshes that every part of the program exchanges. SI units, column vectors, 0-based indices.
#pragma once
#include <array>
#include <cstdint>
#include <vector>

namespace souple {

using Index = std::int32_t;
using Point = std::array<double, 3>;    ///< metres
using Triangle = std::array<Index, 3>;  ///< counter-clockwise seen from outside
using Tet = std::array<Index, 4>;       ///< det(x1-x0, x2-x0, x3-x0) > 0

struct TriangleMesh {
  std::vector<Point> vertices;
  std::vector<Triangle> triangles;
};

struct TetMesh {
  std::vector<Point> nodes;
  std::vector<Tet> tets;
};

/// Faces that belong to exactly one tet, wound outward, in the order of tets and of the faces of a tet.
std::vector<Triangle> boundary_triangles(const std::vector<Tet>& tets);

/// Sorted indices of the nodes that the triangles use.
std::vector<Index> used_nodes(const std::vector<Triangle>& triangles);

/// Six times the signed volume of a tet: positive for the orientation that Tet promises.
double signed_volume6(const Point& a, const Point& b, const Point& c, const Point& d);

}  // namespace souple
