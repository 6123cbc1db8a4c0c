// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "tests/tools/real_surface.hpp"
#include "tools/geometry/surface_measure.hpp"
#include "tools/geometry/triangle_bvh.hpp"
#include "tools/volume/tetrahedralize.hpp"

namespace souple {

inline TetrahedralizeOptions of_count(std::size_t target) {
  TetrahedralizeOptions options;
  options.target_tet_count = target;
  return options;
}

inline TetrahedralizeOptions of_edge(double length_m) {
  TetrahedralizeOptions options;
  options.edge_length_m = length_m;
  return options;
}

/// Meshes the real surface and checks all that the header promises; `lost` is the part of the volume
/// and `off` the distance in parts of the longest side that coarseness may cost.
inline void expect_sound_volume(const std::string& name, std::size_t target, double lost, double off) {
  const TriangleMesh surface = closed_real_surface(name);
  const auto volume = tetrahedralize(surface, of_count(target));
  ASSERT_TRUE(volume.ok()) << format_issue(volume.issue());
  const TetMesh& mesh = volume->mesh;
  const auto count = static_cast<double>(mesh.tets.size());
  EXPECT_NEAR(count / static_cast<double>(target), 1, 0.15);
  EXPECT_EQ(volume->report.tet_count, mesh.tets.size());
  EXPECT_EQ(volume->report.node_count, mesh.nodes.size());

  std::vector<bool> used(mesh.nodes.size(), false);
  for (const Tet& tet : mesh.tets) {
    const auto x = [&](std::size_t k) { return mesh.nodes[static_cast<std::size_t>(tet[k])]; };
    ASSERT_GT(signed_volume6(x(0), x(1), x(2), x(3)), 0);
    for (const Index i : tet) used[static_cast<std::size_t>(i)] = true;
  }
  EXPECT_TRUE(std::ranges::all_of(used, [](bool u) { return u; }));

  const TriangleMesh boundary{mesh.nodes, boundary_triangles(mesh.tets)};
  EXPECT_TRUE(measure_topology(boundary.triangles, mesh.nodes.size()).closed_oriented_manifold());
  EXPECT_NEAR(volume->report.quality.volume_m3 / signed_volume(surface), 1, lost);
  EXPECT_GE(volume->report.quality.min_dihedral_deg, volume->report.features.kept ? 5 : 10);
  EXPECT_LT(volume->report.quality.worst_aspect, 20);
  EXPECT_GT(volume->report.quality.median_dihedral_deg, 35);

  std::vector<Point> outer;
  for (const Index i : used_nodes(boundary.triangles))
    outer.push_back(mesh.nodes[static_cast<std::size_t>(i)]);
  EXPECT_LT(distance_from_surface(outer, TriangleBvh(surface)).largest, off * 0.2);
}

}  // namespace souple
