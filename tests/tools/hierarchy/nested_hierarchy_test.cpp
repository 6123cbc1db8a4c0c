// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/hierarchy/nested_hierarchy.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "tests/tools/real_surface.hpp"
#include "tools/geometry/surface_measure.hpp"
#include "tools/geometry/vector.hpp"
#include "tools/volume/tetrahedralize.hpp"

namespace souple {
namespace {

TetMesh coarse_mesh(const TriangleMesh& surface, std::size_t tets) {
  auto volume = tetrahedralize(surface, {tets, 0});
  EXPECT_TRUE(volume.ok()) << format_issue(volume.issue());
  return volume ? std::move(volume->mesh) : TetMesh{};
}

double total_volume(const TetMesh& mesh) { return measure_tet_quality(mesh).volume_m3; }

void expect_sound_level(const MeshLevel& level, const MeshLevel& coarser) {
  EXPECT_EQ(level.mesh.tets.size(), 8 * coarser.mesh.tets.size());
  EXPECT_EQ(level.boundary.size(), 4 * coarser.boundary.size());
  EXPECT_EQ(level.boundary, boundary_triangles(level.mesh.tets));
  EXPECT_TRUE(measure_topology(level.boundary, level.mesh.nodes.size()).closed_oriented_manifold());
  EXPECT_GT(measure_tet_quality(level.mesh).min_dihedral_deg, 0);
  ASSERT_EQ(level.parents.size(), level.mesh.nodes.size());
  const auto coarse_count = static_cast<Index>(coarser.mesh.nodes.size());
  for (std::size_t i = 0; i < level.parents.size(); ++i) {
    const auto [a, b] = level.parents[i];
    if (i < coarser.mesh.nodes.size())
      EXPECT_TRUE(a == static_cast<Index>(i) && b == a);
    else
      EXPECT_TRUE(0 <= a && a < b && b < coarse_count);
  }
}

TEST(NestedHierarchy, ReproducesTheMidpointsWhenNothingIsFitted) {
  SOUPLE_NEEDS_REAL_SURFACES();
  const TriangleMesh surface = closed_real_surface("liver-smooth.obj");
  const TetMesh coarse = coarse_mesh(surface, 500);
  const auto hierarchy = build_nested_hierarchy(coarse, surface, {3, false});
  ASSERT_TRUE(hierarchy.ok());
  ASSERT_EQ(hierarchy->levels.size(), 3u);
  EXPECT_EQ(hierarchy->levels[0].mesh.nodes, coarse.nodes);
  EXPECT_EQ(hierarchy->levels[0].mesh.tets, coarse.tets);
  EXPECT_TRUE(hierarchy->levels[0].parents.empty());
  for (std::size_t l = 1; l < 3; ++l) {
    const MeshLevel &fine = hierarchy->levels[l], &coarser = hierarchy->levels[l - 1];
    expect_sound_level(fine, coarser);
    EXPECT_NEAR(total_volume(fine.mesh) / total_volume(coarse), 1, 1e-12);
    for (std::size_t i = 0; i < fine.parents.size(); ++i) {
      const Point& a = coarser.mesh.nodes[static_cast<std::size_t>(fine.parents[i][0])];
      const Point& b = coarser.mesh.nodes[static_cast<std::size_t>(fine.parents[i][1])];
      EXPECT_EQ(fine.mesh.nodes[i], scaled(add(a, b), 0.5));
    }
  }
}

struct Shape {
  const char* name;
  /// Tets with all four nodes on the boundary get no help from inner nodes; thin bodies have many.
  double most_held_back;  ///< part of the boundary nodes
};

void PrintTo(const Shape& shape, std::ostream* out) { *out << shape.name; }

class FittedHierarchy : public ::testing::TestWithParam<Shape> {};

TEST_P(FittedHierarchy, ApproachesTheSurfaceWithSoundTets) {
  SOUPLE_NEEDS_REAL_SURFACES();
  const TriangleMesh surface = closed_real_surface(GetParam().name);
  const TetMesh coarse = coarse_mesh(surface, 1000);
  const auto fitted = build_nested_hierarchy(coarse, surface, {3, true});
  const auto plain = build_nested_hierarchy(coarse, surface, {3, false});
  ASSERT_TRUE(fitted.ok() && plain.ok());
  for (std::size_t l = 1; l < 3; ++l) {
    expect_sound_level(fitted->levels[l], fitted->levels[l - 1]);
    const NestedLevelReport &report = fitted->reports[l], &unfitted = plain->reports[l];
    RecordProperty("rms_um_" + std::to_string(l), std::to_string(1e6 * report.rms_distance_m));
    EXPECT_EQ(report.node_count, fitted->levels[l].mesh.nodes.size());
    EXPECT_LT(report.rms_distance_m, 0.2 * unfitted.rms_distance_m) << "level " << l;
    EXPECT_LE(report.hausdorff_m, unfitted.hausdorff_m) << "level " << l;
    EXPECT_GE(report.min_dihedral_deg, 4.5) << "level " << l;
    EXPECT_LT(
        static_cast<double>(report.held_back_count),
        GetParam().most_held_back * static_cast<double>(used_nodes(fitted->levels[l].boundary).size()))
        << "level " << l;
  }
  // The volume the coarse mesh lacks comes back.
  const double real = signed_volume(surface);
  EXPECT_LT(std::abs(total_volume(fitted->levels[2].mesh) - real),
            std::abs(total_volume(coarse) - real));
}

INSTANTIATE_TEST_SUITE_P(Shapes, FittedHierarchy,
                         ::testing::Values(Shape{"liver-smooth.obj", 0.1}, Shape{"dino.off", 0.2},
                                           Shape{"bunny_10k.obj", 0.1}, Shape{"anchor.off", 0.13}));

TEST(NestedHierarchy, MovesOnlyTheBoundaryAndItsSurroundings) {
  SOUPLE_NEEDS_REAL_SURFACES();
  const TriangleMesh surface = closed_real_surface("liver-smooth.obj");
  const TetMesh coarse = coarse_mesh(surface, 3000);
  const auto fitted = build_nested_hierarchy(coarse, surface, {2, true});
  const auto plain = build_nested_hierarchy(coarse, surface, {2, false});
  ASSERT_TRUE(fitted.ok() && plain.ok());
  const MeshLevel& level = fitted->levels[1];
  std::vector<bool> is_near(level.mesh.nodes.size(), false);
  for (const Index i : used_nodes(level.boundary)) is_near[static_cast<std::size_t>(i)] = true;
  for (int ring = 0; ring < 3; ++ring) {
    const std::vector<bool> before = is_near;
    for (const Tet& tet : level.mesh.tets)
      if (std::ranges::any_of(tet, [&](Index i) { return before[static_cast<std::size_t>(i)]; }))
        for (const Index i : tet) is_near[static_cast<std::size_t>(i)] = true;
  }
  std::size_t inside = 0;
  for (std::size_t i = 0; i < is_near.size(); ++i)
    if (!is_near[i]) {
      ++inside;
      EXPECT_EQ(level.mesh.nodes[i], plain->levels[1].mesh.nodes[i]);
    }
  EXPECT_GT(inside, 0u);
}

TEST(NestedHierarchy, GivesTheSameBytesTwice) {
  SOUPLE_NEEDS_REAL_SURFACES();
  const TriangleMesh surface = closed_real_surface("bunny_10k.obj");
  const TetMesh coarse = coarse_mesh(surface, 1000);
  const auto a = build_nested_hierarchy(coarse, surface, {2, true});
  const auto b = build_nested_hierarchy(coarse, surface, {2, true});
  ASSERT_TRUE(a.ok() && b.ok());
  EXPECT_EQ(a->levels[1].mesh.nodes, b->levels[1].mesh.nodes);
  EXPECT_EQ(a->levels[1].mesh.tets, b->levels[1].mesh.tets);
  EXPECT_EQ(a->levels[1].parents, b->levels[1].parents);
}

TEST(NestedHierarchy, RefusesWhatItCannotRefine) {
  const TetMesh tet{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {{0, 1, 2, 3}}};
  const TriangleMesh target{tet.nodes, boundary_triangles(tet.tets)};
  const auto code = [&](const TetMesh& mesh, const NestedHierarchyOptions& options) {
    const auto hierarchy = build_nested_hierarchy(mesh, target, options);
    return hierarchy.ok() ? IssueCode{} : hierarchy.issue().code;
  };
  EXPECT_EQ(code(tet, {5, true}), IssueCode{});
  for (const int levels : {0, -1, 6, std::numeric_limits<int>::max()})
    EXPECT_EQ(code(tet, {levels, true}), IssueCode::usage_bad_value) << levels;
  TetMesh bad = tet;
  std::swap(bad.tets[0][0], bad.tets[0][1]);
  EXPECT_EQ(code(bad, {2, true}), IssueCode::mesh_element_invalid);
  bad = tet;
  bad.tets[0][3] = 4;
  EXPECT_EQ(code(bad, {2, true}), IssueCode::mesh_element_invalid);
  bad = tet;
  bad.nodes[3][2] = std::nan("");
  EXPECT_EQ(code(bad, {2, true}), IssueCode::mesh_element_invalid);
  EXPECT_EQ(code({}, {2, true}), IssueCode::mesh_element_invalid);
  bad = tet;
  bad.tets.assign(100'000, tet.tets[0]);
  EXPECT_EQ(code(bad, {5, true}), IssueCode::hierarchy_too_large);
  EXPECT_EQ(build_nested_hierarchy(tet, {}, {2, true}).issue().code, IssueCode::surface_no_triangles);
}

}  // namespace
}  // namespace souple
