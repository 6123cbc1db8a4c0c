// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/volume/tetrahedralize.hpp"

#include <cmath>

#include "tests/tools/volume/sound_volume.hpp"
#include "tools/geometry/vector.hpp"

namespace souple {
namespace {

TEST(Tetrahedralize, FillsALiver) {
  SOUPLE_NEEDS_REAL_SURFACES();
  expect_sound_volume("liver-smooth.obj", 1'000, 0.05, 0.01);
  expect_sound_volume("liver-smooth.obj", 10'000, 0.015, 0.005);
}

TEST(Tetrahedralize, FillsADinosaur) {
  SOUPLE_NEEDS_REAL_SURFACES();
  expect_sound_volume("dino.off", 1'000, 0.12, 0.02);
  expect_sound_volume("dino.off", 10'000, 0.03, 0.008);
}

TEST(Tetrahedralize, FillsABunny) {
  SOUPLE_NEEDS_REAL_SURFACES();
  expect_sound_volume("bunny_10k.obj", 1'000, 0.07, 0.02);
  expect_sound_volume("bunny_10k.obj", 10'000, 0.02, 0.01);
}

TEST(Tetrahedralize, FillsASharpMachinePart) {
  SOUPLE_NEEDS_REAL_SURFACES();
  expect_sound_volume("anchor.off", 1'000, 0.07, 0.03);
  expect_sound_volume("anchor.off", 10'000, 0.015, 0.01);
}

TEST(Tetrahedralize, KeepsEverySeparateShell) {
  SOUPLE_NEEDS_REAL_SURFACES();
  const TriangleMesh balls = closed_real_surface("collision_boules_V3.obj");
  const auto volume = tetrahedralize(balls, of_count(4'000));
  ASSERT_TRUE(volume.ok()) << format_issue(volume.issue());
  const auto boundary = boundary_triangles(volume->mesh.tets);
  EXPECT_EQ(measure_topology(boundary, volume->mesh.nodes.size()).shell_count, 8u);
}

TEST(Tetrahedralize, GivesTheSameBytesTwice) {
  SOUPLE_NEEDS_REAL_SURFACES();
  const TriangleMesh surface = closed_real_surface("liver-smooth.obj");
  const auto a = tetrahedralize(surface, of_count(3'000));
  const auto b = tetrahedralize(surface, of_count(3'000));
  ASSERT_TRUE(a.ok() && b.ok());
  EXPECT_EQ(a->mesh.nodes, b->mesh.nodes);
  EXPECT_EQ(a->mesh.tets, b->mesh.tets);
}

TEST(Tetrahedralize, GivesTheSameTetsInAnyUnitAndPlace) {
  SOUPLE_NEEDS_REAL_SURFACES();
  for (const char* name : {"liver-smooth.obj", "dino.off"}) {
    const TriangleMesh metres = closed_real_surface(name);
    const auto here = tetrahedralize(metres, of_count(2'000));
    ASSERT_TRUE(here.ok());
    for (const double factor : {1e3, 1e-3, 39.37}) {
      TriangleMesh other = metres;
      for (Point& p : other.vertices) p = scaled(add(p, {0.31, -0.17, 0.05}), factor);
      const auto there = tetrahedralize(other, of_count(2'000));
      ASSERT_TRUE(there.ok());
      EXPECT_EQ(here->mesh.tets, there->mesh.tets) << name << " " << factor;
      for (std::size_t i = 0; i < here->mesh.nodes.size(); i += 50) {
        const Point moved = scaled(add(here->mesh.nodes[i], {0.31, -0.17, 0.05}), factor);
        EXPECT_LT(norm(subtract(moved, there->mesh.nodes[i])), 1e-8 * factor) << name;
      }
    }
  }
}

TEST(Tetrahedralize, MeetsAnEdgeLength) {
  SOUPLE_NEEDS_REAL_SURFACES();
  const TriangleMesh surface = closed_real_surface("liver-smooth.obj");
  for (const double asked : {0.02, 0.01}) {
    const auto volume = tetrahedralize(surface, of_edge(asked));
    ASSERT_TRUE(volume.ok());
    double sum = 0;
    for (const Tet& tet : volume->mesh.tets)
      for (std::size_t a = 0; a < 4; ++a)
        for (std::size_t b = a + 1; b < 4; ++b)
          sum += norm(subtract(volume->mesh.nodes[static_cast<std::size_t>(tet[a])],
                               volume->mesh.nodes[static_cast<std::size_t>(tet[b])]));
    EXPECT_NEAR(sum / (6 * static_cast<double>(volume->mesh.tets.size())) / asked, 1, 0.1);
  }
}

TEST(Tetrahedralize, RefusesOptionsOutOfRangeAndOpenSurfaces) {
  SOUPLE_NEEDS_REAL_SURFACES();
  const TriangleMesh surface = closed_real_surface("liver.obj");
  const auto code = [](const TriangleMesh& mesh, const TetrahedralizeOptions& options) {
    const auto volume = tetrahedralize(mesh, options);
    return volume.ok() ? IssueCode{} : volume.issue().code;
  };
  EXPECT_EQ(code(surface, of_count(0)), IssueCode::usage_bad_value);
  EXPECT_EQ(code(surface, of_count(std::size_t{1} << 60)), IssueCode::usage_bad_value);
  for (const double edge : {-1.0, std::nan(""), HUGE_VAL, 1.0, 1e-9})
    EXPECT_EQ(code(surface, of_edge(edge)), IssueCode::usage_bad_value) << edge;
  TriangleMesh open = surface;
  open.triangles.pop_back();
  EXPECT_EQ(code(open, of_count(1000)), IssueCode::surface_not_closed);
  TriangleMesh inside_out = surface;
  for (Triangle& t : inside_out.triangles) std::swap(t[0], t[1]);
  EXPECT_EQ(code(inside_out, of_count(1000)), IssueCode::surface_no_volume);
  EXPECT_EQ(code({}, of_count(1000)), IssueCode::surface_no_triangles);
}

}  // namespace
}  // namespace souple
