// SPDX-License-Identifier: MIT
#include "sample_embedding.hpp"

#include <algorithm>
#include <limits>

namespace souple::test {
namespace {

std::array<double, 4> barycentric(const Point& point, const Tet& tet, const TetMesh& mesh) {
  std::array<Point, 4> corner;
  for (std::size_t k = 0; k < 4; ++k) corner[k] = mesh.nodes[static_cast<std::size_t>(tet[k])];
  const double volume = signed_volume6(corner[0], corner[1], corner[2], corner[3]);
  std::array<double, 4> weights{};
  for (std::size_t k = 0; k < 4; ++k) {
    std::array<Point, 4> moved = corner;
    moved[k] = point;
    weights[k] = signed_volume6(moved[0], moved[1], moved[2], moved[3]) / volume;
  }
  return weights;
}

}  // namespace

std::vector<Embedding> embed_points(const std::vector<Point>& points, const TetMesh& mesh) {
  std::vector<Embedding> rows;
  for (const Point& point : points) {
    Embedding best;
    double best_inside = -std::numeric_limits<double>::infinity();
    for (std::size_t t = 0; t < mesh.tets.size(); ++t) {
      const std::array<double, 4> weights = barycentric(point, mesh.tets[t], mesh);
      const double inside = *std::ranges::min_element(weights);
      if (inside <= best_inside) continue;
      best_inside = inside;
      best = {static_cast<Index>(t), weights};
    }
    rows.push_back(best);
  }
  return rows;
}

}  // namespace souple::test
