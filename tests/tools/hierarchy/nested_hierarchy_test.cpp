// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/hierarchy/nested_hierarchy.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string_view>

#include "tests/tools/hierarchy/hierarchy_shapes.hpp"
#include "tests/tools/real_surface.hpp"
#include "tools/geometry/surface_measure.hpp"
#include "tools/geometry/vector.hpp"
#include "tools/volume/tetrahedralize.hpp"

namespace souple {
namespace {

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
  const auto hierarchy =
      build_nested_hierarchy(coarse, surface, {3, DiagonalRule::best_quality, FitRule::none});
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

constexpr FitRule fitting[] = {FitRule::nearest_three, FitRule::least_squares, FitRule::projection};

class FittedHierarchy : public ::testing::TestWithParam<const char*> {};

// The targets: 95 % of the children keep 70 % of their parent's quality, none less than 35 %.
TEST_P(FittedHierarchy, ComesToTheSurfaceAndKeepsTheQuality) {
  SOUPLE_NEEDS_REAL_SURFACES();
  const TriangleMesh surface = closed_real_surface(GetParam());
  const TetMesh coarse = coarse_mesh(surface, 1250);
  const auto hierarchy = build_nested_hierarchy(coarse, surface, {3});
  ASSERT_TRUE(hierarchy.ok()) << format_issue(hierarchy.issue());
  for (std::size_t l = 1; l < 3; ++l) {
    expect_sound_level(hierarchy->levels[l], hierarchy->levels[l - 1]);
    const LevelReport &report = hierarchy->reports[l], &before = hierarchy->reports[l - 1];
    RecordProperty("rms_um_" + std::to_string(l),
                   std::to_string(1e6 * report.distance.root_mean_square()));
    EXPECT_EQ(report.node_count, hierarchy->levels[l].mesh.nodes.size());
    EXPECT_GE(report.children.share_keeping_70, 0.95) << "level " << l;
    EXPECT_GE(report.children.worst_kept, 0.35) << "level " << l;
    EXPECT_LT(report.distance.root_mean_square(), before.distance.root_mean_square() / 2)
        << "level " << l;
    EXPECT_LT(report.distance.hausdorff(), before.distance.hausdorff()) << "level " << l;
    EXPECT_GT(report.rigid_motion_error.parents, 1e-3);
    EXPECT_LT(report.rigid_motion_error.embedding, 1e-12);
    // Thin limbs give way to the quality of their tets most: the dinosaur's, 18 %.
    const double most = GetParam() == std::string_view("dino.off") ? 0.2 : 0.1;
    EXPECT_LT(static_cast<double>(report.held_back_count),
              most * static_cast<double>(used_nodes(hierarchy->levels[l].boundary).size()));
  }
  // The volume the coarse mesh lacks comes back.
  const double real = signed_volume(surface);
  EXPECT_LT(std::abs(total_volume(hierarchy->levels[2].mesh) - real),
            0.2 * std::abs(total_volume(coarse) - real));
}

INSTANTIATE_TEST_SUITE_P(Shapes, FittedHierarchy,
                         ::testing::Values("liver-smooth.obj", "dino.off", "bunny_10k.obj",
                                           "blobby.off", "ballA.off", "anchor.off"));

TEST(NestedHierarchy, ConvergesQuadraticallyToASmoothBody) {
  SOUPLE_NEEDS_REAL_SURFACES();
  const TriangleMesh surface = closed_real_surface("blobby.off");
  const auto hierarchy = build_nested_hierarchy(coarse_mesh(surface, 150), surface, {3});
  ASSERT_TRUE(hierarchy.ok());
  for (std::size_t l = 1; l < 3; ++l) {
    const TwoSidedDistance &now = hierarchy->reports[l].distance,
                           &before = hierarchy->reports[l - 1].distance;
    EXPECT_GT(before.hausdorff() / now.hausdorff(), 2.5) << l;
    // From there on the target's own facets (87 um rms) count.
    EXPECT_LT(now.root_mean_square(), std::max(before.root_mean_square() / 3.5, 87e-6)) << l;
  }
}

TEST(NestedHierarchy, FitsBestByTheDefaultRule) {
  SOUPLE_NEEDS_REAL_SURFACES();
  const TriangleMesh surface = closed_real_surface("liver-smooth.obj");
  const TetMesh coarse = coarse_mesh(surface, 1000);
  const auto plain = build_nested_hierarchy(coarse, surface, {2, {}, FitRule::none});
  ASSERT_TRUE(plain.ok());
  double rms = plain->reports[1].distance.root_mean_square();
  double volume_lost = std::abs(signed_volume(surface) - total_volume(plain->levels[1].mesh));
  for (const FitRule rule : fitting) {
    const auto fitted = build_nested_hierarchy(coarse, surface, {2, {}, rule});
    ASSERT_TRUE(fitted.ok());
    expect_sound_level(fitted->levels[1], fitted->levels[0]);
    EXPECT_GE(fitted->reports[1].children.worst_kept, 0.35);
    const double fitted_rms = fitted->reports[1].distance.root_mean_square();
    EXPECT_LT(fitted_rms, rms) << static_cast<int>(rule);
    rms = fitted_rms;
    const double lost = std::abs(signed_volume(surface) - total_volume(fitted->levels[1].mesh));
    EXPECT_LT(lost, volume_lost);
  }
}

TEST(NestedHierarchy, BindsUnmovedNodesToTheirParents) {
  const TetMesh coarse = kuhn_cube(3);
  const auto hierarchy = build_nested_hierarchy(coarse, boundary_of(coarse), {2, {}, FitRule::none});
  ASSERT_TRUE(hierarchy.ok());
  const MeshLevel& level = hierarchy->levels[1];
  ASSERT_EQ(level.embedding.size(), level.parents.size());
  for (std::size_t i = 0; i < level.parents.size(); ++i) {
    const auto [a, b] = level.parents[i];
    const auto& [tet, weights] = level.embedding[i];
    for (std::size_t k = 0; k < 4; ++k) {
      const Index node = coarse.tets[static_cast<std::size_t>(tet)][k];
      const double expected = 0.5 * (node == a) + 0.5 * (node == b);
      EXPECT_NEAR(weights[k], expected, 1e-14);
    }
  }
  EXPECT_EQ(level.rigid_motion_error.parents, 0);
  EXPECT_LT(level.rigid_motion_error.embedding, 1e-14);
}

// Corners and edges give way to the shape of their tets by less than 2e-4 of the side.
TEST(NestedHierarchy, KeepsACubeACube) {
  const TetMesh coarse = kuhn_cube(2);
  const auto hierarchy = build_nested_hierarchy(coarse, boundary_of(coarse), {4});
  ASSERT_TRUE(hierarchy.ok());
  for (std::size_t l = 1; l < 4; ++l) {
    EXPECT_NEAR(total_volume(hierarchy->levels[l].mesh), 1, 2e-4) << l;
    EXPECT_LT(hierarchy->reports[l].distance.hausdorff(), 2e-4) << l;
    EXPECT_GE(hierarchy->reports[l].children.worst_kept, 0.7) << l;
  }
}

TEST(NestedHierarchy, TakesTheSameDecisionsInMillimetresAndFarAway) {
  SOUPLE_NEEDS_REAL_SURFACES();
  const TriangleMesh surface = closed_real_surface("bunny_10k.obj");
  const TetMesh coarse = coarse_mesh(surface, 600);
  const auto metres = build_nested_hierarchy(coarse, surface, {3});
  ASSERT_TRUE(metres.ok());
  struct Change {
    double scale;
    Point shift;
  };
  for (const auto& [scale, shift] : {Change{1000, {}}, Change{1e-3, {}}, Change{1, {3, -2, 5}}}) {
    TriangleMesh other_surface = surface;
    TetMesh other = coarse;
    for (auto* points : {&other_surface.vertices, &other.nodes})
      for (Point& x : *points) x = add_scaled(shift, scale, x);
    const auto changed = build_nested_hierarchy(other, other_surface, {3});
    ASSERT_TRUE(changed.ok());
    for (std::size_t l = 1; l < 3; ++l) {
      const TetMesh &a = metres->levels[l].mesh, &b = changed->levels[l].mesh;
      EXPECT_EQ(a.tets, b.tets);
      double farthest = 0;
      for (std::size_t i = 0; i < a.nodes.size(); ++i)
        farthest = std::max(farthest, norm(subtract(b.nodes[i], add_scaled(shift, scale, a.nodes[i]))));
      EXPECT_LT(farthest, 1e-6 * 0.2 * scale) << "level " << l << " scale " << scale;
    }
  }
}

TEST(NestedHierarchy, GivesTheSameBytesTwice) {
  SOUPLE_NEEDS_REAL_SURFACES();
  const TriangleMesh surface = closed_real_surface("bunny_10k.obj");
  const TetMesh coarse = coarse_mesh(surface, 1000);
  for (const FitRule rule : fitting) {
    const auto a = build_nested_hierarchy(coarse, surface, {2, {}, rule});
    const auto b = build_nested_hierarchy(coarse, surface, {2, {}, rule});
    ASSERT_TRUE(a.ok() && b.ok());
    EXPECT_EQ(a->levels[1].mesh.nodes, b->levels[1].mesh.nodes);
    EXPECT_EQ(a->levels[1].mesh.tets, b->levels[1].mesh.tets);
    EXPECT_EQ(a->levels[1].parents, b->levels[1].parents);
  }
}

TEST(NestedHierarchy, StaysSoundWhereTheTargetIsSomethingElse) {
  const TetMesh coarse = kuhn_cube(2);
  const TriangleMesh cube = boundary_of(coarse);
  TriangleMesh far = cube, tiny = cube, flat = cube, inside_out = cube;
  for (Point& x : far.vertices) x = add(x, {1e6, 0, 0});
  for (Point& x : tiny.vertices) x = scaled(x, 1e-9);
  for (Point& x : flat.vertices) x[2] = 0;
  for (Triangle& t : inside_out.triangles) std::swap(t[0], t[1]);
  const TriangleMesh sliver{{{0, 0, 0}, {1, 0, 0}, {0.5, 0, 0}}, {{0, 1, 2}}};
  for (const TriangleMesh& target : {far, tiny, flat, inside_out, sliver})
    for (const FitRule rule : fitting) {
      const auto hierarchy = build_nested_hierarchy(coarse, target, {3, {}, rule});
      ASSERT_TRUE(hierarchy.ok()) << format_issue(hierarchy.issue());
      for (std::size_t l = 1; l < 3; ++l)
        expect_sound_level(hierarchy->levels[l], hierarchy->levels[l - 1]);
    }
}

TEST(NestedHierarchy, RefusesWhatItCannotRefine) {
  const TetMesh tet = unit_tet();
  const TriangleMesh target = boundary_of(tet);
  const auto code = [&](const TetMesh& mesh, const NestedHierarchyOptions& options) {
    const auto hierarchy = build_nested_hierarchy(mesh, target, options);
    return hierarchy.ok() ? IssueCode{} : hierarchy.issue().code;
  };
  EXPECT_EQ(code(tet, {5}), IssueCode{});
  for (const int levels : {0, -1, 6, std::numeric_limits<int>::max()})
    EXPECT_EQ(code(tet, {levels}), IssueCode::usage_bad_value) << levels;
  TetMesh bad = tet;
  std::swap(bad.tets[0][0], bad.tets[0][1]);
  EXPECT_EQ(code(bad, {2}), IssueCode::mesh_element_invalid);
  bad = tet;
  bad.tets[0][3] = 4;
  EXPECT_EQ(code(bad, {2}), IssueCode::mesh_element_invalid);
  for (const double x : {std::nan(""), 3e38, 1e300}) {
    bad = tet;
    bad.nodes[3][2] = x;
    EXPECT_EQ(code(bad, {2}), IssueCode::mesh_element_invalid);
  }
  bad = tet;
  bad.nodes.push_back({2, 2, 2});
  EXPECT_EQ(code(bad, {2}), IssueCode::mesh_element_invalid);
  EXPECT_EQ(code({}, {2}), IssueCode::mesh_element_invalid);
  bad = tet;
  bad.tets.assign(100'000, tet.tets[0]);
  EXPECT_EQ(code(bad, {5}), IssueCode::hierarchy_too_large);
  EXPECT_EQ(build_nested_hierarchy(tet, {}, {2}).issue().code, IssueCode::surface_no_triangles);
  TriangleMesh far = target;
  far.vertices[0][0] = 3e38;
  EXPECT_EQ(build_nested_hierarchy(tet, far, {2}).issue().code, IssueCode::surface_too_far);
}

}  // namespace
}  // namespace souple
