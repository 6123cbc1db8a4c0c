// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/surface/triage.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "tests/tools/real_surface.hpp"
#include "tests/tools/surface/small_meshes.hpp"

namespace souple {
namespace {

SurfaceTriage examined(const TriangleMesh& mesh) {
  auto triage = triage_surface(mesh);
  EXPECT_TRUE(triage.ok()) << format_issue(triage.issue());
  return triage ? *triage : SurfaceTriage{};
}

SurfaceTriage examined_file(const std::string& name) {
  const auto imported = import_surface(real_surface_dir() / name, {});
  EXPECT_TRUE(imported.ok()) << name;
  return imported ? examined(imported->mesh) : SurfaceTriage{};
}

TEST(Triage, FindsNothingWrongWithACubeEvenAsASoup) {
  for (const TriangleMesh& mesh : {cube(1), as_soup(cube(1))}) {
    const SurfaceTriage t = examined(mesh);
    EXPECT_EQ(t.grade, SurfaceGrade::good);
    EXPECT_TRUE(t.findings.empty());
    EXPECT_EQ(t.vertex_count, 8u);
    EXPECT_EQ(t.triangle_count, 12u);
    EXPECT_EQ(t.component_count, 1u);
    EXPECT_NEAR(t.volume_m3, 8, 1e-12);
    EXPECT_NEAR(t.area_m2, 24, 1e-12);
    EXPECT_EQ(t.box_max, (Point{1, 1, 1}));
  }
}

TEST(Triage, CountsHolesAndTheirSize) {
  const SurfaceTriage t = examined(without_first(cube(1), 2));
  EXPECT_EQ(t.boundary_edge_count, 4u);
  EXPECT_EQ(t.hole_count, 1u);
  EXPECT_NEAR(t.largest_hole, 8 / std::sqrt(12), 1e-12);
  EXPECT_EQ(t.grade, SurfaceGrade::wrap);  // a sixth of the area
}

TEST(Triage, CountsOpposedEdgesAndShellsThatFaceTheWrongWay) {
  TriangleMesh mesh = cube(1);
  std::swap(mesh.triangles[0][0], mesh.triangles[0][1]);
  EXPECT_EQ(examined(mesh).opposed_edge_count, 3u);
  EXPECT_EQ(examined(mesh).grade, SurfaceGrade::repairable);
  EXPECT_EQ(examined(turned(cube(1))).inverted_shell_count, 1u);
  const SurfaceTriage cavity = examined(join_meshes({cube(1), turned(cube(0.5))}));
  EXPECT_EQ(cavity.nested_shell_count, 1u);
  EXPECT_EQ(cavity.inverted_shell_count, 0u);
  EXPECT_EQ(cavity.grade, SurfaceGrade::good);
  EXPECT_EQ(examined(join_meshes({cube(1), cube(0.5)})).inverted_shell_count, 1u);
}

TEST(Triage, CountsDegenerateAndDuplicateTriangles) {
  TriangleMesh mesh = cube(1);
  mesh.triangles.push_back({0, 0, 1});
  mesh.triangles.push_back(mesh.triangles[5]);
  mesh.triangles.push_back({mesh.triangles[5][1], mesh.triangles[5][0], mesh.triangles[5][2]});
  const SurfaceTriage t = examined(mesh);
  EXPECT_EQ(t.degenerate_triangle_count, 1u);
  EXPECT_EQ(t.duplicate_triangle_count, 2u);
  EXPECT_EQ(t.boundary_edge_count, 0u);
  EXPECT_EQ(t.grade, SurfaceGrade::repairable);
}

TEST(Triage, CountsNonManifoldEdgesAndVertices) {
  const SurfaceTriage edge = examined(join_meshes({cube(1), cube(1, {2, 2, 0})}));
  EXPECT_EQ(edge.nonmanifold_edge_count, 1u);
  const SurfaceTriage vertex = examined(join_meshes({cube(1), cube(1, {2, 2, 2})}));
  EXPECT_EQ(vertex.nonmanifold_edge_count, 0u);
  EXPECT_EQ(vertex.nonmanifold_vertex_count, 1u);
}

TEST(Triage, CountsSelfIntersectionsOfSoupsToo) {
  const TriangleMesh crossing = join_meshes({cube(1), cube(1, {1, 0.9, 0.8})});
  const SurfaceTriage t = examined(crossing);
  EXPECT_GT(t.self_intersection_count, 0u);
  EXPECT_EQ(examined(as_soup(crossing)).self_intersection_count, t.self_intersection_count);
  EXPECT_EQ(t.component_count, 2u);
}

TEST(Triage, CallsFlatThingsAndSinglePatchesHopeless) {
  TriangleMesh one{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}};
  EXPECT_EQ(examined(one).grade, SurfaceGrade::hopeless);
  // A shallow tent over a square.
  const TriangleMesh tent{{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0.5, 0.5, 0.05}},
                          {{0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}}};
  EXPECT_EQ(examined(tent).grade, SurfaceGrade::hopeless);
  EXPECT_FALSE(examined(tent).findings.empty());
}

TEST(Triage, GradesTheSameInAnyUnitAndPlace) {
  for (const double scale : {1e-9, 1e-3, 1e6, 1e14}) {
    TriangleMesh mesh = without_first(cube(1), 1);
    for (Point& p : mesh.vertices) p = add_scaled({3 * scale, 5 * scale, -scale}, scale, p);
    const SurfaceTriage t = examined(mesh);
    EXPECT_EQ(t.grade, SurfaceGrade::repairable) << scale;
    EXPECT_NEAR(t.largest_hole, (4 + std::sqrt(8)) / std::sqrt(12), 1e-6) << scale;
  }
}

TEST(Triage, RefusesInvalidMeshes) {
  TriangleMesh bad = cube(1);
  bad.triangles[0][0] = 8;
  EXPECT_EQ(triage_surface(bad).issue().code, IssueCode::surface_invalid);
  bad = cube(1);
  bad.vertices[0][1] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(triage_surface(bad).issue().code, IssueCode::surface_invalid);
  EXPECT_EQ(triage_surface({}).issue().code, IssueCode::surface_no_triangles);
}

TEST(Triage, AgreesWithTheStatisticsOfRealFiles) {
  SOUPLE_NEEDS_REAL_SURFACES();
  EXPECT_EQ(examined_file("liver-smooth.obj").self_intersection_count, 7u);
  EXPECT_EQ(examined_file("camel.off").self_intersection_count, 20u);
  EXPECT_EQ(examined_file("cow.off").nonmanifold_vertex_count, 1u);
  EXPECT_EQ(examined_file("cow.off").self_intersection_count, 89u);
  EXPECT_EQ(examined_file("two_spheres.obj").self_intersection_count, 147u);
  EXPECT_EQ(examined_file("bones.off").component_count, 26u);
  EXPECT_EQ(examined_file("dragon.stl").nonmanifold_edge_count, 97u);
  EXPECT_EQ(examined_file("dragon.stl").self_intersection_count, 244u);
  EXPECT_EQ(examined_file("blobby-shuffled.off").opposed_edge_count, 3069u);
  EXPECT_EQ(examined_file("open_cube.off").boundary_edge_count, 4u);
  EXPECT_EQ(examined_file("mech-holes-shark.off").hole_count, 4u);
  EXPECT_EQ(examined_file("bunny_10k.obj").grade, SurfaceGrade::good);
  EXPECT_EQ(examined_file("soup.stl").grade, SurfaceGrade::hopeless);
}

}  // namespace
}  // namespace souple
