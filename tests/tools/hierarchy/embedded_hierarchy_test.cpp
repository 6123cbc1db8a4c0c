// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/hierarchy/embedded_hierarchy.hpp"

#include "tests/tools/hierarchy/hierarchy_shapes.hpp"
#include "tests/tools/real_surface.hpp"
#include "tools/geometry/vector.hpp"

namespace souple {
namespace {

TEST(EmbeddedHierarchy, EmbedsEveryLevelInTheCoarserOne) {
  SOUPLE_NEEDS_REAL_SURFACES();
  const TriangleMesh surface = closed_real_surface("bunny_10k.obj");
  const std::vector<TetMesh> meshes{coarse_mesh(surface, 300), coarse_mesh(surface, 1500),
                                    coarse_mesh(surface, 6000)};
  const auto hierarchy = build_embedded_hierarchy(meshes, surface);
  ASSERT_TRUE(hierarchy.ok()) << format_issue(hierarchy.issue());
  ASSERT_EQ(hierarchy->levels.size(), 3u);
  ASSERT_EQ(hierarchy->reports.size(), 3u);
  for (std::size_t l = 0; l < 3; ++l) {
    const MeshLevel& level = hierarchy->levels[l];
    const LevelReport& report = hierarchy->reports[l];
    EXPECT_EQ(level.mesh.nodes, meshes[l].nodes);
    EXPECT_EQ(level.mesh.tets, meshes[l].tets);
    EXPECT_EQ(level.boundary, boundary_triangles(meshes[l].tets));
    EXPECT_TRUE(level.parents.empty());
    EXPECT_EQ(report.tet_count, meshes[l].tets.size());
    EXPECT_EQ(report.rigid_motion_error.parents, -1);
    EXPECT_GT(report.min_dihedral_deg, 5);
    if (l == 0) continue;
    ASSERT_EQ(level.embedding.size(), level.mesh.nodes.size());
    EXPECT_GE(level.rigid_motion_error.embedding, 0);
    EXPECT_LT(level.rigid_motion_error.embedding, 1e-12);
    EXPECT_LT(report.distance.root_mean_square(),
              hierarchy->reports[l - 1].distance.root_mean_square());
  }
  EXPECT_TRUE(hierarchy->levels[0].embedding.empty());
}

TEST(EmbeddedHierarchy, RefusesWhatIsNoHierarchy) {
  const TetMesh coarse = kuhn_cube(1), fine = kuhn_cube(2);
  const TriangleMesh target = boundary_of(coarse);
  const auto code = [&](const std::vector<TetMesh>& meshes, const TriangleMesh& surface) {
    const auto hierarchy = build_embedded_hierarchy(meshes, surface);
    return hierarchy.ok() ? IssueCode{} : hierarchy.issue().code;
  };
  EXPECT_EQ(code({coarse, fine}, target), IssueCode{});
  EXPECT_EQ(code({}, target), IssueCode::usage_bad_value);
  EXPECT_EQ(code(std::vector<TetMesh>(6, coarse), target), IssueCode::usage_bad_value);
  EXPECT_EQ(code({fine, coarse}, target), IssueCode::usage_bad_value);
  EXPECT_EQ(code({coarse, fine}, {}), IssueCode::surface_no_triangles);
  TetMesh bad = fine;
  std::swap(bad.tets[3][0], bad.tets[3][1]);
  const auto refused = build_embedded_hierarchy({coarse, bad}, target);
  ASSERT_FALSE(refused.ok());
  EXPECT_EQ(refused.issue().code, IssueCode::mesh_element_invalid);
  EXPECT_EQ(refused.issue().where, "level 1");
  bad = fine;
  for (Point& x : bad.nodes) x[0] += 1e5;
  EXPECT_EQ(code({coarse, bad}, target), IssueCode::embedding_failed);
}

}  // namespace
}  // namespace souple
