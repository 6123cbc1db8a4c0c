// SPDX-License-Identifier: MIT
#include "tests/support/box_mesh.hpp"

#include <random>

namespace souple::test {

TetMesh box_mesh(const std::array<int, 3>& cells, const Point& origin, const Point& size) {
  TetMesh mesh;
  const auto [nx, ny, nz] = cells;
  const auto node = [&](int i, int j, int k) { return Index((k * (ny + 1) + j) * (nx + 1) + i); };
  for (int k = 0; k <= nz; ++k)
    for (int j = 0; j <= ny; ++j)
      for (int i = 0; i <= nx; ++i)
        mesh.nodes.push_back(
            {origin[0] + size[0] * i / nx, origin[1] + size[1] * j / ny, origin[2] + size[2] * k / nz});
  // Six paths from corner 000 to 111; even permutations of the axes are positively oriented.
  static constexpr int paths[6][3] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {2, 1, 0}, {1, 0, 2}};
  for (int k = 0; k < nz; ++k)
    for (int j = 0; j < ny; ++j)
      for (int i = 0; i < nx; ++i)
        for (int p = 0; p < 6; ++p) {
          std::array<int, 3> at{i, j, k};
          Tet tet{node(i, j, k), 0, 0, 0};
          for (int step = 0; step < 3; ++step) {
            ++at[std::size_t(paths[p][step])];
            tet[std::size_t(step) + 1] = node(at[0], at[1], at[2]);
          }
          if (p >= 3) std::swap(tet[2], tet[3]);
          mesh.tets.push_back(tet);
        }
  return mesh;
}

TetMesh irregular_box_mesh(const std::array<int, 3>& cells, const Point& origin, const Point& size,
                           double amount) {
  TetMesh mesh = box_mesh(cells, origin, size);
  std::mt19937 random(7);
  std::uniform_real_distribution<double> move(-amount, amount);
  for (Point& p : mesh.nodes)
    for (std::size_t axis = 0; axis < 3; ++axis) {
      bool inside = true;
      for (std::size_t k = 0; k < 3; ++k)
        inside &= p[k] > origin[k] + 1e-9 * size[k] && p[k] < origin[k] + size[k] * (1 - 1e-9);
      if (inside) p[axis] += move(random) * size[axis] / cells[axis] * 0.3;
    }
  return mesh;
}

MeshLevel level_of(TetMesh mesh) {
  MeshLevel level;
  level.boundary = boundary_triangles(mesh.tets);
  level.mesh = std::move(mesh);
  return level;
}

Material material_of(double young_pa, double poisson, double density, double alpha, double beta) {
  Material material;
  material.regions.push_back({"all", young_pa, poisson, density});
  material.rayleigh_mass_per_s = alpha;
  material.rayleigh_stiffness_s = beta;
  return material;
}

}  // namespace souple::test
