// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/hierarchy/two_sided_samples.hpp"

#include <algorithm>
#include <cmath>

#include "tools/geometry/triangle_bvh.hpp"
#include "tools/geometry/vector.hpp"

namespace souple {
namespace {

std::size_t at(Index i) { return static_cast<std::size_t>(i); }

/// Middles of the sides, which belong to the triangle that runs through them upwards, and the
/// barycentre.
struct ForthPoint {
  int from = -1, to = -1;  ///< corners of the side; -1: the barycentre
  std::array<double, 3> weights{};
};
constexpr std::array<ForthPoint, 4> forth_points{{{0, 1, {0.5, 0.5, 0}},
                                                  {1, 2, {0, 0.5, 0.5}},
                                                  {2, 0, {0.5, 0, 0.5}},
                                                  {-1, -1, {1.0 / 3, 1.0 / 3, 1.0 / 3}}}};

/// A target triangle far larger than the level's has at most so many samples a side.
constexpr double most_parts = 30;

Point combined(const Triangle& t, const std::vector<Point>& x, const std::array<double, 3>& w) {
  return add_scaled(add_scaled(scaled(x[at(t[0])], w[0]), w[1], x[at(t[1])]), w[2], x[at(t[2])]);
}

/// Barycentric weights of a point of triangle t; those of its first corner if it has no area.
std::array<double, 3> weights_in(const Triangle& t, const std::vector<Point>& x, const Point& p) {
  const Point normal = area_vector(t, x);
  const double area2 = squared_norm(normal);
  if (!(area2 > 0)) return {1, 0, 0};
  const Point &a = x[at(t[0])], &b = x[at(t[1])], &c = x[at(t[2])];
  const auto part = [&](const Point& from, const Point& to) {
    const double share = dot(normal, cross(subtract(to, from), subtract(p, from))) / area2;
    return std::clamp(share, 0.0, 1.0);
  };
  const double wb = part(c, a), wc = std::min(part(a, b), 1 - wb);
  return {1 - wb - wc, wb, wc};
}

void normalise_areas(std::vector<SurfaceSample>& samples) {
  double total = 0;
  for (const SurfaceSample& s : samples) total += s.area;
  if (total > 0)
    for (SurfaceSample& s : samples) s.area /= total;
}

double longest_side(const Triangle& t, const std::vector<Point>& x) {
  double longest2 = 0;
  for (std::size_t k = 0; k < 3; ++k)
    longest2 = std::max(longest2, squared_norm(subtract(x[at(t[k])], x[at(t[(k + 1) % 3])])));
  return std::sqrt(longest2);
}

double mean_side(const LevelSurface& surface, const std::vector<Point>& x) {
  double sum = 0;
  for (const Triangle& t : surface.triangles)
    for (std::size_t k = 0; k < 3; ++k) sum += norm(subtract(x[at(t[k])], x[at(t[(k + 1) % 3])]));
  return sum / static_cast<double>(3 * surface.triangles.size());
}

/// Points of a target triangle other than its corners: none of a small one, of a large one a regular
/// grid with its sides, which may be sharp.
std::vector<std::array<double, 3>> inner_weights(const Triangle& t, const std::vector<Point>& x,
                                                 double spacing) {
  const double wanted = longest_side(t, x) / spacing;
  if (!(wanted > 1)) return {};
  const int parts = static_cast<int>(std::ceil(std::min(wanted, most_parts)));
  std::vector<std::array<double, 3>> weights;
  for (int i = 0; i <= parts; ++i)
    for (int j = 0; i + j <= parts; ++j) {
      const int k = parts - i - j;
      if (std::max({i, j, k}) == parts) continue;
      weights.push_back({double(i) / parts, double(j) / parts, double(k) / parts});
    }
  return weights;
}

}  // namespace

std::vector<SurfaceSample> samples_forth(const LevelSurface& surface, const std::vector<Point>& x,
                                         const TargetSurface& target) {
  std::vector<SurfaceSample> samples;
  samples.reserve(3 * surface.triangles.size());
  const auto append = [&](Index t, const std::array<double, 3>& w, const Point& outward, double reach,
                          double area) {
    const ClosestPoint closest =
        target.closest_facing(combined(surface.triangles[at(t)], x, w), outward, reach);
    if (closest.triangle >= 0)
      samples.push_back({t, w, closest.point, target.normal(closest.triangle), area});
  };
  for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
    const Triangle& triangle = surface.triangles[t];
    const Point area = area_vector(triangle, x);
    const double reach = longest_side(triangle, x);
    for (const auto& [from, to, w] : forth_points) {
      if (from >= 0 && triangle[at(from)] > triangle[at(to)]) continue;
      append(static_cast<Index>(t), w, area, reach, norm(area));
    }
  }
  for (std::size_t v = 0; v < x.size(); ++v) {
    Point area{};
    for (const Index t : surface.triangles_of(v))
      area = add(area, area_vector(surface.triangles[at(t)], x));
    const Index t = surface.triangles_of(v).front();
    std::array<double, 3> corner{};
    for (std::size_t k = 0; k < 3; ++k)
      corner[k] = surface.triangles[at(t)][k] == static_cast<Index>(v) ? 1 : 0;
    append(t, corner, area, surface.reach(x, v), norm(area) / 6);
  }
  normalise_areas(samples);
  return samples;
}

std::vector<SurfaceSample> samples_back(const LevelSurface& surface, const std::vector<Point>& x,
                                        const TargetSurface& target) {
  const TriangleMesh& mesh = target.mesh();
  const TriangleBvh own(TriangleMesh{x, surface.triangles});
  const double spacing = 0.5 * mean_side(surface, x);
  std::vector<SurfaceSample> samples;
  const auto append = [&](const Point& p, const Point& area) {
    const ClosestPoint closest = own.closest(p);
    const double length = norm(area);
    if (closest.triangle < 0 || !(length > 0)) return;
    const Triangle& triangle = surface.triangles[at(closest.triangle)];
    samples.push_back({closest.triangle, weights_in(triangle, x, closest.point), p,
                       scaled(area, 1 / length), length});
  };
  std::vector<Point> vertex_areas(mesh.vertices.size());
  for (const Triangle& t : mesh.triangles) {
    const std::vector<std::array<double, 3>> inner = inner_weights(t, mesh.vertices, spacing);
    const Point area =
        scaled(area_vector(t, mesh.vertices), 1 / (3 + static_cast<double>(inner.size())));
    for (const Index v : t) vertex_areas[at(v)] = add(vertex_areas[at(v)], area);
    for (const auto& w : inner) append(combined(t, mesh.vertices, w), area);
  }
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) append(mesh.vertices[v], vertex_areas[v]);
  normalise_areas(samples);
  return samples;
}

}  // namespace souple
