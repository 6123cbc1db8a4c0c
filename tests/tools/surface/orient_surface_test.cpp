// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <limits>
#include <map>

#include "tests/tools/real_surface.hpp"
#include "tools/geometry/surface_measure.hpp"

namespace souple {
namespace {

/// A cube of side 2 r about the origin, outward.
TriangleMesh cube(double r, Index first = 0) {
  TriangleMesh mesh;
  for (int i = 0; i < 8; ++i)
    mesh.vertices.push_back({(i & 1) != 0 ? r : -r, (i & 2) != 0 ? r : -r, (i & 4) != 0 ? r : -r});
  for (const Triangle& t : std::initializer_list<Triangle>{{0, 2, 3},
                                                           {0, 3, 1},
                                                           {4, 5, 7},
                                                           {4, 7, 6},
                                                           {0, 1, 5},
                                                           {0, 5, 4},
                                                           {2, 6, 7},
                                                           {2, 7, 3},
                                                           {0, 4, 6},
                                                           {0, 6, 2},
                                                           {1, 3, 7},
                                                           {1, 7, 5}})
    mesh.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
  return mesh;
}

TriangleMesh both(TriangleMesh a, const TriangleMesh& b) {
  const auto offset = static_cast<Index>(a.vertices.size());
  a.vertices.insert(a.vertices.end(), b.vertices.begin(), b.vertices.end());
  for (const Triangle& t : b.triangles)
    a.triangles.push_back({t[0] + offset, t[1] + offset, t[2] + offset});
  return a;
}

TEST(OrientSurface, MakesEveryCleanRealFileASoundVolume) {
  SOUPLE_NEEDS_REAL_SURFACES();
  const std::map<std::string, double> volumes{{"box_inside.obj", 1000},
                                              {"blobby-shuffled.off", 0.0500825},
                                              {"cube4-shuffled.off", 8},
                                              {"tetrahedron.off", 1.0 / 6},
                                              {"truthCylinder-Deformed.obj", 0.000198754},
                                              {"boeing.off", 210.569},
                                              {"knot2.off", 0.0487884},
                                              {"cow.off", 0.046964},
                                              {"liver-smooth.obj", 39.2674}};
  for (const auto& [name, volume] : volumes) {
    const auto imported = import_surface(real_surface_dir() / name, {});
    ASSERT_TRUE(imported.ok()) << name;
    const auto oriented = orient_closed_surface(imported->mesh);
    ASSERT_TRUE(oriented.ok()) << name << ": " << format_issue(oriented.issue());
    EXPECT_TRUE(check_closed_oriented_manifold(oriented->mesh).ok()) << name;
    EXPECT_NEAR(oriented->report.volume_m3, volume, 6e-6 * volume) << name;
    EXPECT_EQ(oriented->mesh.triangles.size(), imported->mesh.triangles.size()) << name;
  }
}

TEST(OrientSurface, CountsSelfIntersectionsOfOneShell) {
  SOUPLE_NEEDS_REAL_SURFACES();
  const auto imported = import_surface(real_surface_dir() / "liver-smooth.obj", {});
  ASSERT_TRUE(imported.ok());
  EXPECT_EQ(orient_closed_surface(imported->mesh)->report.self_intersection_count, 7u);
}

TEST(OrientSurface, RefusesWhatEnclosesNothingWithItsCounts) {
  SOUPLE_NEEDS_REAL_SURFACES();
  struct Case {
    const char* name;
    IssueCode code;
    const char* count;
  };
  for (const Case& c : {Case{"open_cube.off", IssueCode::surface_not_closed, "4 open edges"},
                        Case{"featuretype.STL", IssueCode::surface_not_closed, "576 open edges"},
                        Case{"shared.STL", IssueCode::surface_not_manifold, "1 edges of more"},
                        Case{"dragon.stl", IssueCode::surface_not_manifold, "97 edges of more"},
                        Case{"two_spheres.obj", IssueCode::surface_shells_cross, "147 pairs"},
                        Case{"bones.off", IssueCode::surface_shells_cross, "366 pairs"},
                        Case{"测试模型.off", IssueCode::surface_not_closed, "3 open edges"}}) {
    const auto imported = import_surface(real_surface_dir() / c.name, {});
    ASSERT_TRUE(imported.ok()) << c.name;
    const auto oriented = orient_closed_surface(imported->mesh);
    ASSERT_FALSE(oriented.ok()) << c.name;
    EXPECT_EQ(oriented.issue().code, c.code) << c.name;
    EXPECT_NE(oriented.issue().what.find(c.count), std::string::npos) << oriented.issue().what;
  }
}

TEST(OrientSurface, TurnsAShellInsideAnotherIntoACavity) {
  const auto oriented = orient_closed_surface(both(cube(1), cube(0.5)));
  ASSERT_TRUE(oriented.ok());
  EXPECT_NEAR(oriented->report.volume_m3, 8 - 1, 1e-12);
  EXPECT_EQ(oriented->report.turned_triangle_count, 12u);
  EXPECT_EQ(oriented->report.shell_count, 2u);
}

TEST(OrientSurface, SplitsAVertexThatJoinsTwoFans) {
  TriangleMesh second = cube(1);
  for (Point& p : second.vertices)
    for (double& x : p) x += 2;
  const auto oriented = orient_closed_surface(both(cube(1), second));
  ASSERT_TRUE(oriented.ok()) << format_issue(oriented.issue());
  EXPECT_EQ(oriented->report.split_vertex_count, 1u);
  EXPECT_NEAR(oriented->report.volume_m3, 16, 1e-12);
}

TEST(OrientSurface, RefusesInvalidIndicesNumbersAndFlatBodies) {
  const auto code = [](const TriangleMesh& mesh) { return orient_closed_surface(mesh).issue().code; };
  TriangleMesh bad = cube(1);
  bad.triangles[3][1] = 8;
  EXPECT_EQ(code(bad), IssueCode::surface_invalid);
  bad = cube(1);
  bad.triangles[3][1] = -1;
  EXPECT_EQ(code(bad), IssueCode::surface_invalid);
  bad = cube(1);
  bad.vertices[2][0] = std::numeric_limits<double>::infinity();
  EXPECT_EQ(code(bad), IssueCode::surface_invalid);
  EXPECT_EQ(code({}), IssueCode::surface_no_triangles);
  bad = cube(1);
  for (Point& p : bad.vertices) p[2] *= 1e-12;
  EXPECT_EQ(code(bad), IssueCode::surface_no_volume);
}

}  // namespace
}  // namespace souple
