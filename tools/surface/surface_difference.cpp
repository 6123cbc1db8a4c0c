// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/surface/surface_difference.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <set>

#include "tools/geometry/surface_samples.hpp"

namespace souple {
namespace {

constexpr double samples_per_side = 100;

using Corners = std::array<Point, 3>;

/// In ascending order: the same for a triangle however it is wound or numbered.
Corners sorted_corners(const TriangleMesh& mesh, const Triangle& t) {
  Corners x;
  for (std::size_t k = 0; k < 3; ++k) x[k] = mesh.vertices[static_cast<std::size_t>(t[k])];
  std::ranges::sort(x);
  return x;
}

std::set<Corners> corners_of(const TriangleMesh& mesh) {
  std::set<Corners> all;
  for (const Triangle& t : mesh.triangles) all.insert(sorted_corners(mesh, t));
  return all;
}

/// Of the triangles of `mesh` that are not among `known`.
std::vector<Point> samples_of_others(const TriangleMesh& mesh, const std::set<Corners>& known) {
  TriangleMesh others{mesh.vertices, {}};
  for (const Triangle& t : mesh.triangles)
    if (!known.contains(sorted_corners(mesh, t))) others.triangles.push_back(t);
  const double size = longest_side(bounding_box(mesh.vertices));
  return sample_evenly(others, std::max(size / samples_per_side, std::numeric_limits<double>::min()))
      .points;
}

}  // namespace

double distance_where_different(const TriangleMesh& a, const TriangleMesh& b) {
  const double forth =
      distance_from_surface(samples_of_others(a, corners_of(b)), TriangleBvh(b)).largest;
  return std::max(forth,
                  distance_from_surface(samples_of_others(b, corners_of(a)), TriangleBvh(a)).largest);
}

double share_of_area_near(const TriangleMesh& surface, const TriangleBvh& base, double distance,
                          double spacing) {
  const SurfaceSamples samples = sample_evenly(surface, spacing);
  double near = 0, all = 0;
  for (std::size_t i = 0; i < samples.points.size(); ++i) {
    all += samples.areas[i];
    if (base.closest(samples.points[i]).squared_distance <= distance * distance)
      near += samples.areas[i];
  }
  return all > 0 ? near / all : 0;
}

}  // namespace souple
