// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/exchange/shape_mesh.hpp"

#include <array>
#include <cmath>
#include <numbers>

namespace souple {
namespace {

constexpr Index longitude_count = 48;
constexpr Index latitude_count = 24;
constexpr Index plane_cells = 20;  ///< squares along a side of the plane

Point on_sphere(double radius, Index latitude, Index longitude) {
  const double theta = std::numbers::pi * latitude / latitude_count;
  const double phi = 2 * std::numbers::pi * longitude / longitude_count;
  return {radius * std::sin(theta) * std::cos(phi), radius * std::sin(theta) * std::sin(phi),
          radius * std::cos(theta)};
}

TriangleMesh sphere(double radius) {
  TriangleMesh mesh;
  mesh.vertices.push_back({0, 0, radius});
  for (Index i = 1; i < latitude_count; ++i)
    for (Index j = 0; j < longitude_count; ++j) mesh.vertices.push_back(on_sphere(radius, i, j));
  mesh.vertices.push_back({0, 0, -radius});
  const Index last = static_cast<Index>(mesh.vertices.size()) - 1;
  const auto at = [](Index i, Index j) { return 1 + (i - 1) * longitude_count + j % longitude_count; };
  for (Index j = 0; j < longitude_count; ++j) {
    mesh.triangles.push_back({0, at(1, j), at(1, j + 1)});
    for (Index i = 1; i + 1 < latitude_count; ++i) {
      mesh.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      mesh.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
    mesh.triangles.push_back({at(latitude_count - 1, j), last, at(latitude_count - 1, j + 1)});
  }
  return mesh;
}

// A sphere drawn apart at its equator.
TriangleMesh capsule(double radius, double half_length) {
  TriangleMesh mesh = sphere(radius);
  for (Point& vertex : mesh.vertices)
    vertex[2] += vertex[2] > -1e-9 * radius ? half_length : -half_length;
  return mesh;
}

TriangleMesh box(const Point& half) {
  TriangleMesh mesh;
  for (int i = 0; i < 8; ++i)
    mesh.vertices.push_back({(i & 1) != 0 ? half[0] : -half[0], (i & 2) != 0 ? half[1] : -half[1],
                             (i & 4) != 0 ? half[2] : -half[2]});
  mesh.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                    {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  return mesh;
}

TriangleMesh plane(double size) {
  TriangleMesh mesh;
  for (Index j = 0; j <= plane_cells; ++j)
    for (Index i = 0; i <= plane_cells; ++i)
      mesh.vertices.push_back({size * (static_cast<double>(i) / plane_cells - 0.5),
                               size * (static_cast<double>(j) / plane_cells - 0.5), 0});
  for (Index j = 0; j < plane_cells; ++j)
    for (Index i = 0; i < plane_cells; ++i) {
      const Index a = j * (plane_cells + 1) + i, b = a + 1;
      const Index c = a + plane_cells + 1, d = c + 1;
      mesh.triangles.push_back({a, b, d});
      mesh.triangles.push_back({a, d, c});
    }
  return mesh;
}

}  // namespace

Point place(const Pose& pose, const Point& p) {
  const auto& [w, x, y, z] = pose.rotation;
  // v + 2 w (q x v) + 2 q x (q x v) for the unit quaternion (w, q)
  const Point t{2 * (y * p[2] - z * p[1]), 2 * (z * p[0] - x * p[2]), 2 * (x * p[1] - y * p[0])};
  return {p[0] + w * t[0] + y * t[2] - z * t[1] + pose.translation[0],
          p[1] + w * t[1] + z * t[0] - x * t[2] + pose.translation[1],
          p[2] + w * t[2] + x * t[1] - y * t[0] + pose.translation[2]};
}

TriangleMesh triangulate_shape(const RigidShape& shape, const Pose& pose, double plane_size_m) {
  TriangleMesh mesh;
  switch (shape.kind) {
    case RigidShapeKind::plane:
      mesh = plane(plane_size_m);
      break;
    case RigidShapeKind::sphere:
      mesh = sphere(shape.radius_m);
      break;
    case RigidShapeKind::box:
      mesh = box(shape.half_extents_m);
      break;
    case RigidShapeKind::capsule:
      mesh = capsule(shape.radius_m, shape.half_length_m);
      break;
    case RigidShapeKind::mesh:
      break;
  }
  for (Point& vertex : mesh.vertices) vertex = place(pose, vertex);
  return mesh;
}

}  // namespace souple
