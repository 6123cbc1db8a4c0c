// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/volume/surface_seeds.hpp"

#include <algorithm>
#include <limits>

#include "tools/geometry/surface_measure.hpp"
#include "tools/geometry/vector.hpp"

namespace souple {
namespace {

void spread_over_shell(const std::vector<Point>& middles, double spacing, std::size_t fewest,
                       std::size_t most, std::vector<Point>& seeds) {
  std::vector<double> squared(middles.size(), std::numeric_limits<double>::infinity());
  std::size_t next = 0;
  for (std::size_t count = 0; count < std::min(most, middles.size()); ++count) {
    seeds.push_back(middles[next]);
    for (std::size_t i = 0; i < middles.size(); ++i)
      squared[i] = std::min(squared[i], squared_norm(subtract(middles[i], seeds.back())));
    next = static_cast<std::size_t>(std::ranges::max_element(squared) - squared.begin());
    if (squared[next] <= 0 || (count + 1 >= fewest && squared[next] < spacing * spacing)) break;
  }
}

}  // namespace

std::vector<Point> spread_surface_seeds(const TriangleMesh& surface, double spacing, std::size_t fewest,
                                        std::size_t most) {
  const std::vector<Index> shells = shell_of_triangles(surface.triangles, surface.vertices.size());
  const std::size_t shell_count =
      shells.empty() ? 0 : static_cast<std::size_t>(std::ranges::max(shells)) + 1;
  std::vector<std::vector<Point>> middles(shell_count);
  for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
    Point sum{};
    for (const Index i : surface.triangles[t])
      sum = add(sum, surface.vertices[static_cast<std::size_t>(i)]);
    middles[static_cast<std::size_t>(shells[t])].push_back(scaled(sum, 1.0 / 3.0));
  }
  std::vector<Point> seeds;
  for (const auto& shell : middles) spread_over_shell(shell, spacing, fewest, most, seeds);
  return seeds;
}

}  // namespace souple
