// SPDX-License-Identifier: GPL-3.0-or-later
// Bodies for the tests of hierarchies.
#pragma once
#include <gtest/gtest.h>

#include <algorithm>
#include <utility>

#include "formats/core/mesh.hpp"
#include "tools/volume/tetrahedralize.hpp"

namespace souple {

inline TetMesh coarse_mesh(const TriangleMesh& surface, std::size_t tets) {
  TetrahedralizeOptions options;
  options.target_tet_count = tets;
  auto volume = tetrahedralize(surface, options);
  EXPECT_TRUE(volume.ok()) << format_issue(volume.issue());
  return volume ? std::move(volume->mesh) : TetMesh{};
}

inline TetMesh unit_tet() { return {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {{0, 1, 2, 3}}}; }

/// A cube of side 1 m in cells^3 cells, each of 6 tets around its diagonal (Kuhn).
inline TetMesh kuhn_cube(int cells) {
  TetMesh mesh;
  const int n = cells + 1;
  for (int z = 0; z < n; ++z)
    for (int y = 0; y < n; ++y)
      for (int x = 0; x < n; ++x)
        mesh.nodes.push_back({double(x) / cells, double(y) / cells, double(z) / cells});
  const auto node = [&](int x, int y, int z) { return static_cast<Index>((z * n + y) * n + x); };
  for (int z = 0; z < cells; ++z)
    for (int y = 0; y < cells; ++y)
      for (int x = 0; x < cells; ++x) {
        std::array<int, 3> axes{0, 1, 2};
        do {
          std::array<int, 3> at{x, y, z};
          Tet tet{node(x, y, z), 0, 0, 0};
          for (std::size_t k = 0; k < 3; ++k) {
            ++at[static_cast<std::size_t>(axes[k])];
            tet[k + 1] = node(at[0], at[1], at[2]);
          }
          const auto p = [&](std::size_t k) { return mesh.nodes[static_cast<std::size_t>(tet[k])]; };
          if (signed_volume6(p(0), p(1), p(2), p(3)) < 0) std::swap(tet[2], tet[3]);
          mesh.tets.push_back(tet);
        } while (std::next_permutation(axes.begin(), axes.end()));
      }
  return mesh;
}

inline TriangleMesh boundary_of(const TetMesh& mesh) {
  return {mesh.nodes, boundary_triangles(mesh.tets)};
}

}  // namespace souple
