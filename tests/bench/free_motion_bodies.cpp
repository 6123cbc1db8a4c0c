// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/bench/free_motion_bodies.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "runtime/multigrid/level_transitions.hpp"
#include "tests/bench/bench_data.hpp"
#include "tests/support/box_mesh.hpp"
#include "tools/hierarchy/nested_hierarchy.hpp"
#include "tools/surface/import_surface.hpp"
#include "tools/surface/prepare.hpp"
#include "tools/volume/tetrahedralize.hpp"

namespace souple::bench {
namespace {

FixedSet held_nodes(const TetMesh& mesh) {
  const auto [least, most] =
      std::ranges::minmax_element(mesh.nodes, {}, [](const Point& p) { return p[0]; });
  const double limit = (*least)[0] + 0.1 * ((*most)[0] - (*least)[0]);
  FixedSet held{held_set, {}};
  for (std::size_t node = 0; node < mesh.nodes.size(); ++node)
    if (mesh.nodes[node][0] <= limit) held.nodes.push_back(Index(node));
  return held;
}

HeldBody held_body(const std::string& name, const TriangleMesh& surface, std::size_t tets,
                   int level_count) {
  TetrahedralizeOptions volume;
  volume.target_tet_count = std::max<std::size_t>(tets >> (3 * (level_count - 1)), 50);
  const TetMesh coarsest = value_or_exit(tetrahedralize(surface, volume)).mesh;
  NestedHierarchyOptions nested;
  nested.level_count = level_count;
  HeldBody body{name, value_or_exit(build_nested_hierarchy(coarsest, surface, nested)).levels, {}};
  SoftBodyContent content;
  content.level = body.levels.back();
  content.material = test::material_of(1e4, 0.4, 1000, 0.1, 0.01);
  content.fixed_sets.push_back(held_nodes(content.level.mesh));
  content.multigrid = value_or_exit(store_transitions(body.levels));
  content.coarsest_nodes = body.levels.front().mesh.nodes;
  body.asset = value_or_exit(SoftBodyAsset::create(std::move(content)));
  return body;
}

TriangleMesh torus_surface() {
  constexpr int around = 48, across = 20;
  constexpr double ring = 0.07, tube = 0.03;
  TriangleMesh mesh;
  for (int i = 0; i < around; ++i)
    for (int j = 0; j < across; ++j) {
      const double u = 2 * std::numbers::pi * i / around, v = 2 * std::numbers::pi * j / across;
      const double radius = ring + tube * std::cos(v);
      mesh.vertices.push_back({radius * std::cos(u), radius * std::sin(u), tube * std::sin(v)});
    }
  const auto vertex = [](int i, int j) { return Index((i % around) * across + j % across); };
  for (int i = 0; i < around; ++i)
    for (int j = 0; j < across; ++j) {
      mesh.triangles.push_back({vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1)});
      mesh.triangles.push_back({vertex(i, j), vertex(i + 1, j + 1), vertex(i, j + 1)});
    }
  return mesh;
}

}  // namespace

HeldBody held_surface(const std::filesystem::path& surface, std::size_t tets, int level_count) {
  ImportOptions import;
  import.size_m = 0.2;
  const auto imported = value_or_exit(import_surface(data_folder() / "surfaces" / surface, import));
  return held_body(surface.stem().string(), value_or_exit(orient_closed_surface(imported.mesh)).mesh,
                   tets, level_count);
}

HeldBody held_torus(int level_count) {
  return held_body("torus", torus_surface(), std::size_t{1500} << (3 * (level_count - 1)), level_count);
}

}  // namespace souple::bench
