// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/volume/lattice.hpp"

#include <cmath>

#include "tests/tools/volume/sound_volume.hpp"
#include "tools/geometry/vector.hpp"

namespace souple {
namespace {

/// Labelle and Shewchuk 2007, for the warp of 0.24999 and 0.41189.
constexpr double guaranteed_dihedral = 10.78;

TEST(Lattice, FillsABallWithinTheGuaranteedAngles) {
  const Box box{{-1, -1, -1}, {1, 1, 1}};
  double before = 0;
  for (const double spacing : {0.2, 0.1}) {
    const TetMesh mesh = stuff_isosurface([](const Point& p) { return norm(p) - 1; }, box, spacing);
    const TetQuality quality = measure_tet_quality(mesh);
    EXPECT_GE(quality.min_dihedral_deg, guaranteed_dihedral);
    EXPECT_TRUE(
        measure_topology(boundary_triangles(mesh.tets), mesh.nodes.size()).closed_oriented_manifold());
    const double lost = 1 - quality.volume_m3 / (4 * M_PI / 3);
    EXPECT_GT(lost, 0);
    EXPECT_LT(lost, 0.6 * spacing * spacing);
    if (before > 0) {
      EXPECT_NEAR(before / lost, 4, 0.8);  // the error of chords is quadratic
    }
    before = lost;
  }
}

TEST(Lattice, KeepsItsAnglesWhateverTheFunction) {
  // Far from a distance: wavy at the scale of the lattice.
  const Implicit rough = [](const Point& p) {
    return norm(p) - 0.8 + 0.15 * std::sin(19 * p[0] + 3) * std::sin(23 * p[1]) * std::cos(29 * p[2]);
  };
  const TetMesh mesh = stuff_isosurface(rough, {{-1, -1, -1}, {1, 1, 1}}, 0.15);
  ASSERT_FALSE(mesh.tets.empty());
  EXPECT_GE(measure_tet_quality(mesh).min_dihedral_deg, guaranteed_dihedral);
}

TEST(Lattice, IsEmptyWhereNothingIsInside) {
  EXPECT_TRUE(
      stuff_isosurface([](const Point&) { return 1.0; }, {{0, 0, 0}, {1, 1, 1}}, 0.3).tets.empty());
}

TEST(LatticeMesher, MakesACageOfEverySurface) {
  SOUPLE_NEEDS_REAL_SURFACES();
  // Thin, self-intersecting, of several parts, sharp, with cavities, and ordinary.
  for (const char* name : {"boeing.off", "self_intersectA.obj", "cow.off", "camel.off", "SaladBowl.obj",
                           "collision_boules_V3.obj", "box_inside.obj", "liver-smooth.obj", "dino.off",
                           "Generic_Twin_7863.1.t0_left.obj", "c.obj"}) {
    const TriangleMesh surface = closed_real_surface(name);
    TetrahedralizeOptions options = of_count(1'500);
    options.mesher = MesherKind::lattice;
    const auto cage = tetrahedralize(surface, options);
    ASSERT_TRUE(cage.ok()) << name << ": " << format_issue(cage.issue());
    EXPECT_EQ(cage->report.mesher, MesherKind::lattice);
    EXPECT_FALSE(cage->report.notes.empty());
    EXPECT_GE(cage->report.quality.min_dihedral_deg, guaranteed_dihedral) << name;
    EXPECT_LT(cage->report.quality.worst_aspect, 20) << name;
    const auto topology =
        measure_topology(boundary_triangles(cage->mesh.tets), cage->mesh.nodes.size());
    EXPECT_TRUE(topology.closed_oriented_manifold()) << name;
    EXPECT_GT(cage->report.quality.volume_m3, 0.75 * signed_volume(surface)) << name;
  }
}

TEST(LatticeMesher, KeepsSeparateParts) {
  SOUPLE_NEEDS_REAL_SURFACES();
  TetrahedralizeOptions options = of_count(4'000);
  options.mesher = MesherKind::lattice;
  const auto balls = tetrahedralize(closed_real_surface("collision_boules_V3.obj"), options);
  ASSERT_TRUE(balls.ok());
  EXPECT_EQ(
      measure_topology(boundary_triangles(balls->mesh.tets), balls->mesh.nodes.size()).shell_count, 8u);
}

TEST(LatticeMesher, StepsInWhereTheDelaunayMesherFails) {
  SOUPLE_NEEDS_REAL_SURFACES();
  const TriangleMesh boeing = closed_real_surface("boeing.off");
  TetrahedralizeOptions options = of_count(1'250);
  options.mesher = MesherKind::delaunay;
  EXPECT_FALSE(tetrahedralize(boeing, options).ok());
  options.mesher = MesherKind::automatic;
  const auto cage = tetrahedralize(boeing, options);
  ASSERT_TRUE(cage.ok());
  EXPECT_EQ(cage->report.mesher, MesherKind::lattice);
  EXPECT_NE(cage->report.notes.front().find("Delaunay mesher failed"), std::string::npos);
}

}  // namespace
}  // namespace souple
