// SPDX-License-Identifier: MIT
#include "tests/support/level_boxes.hpp"

#include <algorithm>

#include "runtime/fem/linear_algebra.hpp"

namespace souple::test {
namespace {

std::array<double, 4> weights_of(const Point& x, const Tet& tet, const std::vector<Point>& nodes) {
  const Vec3 first = as_vec3(nodes[std::size_t(tet[0])]);
  Mat3 edges;
  for (int k = 0; k < 3; ++k)
    edges.col(k) = as_vec3(nodes[std::size_t(tet[std::size_t(k) + 1])]) - first;
  const Vec3 w = edges.partialPivLu().solve(as_vec3(x) - first);
  return {1 - w.sum(), w.x(), w.y(), w.z()};
}

}  // namespace

MeshLevel nested_box(const std::array<int, 3>& coarse_cells, const Point& origin, const Point& size) {
  const auto [nx, ny, nz] = coarse_cells;
  MeshLevel level = level_of(box_mesh({2 * nx, 2 * ny, 2 * nz}, origin, size));
  const auto coarse = [&](int i, int j, int k) { return Index((k * (ny + 1) + j) * (nx + 1) + i); };
  // Every edge of the coarse mesh joins two corners of a cell of which one has no larger coordinate.
  for (int k = 0; k <= 2 * nz; ++k)
    for (int j = 0; j <= 2 * ny; ++j)
      for (int i = 0; i <= 2 * nx; ++i)
        level.parents.push_back(
            {coarse(i / 2, j / 2, k / 2), coarse((i + 1) / 2, (j + 1) / 2, (k + 1) / 2)});
  return level;
}

MeshLevel embedded_level(TetMesh mesh, const TetMesh& coarse) {
  MeshLevel level = level_of(std::move(mesh));
  for (const Point& x : level.mesh.nodes) {
    Embedding best;
    double most = -1e300;
    for (std::size_t t = 0; t < coarse.tets.size(); ++t) {
      const auto weights = weights_of(x, coarse.tets[t], coarse.nodes);
      const double least = *std::ranges::min_element(weights);
      if (least <= most) continue;
      most = least;
      best = {Index(t), weights};
    }
    level.embedding.push_back(best);
  }
  return level;
}

}  // namespace souple::test
