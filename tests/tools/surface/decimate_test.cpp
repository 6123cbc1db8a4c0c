// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/surface/decimate.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/tools/real_surface.hpp"
#include "tools/geometry/surface_measure.hpp"
#include "tools/geometry/unit_frame.hpp"
#include "tools/geometry/vector.hpp"
#include "tools/surface/repair.hpp"
#include "tools/surface/self_intersections.hpp"

namespace souple {
namespace {

TEST(Decimate, KeepsRealShapesClosedAndTheirVolume) {
  SOUPLE_NEEDS_REAL_SURFACES();
  for (const char* name :
       {"liver-smooth.obj", "dino.off", "bunny_10k.obj", "anchor.off", "knot2.off"}) {
    TriangleMesh surface = closed_real_surface(name);
    // On the grid beforehand: what is measured is what the collapse does to the volume.
    const UnitFrame frame = UnitFrame::along_axes_of(surface);
    surface.vertices = frame.to_metres(frame.to_unit(surface.vertices));
    const auto decimated = decimate_surface(surface, {2000});
    ASSERT_TRUE(decimated.ok()) << name << ": " << format_issue(decimated.issue());
    EXPECT_TRUE(check_closed_oriented_manifold(decimated->mesh).ok()) << name;
    EXPECT_LE(decimated->mesh.triangles.size(), 2000u) << name;
    EXPECT_GE(decimated->mesh.triangles.size(), std::min<std::size_t>(surface.triangles.size(), 1980))
        << name;
    const DecimateReport& report = decimated->report;
    EXPECT_EQ(report.face_count_before, surface.triangles.size());
    EXPECT_NEAR(report.volume_after_m3 / report.volume_before_m3, 1, 1e-9) << name;
    EXPECT_LT(report.hausdorff_m, 0.015 * 0.2) << name;
  }
}

TEST(Decimate, ReturnsASmallerInputAsItIs) {
  SOUPLE_NEEDS_REAL_SURFACES();
  const TriangleMesh surface = closed_real_surface("liver.obj");
  const auto decimated = decimate_surface(surface, {100'000});
  ASSERT_TRUE(decimated.ok());
  EXPECT_EQ(decimated->mesh.vertices, surface.vertices);
  EXPECT_EQ(decimated->mesh.triangles, surface.triangles);
  EXPECT_EQ(decimated->report.hausdorff_m, 0);
}

TEST(Decimate, GivesTheSameBytesTwiceAndTheSameShapeInAnyUnit) {
  SOUPLE_NEEDS_REAL_SURFACES();
  const TriangleMesh surface = closed_real_surface("liver-smooth.obj");
  const auto a = decimate_surface(surface, {500});
  const auto b = decimate_surface(surface, {500});
  TriangleMesh large = surface;
  for (Point& p : large.vertices) p = scaled(p, 1024);
  const auto c = decimate_surface(large, {500});
  ASSERT_TRUE(a.ok() && b.ok() && c.ok());
  EXPECT_EQ(a->mesh.vertices, b->mesh.vertices);
  EXPECT_EQ(a->mesh.triangles, b->mesh.triangles);
  EXPECT_EQ(a->mesh.triangles, c->mesh.triangles);
}

TEST(Decimate, LeavesNoSelfIntersectionsOnRealData) {
  SOUPLE_NEEDS_REAL_SURFACES();
  for (const char* name : {"camel.off", "spider.obj", "elephant-with-holes.off", "monkey.glb"}) {
    const auto imported = import_surface(real_surface_dir() / name, {});
    ASSERT_TRUE(imported.ok()) << name;
    const auto repaired = repair_surface(imported->mesh, {});
    ASSERT_TRUE(repaired.ok()) << name;
    for (const std::size_t faces : {1500, 600}) {
      const auto decimated = decimate_surface(repaired->mesh, {faces, 0});
      ASSERT_TRUE(decimated.ok()) << name << ": " << format_issue(decimated.issue());
      EXPECT_TRUE(find_self_intersections(decimated->mesh).pairs.empty()) << name << " " << faces;
      EXPECT_EQ(decimated->report.self_intersection_count, 0u) << name;
      EXPECT_NEAR(decimated->report.volume_after_m3 / decimated->report.volume_before_m3, 1, 0.02)
          << name;
      EXPECT_TRUE(decimated->mesh.triangles.size() <= faces || !decimated->report.notes.empty())
          << name;
    }
  }
}

TEST(Decimate, StaysWithinAnErrorBoundBothWays) {
  SOUPLE_NEEDS_REAL_SURFACES();
  const TriangleMesh surface = closed_real_surface("bunny_10k.obj");
  std::size_t last = surface.triangles.size();
  for (const double bound : {0.0005, 0.002}) {
    const auto decimated = decimate_surface(surface, {0, bound});
    ASSERT_TRUE(decimated.ok()) << format_issue(decimated.issue());
    EXPECT_LE(decimated->report.hausdorff_m, bound * 1.001);
    EXPECT_LT(decimated->mesh.triangles.size(), last);
    last = decimated->mesh.triangles.size();
  }
  EXPECT_LT(last, 4000u);
  EXPECT_EQ(decimate_surface(surface, {0, 0}).issue().code, IssueCode::usage_bad_value);
  EXPECT_EQ(decimate_surface(surface, {100, -1}).issue().code, IssueCode::usage_bad_value);
}

TEST(Decimate, RefusesOpenSurfacesAndImpossibleTargets) {
  SOUPLE_NEEDS_REAL_SURFACES();
  const auto open = import_surface(real_surface_dir() / "open_cube.off", {});
  EXPECT_EQ(decimate_surface(open->mesh, {6}).issue().code, IssueCode::surface_not_closed);
  const auto shuffled = import_surface(real_surface_dir() / "blobby-shuffled.off", {});
  EXPECT_EQ(decimate_surface(shuffled->mesh, {600}).issue().code, IssueCode::surface_not_orientable);
  const TriangleMesh liver = closed_real_surface("liver.obj");
  EXPECT_EQ(decimate_surface(liver, {3}).issue().code, IssueCode::usage_bad_value);
  const TriangleMesh anchor = closed_real_surface("anchor.off");
  EXPECT_EQ(decimate_surface(anchor, {4}).issue().code, IssueCode::decimation_failed);
}

}  // namespace
}  // namespace souple
