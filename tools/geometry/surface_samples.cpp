// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/geometry/surface_samples.hpp"

#include <array>
#include <cmath>
#include <limits>

#include "tools/geometry/vector.hpp"

namespace souple {
namespace {

constexpr double most_in_a_row = 200;

int count_along(double length, double spacing) {
  return static_cast<int>(std::clamp(std::ceil(length / spacing), 1.0, most_in_a_row));
}

/// The triangle with its longest side from the first corner to the second.
std::array<Point, 3> on_longest_side(const TriangleMesh& mesh, const Triangle& t) {
  std::array<Point, 3> x;
  for (std::size_t k = 0; k < 3; ++k) x[k] = mesh.vertices[static_cast<std::size_t>(t[k])];
  const auto side = [&](std::size_t k) { return squared_norm(subtract(x[(k + 1) % 3], x[k])); };
  std::size_t longest = 0;
  for (const std::size_t k : {1, 2})
    if (side(k) > side(longest)) longest = k;
  std::ranges::rotate(x, x.begin() + static_cast<std::ptrdiff_t>(longest));
  return x;
}

std::vector<Point> with_vertices(const TriangleMesh& mesh, double spacing) {
  std::vector<Point> points = sample_evenly(mesh, spacing).points;
  for (const Index i : used_nodes(mesh.triangles))
    points.push_back(mesh.vertices[static_cast<std::size_t>(i)]);
  return points;
}

}  // namespace

SurfaceSamples sample_evenly(const TriangleMesh& mesh, double spacing) {
  SurfaceSamples samples;
  for (const Triangle& t : mesh.triangles) {
    const auto [a, b, c] = on_longest_side(mesh, t);
    const Point base = subtract(b, a);
    const double length = norm(base);
    const double area = norm(cross(base, subtract(c, a))) / 2;
    const int rows = count_along(length > 0 ? 2 * area / length : 0, spacing);
    for (int row = 0; row < rows; ++row) {
      const double up = (row + 0.5) / rows;  // 0 at the longest side, 1 at the corner across
      const Point left = add_scaled(a, up, subtract(c, a));
      const int columns = count_along(length * (1 - up), spacing);
      for (int column = 0; column < columns; ++column) {
        samples.points.push_back(add_scaled(left, (1 - up) * (column + 0.5) / columns, base));
        samples.areas.push_back(2 * area * (1 - up) / rows / columns);
      }
    }
  }
  return samples;
}

TwoSidedDistance two_sided_distance(const TriangleMesh& a, const TriangleBvh& a_triangles,
                                    const TriangleMesh& b, const TriangleBvh& b_triangles,
                                    double samples_per_side) {
  const double size =
      std::max(longest_side(bounding_box(a.vertices)), longest_side(bounding_box(b.vertices)));
  const double spacing = std::max(size / samples_per_side, std::numeric_limits<double>::min());
  return {distance_from_surface(with_vertices(a, spacing), b_triangles),
          distance_from_surface(with_vertices(b, spacing), a_triangles)};
}

TwoSidedDistance two_sided_distance(const TriangleMesh& a, const TriangleMesh& b,
                                    double samples_per_side) {
  return two_sided_distance(a, TriangleBvh(a), b, TriangleBvh(b), samples_per_side);
}

}  // namespace souple
