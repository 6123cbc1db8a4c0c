// SPDX-License-Identifier: GPL-3.0-or-later
// Sizes, sharp edges and attitudes: what the options of tetrahedralize promise.
#include <cmath>

#include "tests/tools/volume/sound_volume.hpp"
#include "tools/geometry/vector.hpp"

namespace souple {
namespace {

/// Mean edge of the tets whose barycentre satisfies `where`.
template <class Where>
double mean_edge(const TetMesh& mesh, const Where& where) {
  double sum = 0;
  std::size_t count = 0;
  for (const Tet& tet : mesh.tets) {
    const auto x = [&](std::size_t k) { return mesh.nodes[static_cast<std::size_t>(tet[k])]; };
    if (!where(scaled(add(add(x(0), x(1)), add(x(2), x(3))), 0.25))) continue;
    for (std::size_t a = 0; a < 4; ++a)
      for (std::size_t b = a + 1; b < 4; ++b) sum += norm(subtract(x(a), x(b)));
    count += 6;
  }
  return sum / static_cast<double>(count);
}

TEST(LocalSize, RefinesABallAndLeavesTheRest) {
  SOUPLE_NEEDS_REAL_SURFACES();
  const TriangleMesh surface = closed_real_surface("ballA.off");
  const Box box = bounding_box(surface.vertices);
  const Point middle = scaled(add(box.low, box.high), 0.5);
  TetrahedralizeOptions options = of_edge(0.03);
  const auto plain = tetrahedralize(surface, options);
  const BallRegion ball{add(middle, {0.09, 0, 0}), 0.02};
  options.local_sizes.push_back({0.006, ball});
  const auto local = tetrahedralize(surface, options);
  ASSERT_TRUE(plain.ok() && local.ok());
  const auto near = [&](const Point& p) { return norm(subtract(p, ball.centre)) < ball.radius_m; };
  const auto far = [&](const Point& p) { return norm(subtract(p, ball.centre)) > 0.11; };
  EXPECT_NEAR(mean_edge(local->mesh, near) / 0.006, 1, 0.25);
  EXPECT_NEAR(mean_edge(local->mesh, far) / mean_edge(plain->mesh, far), 1, 0.2);
}

TEST(LocalSize, RefinesABoxAndAroundAPatch) {
  SOUPLE_NEEDS_REAL_SURFACES();
  const TriangleMesh surface = closed_real_surface("ballA.off");
  const Box box = bounding_box(surface.vertices);
  const Point middle = scaled(add(box.low, box.high), 0.5);
  TriangleMesh patch = surface;
  patch.triangles.resize(1);
  const Point at = patch.vertices[static_cast<std::size_t>(patch.triangles[0][0])];
  TetrahedralizeOptions options = of_edge(0.03);
  options.local_sizes.push_back({0.008, BoxRegion{box.low, {middle[0], box.high[1], box.high[2]}}});
  const auto half = tetrahedralize(surface, options);
  options.local_sizes = {{0.006, PatchRegion{patch, 0.01}}};
  const auto touched = tetrahedralize(surface, options);
  ASSERT_TRUE(half.ok() && touched.ok());
  const auto left = [&](const Point& p) { return p[0] < middle[0]; };
  EXPECT_NEAR(mean_edge(half->mesh, left) / 0.008, 1, 0.25);
  const auto near = [&](const Point& p) { return norm(subtract(p, at)) < 0.01; };
  EXPECT_NEAR(mean_edge(touched->mesh, near) / 0.006, 1, 0.3);
}

TEST(LocalSize, StillMeetsTheCount) {
  SOUPLE_NEEDS_REAL_SURFACES();
  const TriangleMesh surface = closed_real_surface("liver-smooth.obj");
  TetrahedralizeOptions options = of_count(6000);
  options.local_sizes.push_back({0.006, BallRegion{surface.vertices[0], 0.015}});
  options.interior_coarsening = 2;
  const auto volume = tetrahedralize(surface, options);
  ASSERT_TRUE(volume.ok()) << format_issue(volume.issue());
  EXPECT_NEAR(static_cast<double>(volume->mesh.tets.size()) / 6000, 1, 0.15);
}

TEST(InteriorCoarsening, MakesTheDepthsCoarserThanTheSurface) {
  SOUPLE_NEEDS_REAL_SURFACES();
  const TriangleMesh surface = closed_real_surface("ballA.off");
  const Box box = bounding_box(surface.vertices);
  const Point middle = scaled(add(box.low, box.high), 0.5);
  TetrahedralizeOptions options = of_edge(0.008);
  options.interior_coarsening = 3;
  const auto volume = tetrahedralize(surface, options);
  ASSERT_TRUE(volume.ok());
  const auto deep = [&](const Point& p) { return norm(subtract(p, middle)) < 0.04; };
  const auto outer = [&](const Point& p) { return norm(subtract(p, middle)) > 0.09; };
  const double ratio = mean_edge(volume->mesh, deep) / mean_edge(volume->mesh, outer);
  EXPECT_GT(ratio, 1.8);
  EXPECT_LT(ratio, 3.3);
  EXPECT_GE(volume->report.quality.min_dihedral_deg, 10);
}

TEST(MaxError, BoundsTheMeasuredDistance) {
  SOUPLE_NEEDS_REAL_SURFACES();
  const TriangleMesh surface = closed_real_surface("blobby.off");
  for (const double error : {0.004, 0.001}) {
    TetrahedralizeOptions options;
    options.max_error_m = error;
    const auto volume = tetrahedralize(surface, options);
    ASSERT_TRUE(volume.ok());
    const TriangleMesh boundary{volume->mesh.nodes, boundary_triangles(volume->mesh.tets)};
    std::vector<Point> outer;
    for (const Index i : used_nodes(boundary.triangles))
      outer.push_back(boundary.vertices[static_cast<std::size_t>(i)]);
    EXPECT_LE(distance_from_surface(outer, TriangleBvh(surface)).largest, error);
    EXPECT_LE(distance_from_surface(sample_surface(surface), TriangleBvh(boundary)).largest, error);
  }
}

TEST(SharpEdges, OfAMachinePartCarryNodes) {
  SOUPLE_NEEDS_REAL_SURFACES();
  for (const char* name : {"cube4-shuffled.off", "anchor.off"}) {
    const TriangleMesh surface = closed_real_surface(name);
    const auto kept = tetrahedralize(surface, of_count(10'000));
    ASSERT_TRUE(kept.ok());
    EXPECT_TRUE(kept->report.features.kept) << name << ": " << kept->report.features.reason;
    EXPECT_GE(kept->report.quality.min_dihedral_deg, 5) << name;
    EXPECT_LT(kept->report.quality.worst_aspect, 20) << name;
    EXPECT_NEAR(kept->report.quality.volume_m3 / signed_volume(surface), 1, 0.003) << name;
    // Sharp corners cut off would leave the surface's vertices away from the mesh.
    const TriangleMesh boundary{kept->mesh.nodes, boundary_triangles(kept->mesh.tets)};
    EXPECT_LT(distance_from_surface(surface.vertices, TriangleBvh(boundary)).largest, 0.004 * 0.2)
        << name;
  }
}

TEST(SharpEdges, OfOrgansAndAnimalsAreNotKept) {
  SOUPLE_NEEDS_REAL_SURFACES();
  for (const char* name :
       {"liver-smooth.obj", "liver.obj", "bunny_10k.obj", "dino.off", "elephant.off"}) {
    const auto volume = tetrahedralize(closed_real_surface(name), of_count(1'500));
    ASSERT_TRUE(volume.ok()) << name;
    EXPECT_FALSE(volume->report.features.kept) << name;
    EXPECT_GT(volume->report.features.sharp_edge_count, 0u) << name;
    EXPECT_FALSE(volume->report.features.reason.empty()) << name;
  }
}

TEST(SharpEdges, AreKeptOrIgnoredWhenAskedFor) {
  SOUPLE_NEEDS_REAL_SURFACES();
  const TriangleMesh cube = closed_real_surface("cube4-shuffled.off");
  TetrahedralizeOptions options = of_count(2'000);
  options.features = FeatureMode::ignore;
  const auto ignored = tetrahedralize(cube, options);
  options.features = FeatureMode::keep;
  const auto kept = tetrahedralize(cube, options);
  ASSERT_TRUE(ignored.ok() && kept.ok());
  EXPECT_FALSE(ignored->report.features.kept);
  EXPECT_TRUE(kept->report.features.kept);
  EXPECT_NEAR(kept->report.quality.volume_m3 / signed_volume(cube), 1, 1e-6);
  EXPECT_LT(ignored->report.quality.volume_m3 / signed_volume(cube), 1 - 1e-4);
}

Point turned(const Point& p) {
  // By 0.7 about z, then by 1.1 about x.
  const Point q{std::cos(0.7) * p[0] - std::sin(0.7) * p[1],
                std::sin(0.7) * p[0] + std::cos(0.7) * p[1], p[2]};
  return {q[0], std::cos(1.1) * q[1] - std::sin(1.1) * q[2],
          std::sin(1.1) * q[1] + std::cos(1.1) * q[2]};
}

TEST(Invariance, OfATurnedBody) {
  SOUPLE_NEEDS_REAL_SURFACES();
  for (const char* name : {"liver-smooth.obj", "bunny_10k.obj", "dino.off", "ballA.off"}) {
    const TriangleMesh surface = closed_real_surface(name);
    TriangleMesh other = surface;
    for (Point& p : other.vertices) p = turned(p);
    const auto here = tetrahedralize(surface, of_count(5'000)),
               there = tetrahedralize(other, of_count(5'000));
    ASSERT_TRUE(here.ok() && there.ok());
    const auto ratio = [](double a, double b) { return a / b; };
    EXPECT_NEAR(ratio(static_cast<double>(there->mesh.tets.size()),
                      static_cast<double>(here->mesh.tets.size())),
                1, 0.02)
        << name;
    const TetQuality &a = here->report.quality, &b = there->report.quality;
    EXPECT_NEAR(ratio(b.min_dihedral_deg, a.min_dihedral_deg), 1, 0.1) << name;
    EXPECT_NEAR(ratio(b.median_dihedral_deg, a.median_dihedral_deg), 1, 0.1) << name;
  }
}

TEST(Invariance, OfABodyFarAway) {
  SOUPLE_NEEDS_REAL_SURFACES();
  const TriangleMesh surface = closed_real_surface("liver-smooth.obj");
  const Point away{150, -70, 30};
  TriangleMesh other = surface;
  for (Point& p : other.vertices) p = add(p, away);
  const auto here = tetrahedralize(surface, of_count(5'000)),
             there = tetrahedralize(other, of_count(5'000));
  ASSERT_TRUE(here.ok() && there.ok());
  ASSERT_EQ(here->mesh.tets, there->mesh.tets);
  for (std::size_t i = 0; i < here->mesh.nodes.size(); ++i)
    ASSERT_LT(norm(subtract(add(here->mesh.nodes[i], away), there->mesh.nodes[i])), 1e-6 * 0.2);
}

TEST(SizeOptions, AreRefusedOutOfRange) {
  SOUPLE_NEEDS_REAL_SURFACES();
  const TriangleMesh surface = closed_real_surface("liver.obj");
  const double nan = std::nan("");
  const auto refused = [&](const TetrahedralizeOptions& options) {
    const auto volume = tetrahedralize(surface, options);
    return !volume.ok() && volume.issue().code == IssueCode::usage_bad_value;
  };
  for (const double bad : {0.5, -1.0, nan, HUGE_VAL}) {
    TetrahedralizeOptions options = of_count(1000);
    options.interior_coarsening = bad;
    EXPECT_TRUE(refused(options)) << bad;
  }
  for (const double bad : {-1.0, nan, HUGE_VAL, 1e-12}) {
    TetrahedralizeOptions options;
    options.max_error_m = bad;
    EXPECT_TRUE(refused(options)) << bad;
  }
  for (const LocalSize& bad :
       {LocalSize{0, BallRegion{{}, 1}}, LocalSize{0.01, BallRegion{{}, -1}},
        LocalSize{0.01, BallRegion{{nan, 0, 0}, 1}}, LocalSize{0.01, BoxRegion{{1, 0, 0}, {0, 1, 1}}},
        LocalSize{nan, BoxRegion{{0, 0, 0}, {1, 1, 1}}}}) {
    TetrahedralizeOptions options = of_count(1000);
    options.local_sizes.push_back(bad);
    EXPECT_TRUE(refused(options));
  }
}

}  // namespace
}  // namespace souple
