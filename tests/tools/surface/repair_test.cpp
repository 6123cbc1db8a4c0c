// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/surface/repair.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <numbers>
#include <random>

#include "tests/tools/real_surface.hpp"
#include "tests/tools/surface/small_meshes.hpp"

namespace souple {
namespace {

RepairedSurface repaired(const TriangleMesh& mesh, const RepairOptions& options = {}) {
  auto result = repair_surface(mesh, options);
  EXPECT_TRUE(result.ok()) << format_issue(result.issue());
  if (!result) return {};
  EXPECT_TRUE(check_closed_oriented_manifold(result->mesh).ok());
  EXPECT_GT(signed_volume(result->mesh), 0);
  return std::move(*result);
}

IssueCode refusal(const TriangleMesh& mesh, const RepairOptions& options = {}) {
  const auto result = repair_surface(mesh, options);
  return result ? IssueCode{} : result.issue().code;
}

bool did(const RepairedSurface& surface, std::string_view name) {
  return std::ranges::any_of(surface.report.actions,
                             [&](const RepairAction& a) { return a.name == name && a.count > 0; });
}

std::vector<Point> sorted(std::vector<Point> points) {
  std::ranges::sort(points);
  return points;
}

TriangleMesh imported(const std::string& name) {
  auto surface = import_surface(real_surface_dir() / name, {});
  EXPECT_TRUE(surface.ok()) << name << ": " << format_issue(surface.issue());
  return surface ? std::move(surface->mesh) : TriangleMesh{};
}

TEST(Repair, LeavesAGoodSurfaceExactlyAsItIs) {
  const RepairedSurface same = repaired(cube(1));
  EXPECT_EQ(same.mesh.triangles.size(), 12u);
  EXPECT_EQ(sorted(same.mesh.vertices), sorted(cube(1).vertices));
  EXPECT_TRUE(same.report.actions.empty());
  EXPECT_EQ(same.report.moved.hausdorff(), 0);
}

TEST(Repair, MergesTurnsFillsAndDropsWhatIsTwice) {
  EXPECT_TRUE(did(repaired(as_soup(cube(1))), "merge vertices"));
  TriangleMesh mesh = cube(1);
  std::swap(mesh.triangles[3][0], mesh.triangles[3][1]);
  EXPECT_NEAR(signed_volume(repaired(mesh).mesh), 8, 1e-9);
  mesh.triangles.push_back(mesh.triangles[0]);
  EXPECT_TRUE(did(repaired(mesh), "drop triangles"));
  const RepairedSurface filled = repaired(without_first(cube(1), 2));
  EXPECT_TRUE(did(filled, "fill holes"));
  EXPECT_FALSE(filled.report.wrapped);
  EXPECT_NEAR(signed_volume(filled.mesh), 8, 1e-9);
  EXPECT_LT(filled.report.moved.forth.largest, 1e-12);
  EXPECT_NEAR(filled.report.moved.back.largest, 1, 0.1);  // the middle of the lid
}

TEST(Repair, SewsTJunctionsAndGapsOfRounding) {
  // One side of the cube is split on one of its two triangles only.
  TriangleMesh mesh = cube(1);
  mesh.vertices.push_back({0, -1, -1});
  mesh.triangles.erase(mesh.triangles.begin() + 4);  // {0, 1, 5}
  mesh.triangles.insert(mesh.triangles.end(), {{0, 8, 5}, {8, 1, 5}});
  const RepairedSurface sewn = repaired(mesh);
  EXPECT_TRUE(did(sewn, "split T-junctions"));
  EXPECT_NEAR(signed_volume(sewn.mesh), 8, 1e-6);
  TriangleMesh soup = as_soup(cube(1));
  for (std::size_t i = 0; i < soup.vertices.size(); ++i)
    soup.vertices[i][i % 3] += 1e-7 * static_cast<double>(i % 5);
  const RepairedSurface merged = repaired(soup);
  EXPECT_TRUE(did(merged, "merge rims"));
  EXPECT_FALSE(merged.report.wrapped);
  EXPECT_NEAR(signed_volume(merged.mesh), 8, 1e-4);
}

TEST(Repair, DropsAStrayTriangle) {
  TriangleMesh stray{{{3, 0, 0}, {3.5, 0, 0}, {3, 0.5, 0}}, {{0, 1, 2}}};
  const RepairedSurface kept = repaired(join_meshes({cube(1), stray}));
  EXPECT_TRUE(did(kept, "drop scraps"));
  EXPECT_NEAR(signed_volume(kept.mesh), 8, 1e-6);
}

TEST(Repair, UnitesShellsThatCross) {
  const RepairedSurface united = repaired(join_meshes({cube(1), cube(1, {1, 0.9, 0.8})}));
  EXPECT_TRUE(did(united, "union"));
  EXPECT_EQ(united.report.orient.shell_count, 1u);
  EXPECT_NEAR(signed_volume(united.mesh), 16 - 1 * 1.1 * 1.2, 1e-6);
  EXPECT_EQ(united.report.after.self_intersection_count, 0u);
  // Touching at a wall.
  EXPECT_NEAR(signed_volume(repaired(join_meshes({cube(1), cube(0.5, {1.5, 0, 0})})).mesh), 9, 1e-6);
}

/// Of an axis-parallel box.
TriangleMesh box(const Point& low, const Point& high) {
  TriangleMesh mesh = cube(1);
  for (Point& p : mesh.vertices)
    for (std::size_t k = 0; k < 3; ++k) p[k] = p[k] < 0 ? low[k] : high[k];
  return mesh;
}

TEST(Repair, UnitesSolidsThatShareAWall) {
  const TriangleMesh one = cube(1), two = cube(1, {2, 0, 0}), three = cube(1, {4, 0, 0});
  const RepairedSurface both = repaired(join_meshes({one, two}));
  EXPECT_TRUE(did(both, "drop inner walls"));
  EXPECT_EQ(both.report.orient.shell_count, 1u);
  EXPECT_EQ(both.mesh.triangles.size(), 20u);
  EXPECT_NEAR(signed_volume(both.mesh), 16, 1e-9);
  EXPECT_NEAR(both.report.moved.forth.largest, 1, 0.1);  // the middle of the wall that is gone
  for (const TriangleMesh& row : {join_meshes({one, two, three}), join_meshes({two, one, three}),
                                  turned(join_meshes({one, three, two}))}) {
    const RepairedSurface whole = repaired(row);
    EXPECT_EQ(whole.report.orient.shell_count, 1u);
    EXPECT_NEAR(signed_volume(whole.mesh), 24, 1e-9);
  }
  // The other diagonal of the wall; the wall of one a part of the other's.
  TriangleMesh crossed = cube(1, {2, 0, 0});
  crossed.triangles[8] = {0, 4, 2};
  crossed.triangles[9] = {4, 6, 2};
  EXPECT_NEAR(signed_volume(repaired(join_meshes({one, crossed})).mesh), 16, 1e-9);
  EXPECT_NEAR(signed_volume(repaired(join_meshes({one, box({1, -1, -1}, {2, 1, 0})})).mesh), 10, 1e-6);
  // And far from the origin, in a soup of single precision.
  TriangleMesh soup = as_soup(join_meshes({cube(0.1, {10, 3, 7}), cube(0.1, {10.2, 3, 7})}));
  for (Point& p : soup.vertices)
    for (double& x : p) x = static_cast<float>(x);
  const RepairedSurface far = repaired(soup);
  EXPECT_EQ(far.report.orient.shell_count, 1u);
  EXPECT_NEAR(signed_volume(far.mesh), 0.016, 1e-7);
}

TEST(Repair, KeepsTheRoomBetweenSlabsThatShareWalls) {
  // Six slabs round a room of side 2: each edge of the room belongs to two slabs that share a wall.
  const RepairedSurface house = repaired(join_meshes(
      {box({-2, -2, -2}, {2, 2, -1}), box({-2, -2, 1}, {2, 2, 2}), box({-2, -2, -1}, {2, -1, 1}),
       box({-2, 1, -1}, {2, 2, 1}), box({-2, -1, -1}, {-1, 1, 1}), box({1, -1, -1}, {2, 1, 1})}));
  EXPECT_FALSE(house.report.wrapped);
  EXPECT_EQ(house.report.orient.shell_count, 2u);
  EXPECT_NEAR(signed_volume(house.mesh), 64 - 8, 1e-6);
}

TEST(Repair, KeepsCavitiesAndSeparateShells) {
  const RepairedSurface hollow = repaired(join_meshes({cube(1), cube(0.5)}));
  EXPECT_NEAR(signed_volume(hollow.mesh), 8 - 1, 1e-9);
  EXPECT_EQ(hollow.report.orient.shell_count, 2u);
  const RepairedSurface two = repaired(join_meshes({cube(1), cube(1, {5, 0, 0})}));
  EXPECT_NEAR(signed_volume(two.mesh), 16, 1e-9);
  EXPECT_EQ(two.report.orient.shell_count, 2u);
}

TEST(Repair, DrawsBackPartsThatTouchAlongAnEdge) {
  const RepairedSurface apart = repaired(join_meshes({cube(1), cube(1, {2, 2, 0})}));
  EXPECT_FALSE(apart.report.wrapped);
  EXPECT_TRUE(did(apart, "pull apart"));
  EXPECT_EQ(apart.report.after.nonmanifold_edge_count, 0u);
  EXPECT_NEAR(signed_volume(apart.mesh), 16, 0.02);
  EXPECT_LT(apart.report.moved.hausdorff(), 1e-3);
}

TEST(Repair, RefusesWhatEnclosesNothing) {
  const TriangleMesh one{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}};
  EXPECT_EQ(refusal(one), IssueCode::surface_hopeless);
  TriangleMesh bad = cube(1);
  bad.triangles[0][0] = -1;
  EXPECT_EQ(refusal(bad), IssueCode::surface_invalid);
  EXPECT_EQ(refusal({}), IssueCode::surface_no_triangles);
  EXPECT_EQ(refusal(cube(1), {RepairMode::automatic, -1}), IssueCode::usage_bad_value);
  EXPECT_EQ(refusal(cube(1), {RepairMode::automatic, std::numeric_limits<double>::quiet_NaN()}),
            IssueCode::usage_bad_value);
  EXPECT_EQ(refusal(without_first(cube(1), 2), {RepairMode::off, 0}), IssueCode::surface_not_closed);
}

TEST(Repair, WrapsOnRequestNearTheSurfaceAndWithoutADoubleSkin) {
  const RepairedSurface wrapped = repaired(cube(1), {RepairMode::wrap, 0.05});
  EXPECT_TRUE(wrapped.report.wrapped);
  EXPECT_LT(wrapped.report.moved.hausdorff(), 0.05);
  EXPECT_NEAR(signed_volume(wrapped.mesh), 8, 0.5);
  // Six walls with gaps between them, wider than fine alphas: the inside must stay inside.
  TriangleMesh walls = as_soup(cube(1));
  for (std::size_t i = 0; i < walls.vertices.size(); ++i) {
    const std::size_t axis = i / 12;  // of the two walls that the 6 triangles belong to
    for (std::size_t k = 0; k < 3; ++k)
      if (std::abs(walls.vertices[i][k]) > 0.5 && k == (2 - axis)) walls.vertices[i][k] *= 1.06;
  }
  const RepairedSurface closed = repaired(walls);
  EXPECT_GT(signed_volume(closed.mesh), 6.5);
  EXPECT_LT(signed_volume(closed.mesh), 11);
}

TEST(Repair, GivesTheSameInMillimetresInMetresAndFarAway) {
  SOUPLE_NEEDS_REAL_SURFACES();
  for (const char* name : {"liver-smooth.obj", "spider.obj"}) {
    const TriangleMesh surface = imported(name);
    const RepairedSurface base = repaired(surface);
    const double size = longest_side(bounding_box(surface.vertices));
    struct Placement {
      double scale, offset;
    };
    for (const auto& [scale, offset] : {Placement{1e-3, 0}, Placement{1, 1000}, Placement{1e3, 1e4}}) {
      TriangleMesh placed = surface;
      const Point shift{offset * size, -offset * size, offset * size};
      for (Point& p : placed.vertices) p = scaled(add(p, shift), scale);
      const RepairedSurface other = repaired(placed);
      ASSERT_EQ(other.mesh.triangles, base.mesh.triangles) << name << " " << scale << " " << offset;
      double worst = 0;
      for (std::size_t i = 0; i < base.mesh.vertices.size(); ++i)
        worst = std::max(worst, norm(subtract(scaled(other.mesh.vertices[i], 1 / scale),
                                              add(base.mesh.vertices[i], shift))));
      EXPECT_LT(worst, 1e-6 * size) << name << " " << scale << " " << offset;
    }
  }
}

TEST(Repair, RemovesSelfIntersectionsWithoutMovingTheRest) {
  SOUPLE_NEEDS_REAL_SURFACES();
  for (const char* name : {"liver-smooth.obj", "camel.off"}) {
    const TriangleMesh surface = imported(name);
    const RepairedSurface clean = repaired(surface);
    EXPECT_FALSE(clean.report.wrapped) << name;
    EXPECT_EQ(clean.report.after.self_intersection_count, 0u) << name;
    EXPECT_EQ(clean.report.after.grade, SurfaceGrade::good) << name;
    EXPECT_NEAR(signed_volume(clean.mesh) / signed_volume(surface), 1, 1e-3) << name;
    const std::vector<Point> known = sorted(surface.vertices);
    const auto kept = std::ranges::count_if(
        clean.mesh.vertices, [&](const Point& p) { return std::ranges::binary_search(known, p); });
    EXPECT_GT(static_cast<double>(kept), 0.99 * static_cast<double>(surface.vertices.size())) << name;
  }
}

TEST(Repair, MakesSolidsOfDirtyRealFiles) {
  SOUPLE_NEEDS_REAL_SURFACES();
  struct Case {
    const char* name;
    double low, high;  ///< volume in units of the file
  };
  for (const Case& c :
       {Case{"open_cube.off", 0.99e6, 1.01e6}, Case{"two_spheres.obj", 0.85, 0.9},
        Case{"sphereWithHole.stl", 13, 14.2}, Case{"funnel.obj", 0.0018, 0.0025},
        Case{"bones.off", 18, 18.7}, Case{"two-cubes-intersecting.ply", 1.6, 1.92},
        Case{"test1.3ds", 400, 502}, Case{"simple_pole.glb", 43, 48.7},
        Case{"elephant-with-holes.off", 0.044, 0.048}, Case{"monkey.glb", 2, 2.4},
        Case{"fuze_ascii.ply", 0.0005, 0.0007}, Case{"articulation4O.obj", 22, 25},
        Case{"tetra_intersected_by_triangle.off", 0.2, 0.25}, Case{"shared.STL", 1.99, 2.01}}) {
    const RepairedSurface solid = repaired(imported(c.name));
    EXPECT_GT(signed_volume(solid.mesh), c.low) << c.name;
    EXPECT_LT(signed_volume(solid.mesh), c.high) << c.name;
    EXPECT_EQ(solid.report.after.self_intersection_count, 0u) << c.name;
    EXPECT_FALSE(solid.report.actions.empty() && solid.report.before.grade != SurfaceGrade::good)
        << c.name;
  }
}

TEST(Repair, RefusesFlatRealFiles) {
  SOUPLE_NEEDS_REAL_SURFACES();
  for (const char* name :
       {"测试模型.off", "concave_polygon.obj", "quads_to_stitch.off", "degtri_sliding.off",
        "mesh_with_colors.off", "overlapping_triangles.off", "soup.stl"})
    EXPECT_EQ(refusal(imported(name)), IssueCode::surface_hopeless) << name;
}

TEST(Repair, WrapsRealFilesThatCannotBeMended) {
  SOUPLE_NEEDS_REAL_SURFACES();
  const RepairedSurface wrapped = repaired(imported("dragon.stl"));
  EXPECT_TRUE(wrapped.report.wrapped);
  EXPECT_NEAR(signed_volume(wrapped.mesh) / 607.8, 1, 0.12);
  EXPECT_EQ(wrapped.report.after.grade, SurfaceGrade::good);
  EXPECT_EQ(refusal(imported("mask_cone.off"), {RepairMode::mend, 0}), IssueCode::surface_not_closed);
}

TEST(Repair, ClosesWideFlatHoles) {
  constexpr Index sides = 300;  // too many for the full search over all patches
  TriangleMesh pipe;
  for (Index i = 0; i < sides; ++i) {
    const double angle = 2 * std::numbers::pi * i / sides;
    for (const double z : {-1.0, 1.0}) pipe.vertices.push_back({std::cos(angle), std::sin(angle), z});
    const Index j = (i + 1) % sides;
    pipe.triangles.push_back({2 * i, 2 * j, 2 * j + 1});
    pipe.triangles.push_back({2 * i, 2 * j + 1, 2 * i + 1});
  }
  const RepairedSurface rod = repaired(pipe);
  EXPECT_TRUE(did(rod, "fill holes"));
  EXPECT_FALSE(rod.report.wrapped);
  EXPECT_EQ(rod.report.after.self_intersection_count, 0u);
  EXPECT_NEAR(signed_volume(rod.mesh), sides * std::sin(2 * std::numbers::pi / sides), 1e-6);
}

/// Allocates and frees at random: whatever depends on addresses finds others afterwards. The blocks
/// that stay are returned.
std::vector<std::unique_ptr<char[]>> litter_the_heap(std::size_t count, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::vector<std::unique_ptr<char[]>> blocks;
  for (std::size_t i = 0; i < count; ++i) {
    blocks.push_back(std::make_unique<char[]>(8 + random() % 900));
    if (random() % 2 == 0) blocks[random() % blocks.size()].reset();
  }
  return blocks;
}

TEST(Repair, GivesTheSameBytesWhateverTheHeapLooksLike) {
  SOUPLE_NEEDS_REAL_SURFACES();
  for (const char* name :
       {"chair_model.obj", "self_intersectA.obj", "two_spheres.obj", "bones.off", "test1.3ds",
        "spider.obj", "simple_pole.glb", "camel.off", "elephant-with-holes.off", "shared.STL"}) {
    const TriangleMesh surface = imported(name);
    const RepairedSurface first = repaired(surface);
    for (const std::uint32_t seed : {1U, 2U}) {
      const auto litter = litter_the_heap(200'000 * seed, seed);
      const RepairedSurface again = repaired(surface);
      EXPECT_EQ(again.mesh.vertices, first.mesh.vertices) << name << " " << seed;
      EXPECT_EQ(again.mesh.triangles, first.mesh.triangles) << name << " " << seed;
    }
  }
}

}  // namespace
}  // namespace souple
