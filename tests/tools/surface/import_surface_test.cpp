// SPDX-License-Identifier: GPL-3.0-or-later
// The real files, against counts and volumes that other programs measured of them.
#include "tools/surface/import_surface.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <map>

#include "tests/tools/real_surface.hpp"
#include "tools/geometry/surface_measure.hpp"
#include "tools/geometry/vector.hpp"

namespace souple {
namespace {

/// Files that have to be refused, and why.
const std::map<std::string, IssueCode> refused{
    {"BoxWithInfinites.glb", IssueCode::surface_not_finite},
    {"IndexOutOfRange.bin", IssueCode::unsupported_surface_format},  // only the other file's buffer
    {"IndexOutOfRange.gltf", IssueCode::surface_bad_index},
    {"box_UTF16BE.obj", IssueCode::surface_text_encoding},
    {"empty.ply", IssueCode::surface_empty_file},
    {"invalid.off", IssueCode::surface_bad_index},
    {"malformed.obj", IssueCode::surface_bad_index}};

TEST(ImportSurface, EndsEveryRealFileAsASurfaceOrTheExpectedRefusal) {
  SOUPLE_NEEDS_REAL_SURFACES();
  for (const auto& entry : std::filesystem::directory_iterator(real_surface_dir())) {
    const std::string name = entry.path().filename().string();
    const auto surface = import_surface(entry.path(), {});
    const auto expected = refused.find(name);
    EXPECT_EQ(surface.ok(), expected == refused.end())
        << name << (surface ? "" : ": " + format_issue(surface.issue()));
    if (!surface && expected != refused.end()) {
      EXPECT_EQ(surface.issue().code, expected->second) << format_issue(surface.issue());
      EXPECT_NE(surface.issue().where.find(name), std::string::npos);
    }
    if (surface) {
      EXPECT_TRUE(check_triangle_mesh(surface->mesh).ok()) << name;
      EXPECT_EQ(surface->report.file_hash.size(), 32u);
      EXPECT_GT(longest_side(bounding_box(surface->mesh.vertices)), 0) << name;
    }
  }
}

struct Expected {
  const char* name;
  const char* format;
  std::size_t merged, raw, polygons;
  double volume;  ///< cubed units of the file; six digits
};

/// The volume of a surface that is open or not oriented depends on a reference point.
constexpr double not_defined = std::numeric_limits<double>::quiet_NaN();

void PrintTo(const Expected& e, std::ostream* out) { *out << e.name; }

class RealSurface : public ::testing::TestWithParam<Expected> {};

TEST_P(RealSurface, HasTheCountsAndTheVolumeOthersMeasured) {
  SOUPLE_NEEDS_REAL_SURFACES();
  const Expected& e = GetParam();
  const auto surface = import_surface(real_surface_dir() / e.name, {});
  ASSERT_TRUE(surface.ok()) << format_issue(surface.issue());
  EXPECT_EQ(surface->report.format, e.format);
  EXPECT_EQ(surface->report.merged_vertex_count, e.merged);
  EXPECT_EQ(surface->report.raw_vertex_count, e.raw);
  EXPECT_EQ(surface->report.raw_polygon_count, e.polygons);
  if (!std::isnan(e.volume)) {
    EXPECT_NEAR(signed_volume(surface->mesh), e.volume, 6e-6 * std::abs(e.volume));
  }
}

INSTANTIATE_TEST_SUITE_P(
    Files, RealSurface,
    ::testing::Values(Expected{"Bunny.stl", "stl", 1366, 8184, 2728, 218.324},
                      Expected{"Cray_left.obj", "obj", 292, 292, 576, 1.95686e12},
                      Expected{"Generic_Twin_7863.1.t0_left.obj", "obj", 110, 110, 212, 2911.38},
                      Expected{"SaladBowl.obj", "obj", 706, 706, 1408, 0.00871843},
                      Expected{"anchor.off", "off", 519, 519, 1050, 0.143428},
                      Expected{"aneurysm3D_1.off", "off", 7095, 7095, 14186, 1378.79},
                      Expected{"ballA.off", "off", 1900, 1900, 3796, 1401.11},
                      Expected{"blobby-shuffled.off", "off", 2027, 2027, 4050, not_defined},
                      Expected{"boeing.off", "off", 1264, 2741, 2564, not_defined},
                      Expected{"bones.off", "off", 2154, 2154, 4204, 18.6601},
                      Expected{"box_inside.obj", "obj", 8, 8, 12, -1000},
                      Expected{"bunny_10k.obj", "obj", 5002, 5002, 10000, 0.222823},
                      Expected{"c.obj", "obj", 352, 432, 900, 277.481},
                      Expected{"camel.off", "off", 9770, 9770, 19536, 0.0467557},
                      Expected{"cheese.off", "off", 8629, 8629, 17786, 0.000441185},
                      Expected{"collision_boules_V3.obj", "obj", 336, 336, 640, 330.598},
                      Expected{"comments.off", "off", 8, 8, 6, 12.3168},
                      Expected{"couplingdown.off", "off", 1841, 1841, 3714, 0.19066},
                      Expected{"cow.off", "off", 2903, 2904, 5804, 0.046964},
                      Expected{"cube_UTF8BOM.dae", "collada", 8, 24, 6, 1},
                      Expected{"cube_binary.ply", "ply", 8, 8, 12, 1},
                      Expected{"cylinder.obj", "obj", 482, 482, 512, 31.2145},
                      Expected{"dino.off", "off", 3916, 3916, 7828, 2.45664},
                      Expected{"dragon.stl", "stl", 1190, 7578, 2526, not_defined},
                      Expected{"elephant-with-holes.off", "off", 2733, 2798, 4463, not_defined},
                      Expected{"elephant.off", "off", 2775, 2775, 5558, 0.0462012},
                      Expected{"fels.3ds", "3ds", 386, 2304, 768, 37.2147},
                      Expected{"hole.off", "off", 20, 20, 28, 6094.77},
                      Expected{"huesitos.fbx", "fbx", 62, 256, 68, 1.5691e7},
                      Expected{"knot2.off", "off", 5760, 5760, 11520, 0.0487884},
                      Expected{"liver-smooth.obj", "obj", 2194, 2194, 4384, 39.2674},
                      Expected{"liver.obj", "obj", 181, 181, 274, 36.5685},
                      Expected{"malleus.obj", "obj", 1876, 1876, 3748, 10.5109},
                      Expected{"nancolor.obj", "obj", 8, 8, 12, 1},
                      Expected{"negative_indices.obj", "obj", 8, 8, 6, 8},
                      Expected{"monkey.glb", "gltf", 505, 1966, 968, not_defined},
                      Expected{"nested.glb", "gltf", 24, 72, 36, 0.898779},
                      Expected{"plate_holes.STL", "stl", 618, 3756, 1252, 767362},
                      Expected{"pyramid.glb", "gltf", 1533, 1959, 3062, 0.00985843},
                      Expected{"regr01.dae", "collada", 199, 516, 172, 5.41833e-7},
                      Expected{"round.stl", "stl", 560, 3360, 1120, 277.915},
                      Expected{"simple_pole.glb", "gltf", 312, 936, 580, 48.6755},
                      Expected{"sphere.dae", "collada", 382, 1560, 400, 4.09487e-6},
                      Expected{"sphereWithHole.stl", "stl", 146, 855, 285, not_defined},
                      Expected{"spider.fbx", "fbx", 722, 4104, 1368, not_defined},
                      Expected{"spider.obj", "obj", 722, 762, 1368, not_defined},
                      Expected{"test1.3ds", "3ds", 72, 324, 108, 501.433},
                      Expected{"torus.obj", "obj", 800, 800, 1600, 8.74524},
                      Expected{"torus1.obj", "obj", 2048, 2048, 2048, 39.1623},
                      Expected{"truthCylinder-Deformed.obj", "obj", 1722, 1839, 3440, 0.000198754},
                      Expected{"two-cubes-intersecting.ply", "ply", 262, 262, 480, 1.91966},
                      Expected{"two_objects_mixed_case_names.stl", "stl", 16, 72, 24, 2},
                      Expected{"wallhole.obj", "obj", 35, 92, 13, 1066.67}));

TEST(ImportSurface, TurnsTheWindingOfMirroredNodesBack) {
  SOUPLE_NEEDS_REAL_SURFACES();
  const auto surface = import_surface(real_surface_dir() / "cubes_with_mirroring_and_pivot.fbx", {});
  ASSERT_TRUE(surface.ok());
  // Three cubes of side 0.1, two of them mirrored, and a hollow one. With the mirrored windings left as
  // they are, the sum would be negative.
  const auto& mesh = surface->mesh;
  const std::vector<Index> shells = shell_of_triangles(mesh.triangles, mesh.vertices.size());
  std::map<Index, TriangleMesh> parts;
  for (std::size_t t = 0; t < shells.size(); ++t) {
    parts[shells[t]].vertices = mesh.vertices;
    parts[shells[t]].triangles.push_back(mesh.triangles[t]);
  }
  EXPECT_EQ(parts.size(), 5u);
  std::size_t cubes = 0;
  for (const auto& [shell, part] : parts) cubes += std::abs(signed_volume(part) - 1e-3) < 1e-9;
  EXPECT_EQ(cubes, 3u);
  EXPECT_NEAR(signed_volume(mesh), 3e-3 + 0.000939632 - 0.000463412, 1e-9);
}

TEST(ImportSurface, CoversAConcavePolygonOnceAndNothingElse) {
  SOUPLE_NEEDS_REAL_SURFACES();
  const auto surface = import_surface(real_surface_dir() / "concave_polygon.obj", {});
  ASSERT_TRUE(surface.ok());
  // A flat polygon is covered once when the areas of its triangles sum to the length of its area
  // vector.
  Point twice{};
  for (const Triangle& t : surface->mesh.triangles) {
    const auto x = [&](std::size_t k) {
      return surface->mesh.vertices[static_cast<std::size_t>(t[k])];
    };
    twice = add(twice, cross(subtract(x(1), x(0)), subtract(x(2), x(0))));
  }
  EXPECT_NEAR(surface_area(surface->mesh), norm(twice) / 2, 1e-12);
  EXPECT_EQ(surface->report.dropped_triangle_count, 0u);
  EXPECT_EQ(surface->mesh.triangles.size(), 64u);  // 66 corners, the seam of its hole counted twice
}

TEST(ImportSurface, ScalesByUnitAndBySize) {
  SOUPLE_NEEDS_REAL_SURFACES();
  const auto file = real_surface_dir() / "box_inside.obj";
  const std::map<std::string, double> units{{"m", 1},     {"cm", 1e-2},   {"mm", 1e-3},  {"um", 1e-6},
                                            {"km", 1000}, {"in", 0.0254}, {"ft", 0.3048}};
  for (const auto& [unit, metres] : units) {
    ImportOptions options;
    options.unit = unit;
    const auto surface = import_surface(file, options);
    ASSERT_TRUE(surface.ok()) << unit;
    EXPECT_DOUBLE_EQ(surface->report.scale, metres) << unit;
    EXPECT_DOUBLE_EQ(surface->report.box_max[0], 5 * metres) << unit;
  }
  ImportOptions options;
  options.unit = "mm";
  options.size_m = 0.2;
  const auto surface = import_surface(file, options);
  ASSERT_TRUE(surface.ok());
  EXPECT_NEAR(longest_side({surface->report.box_min, surface->report.box_max}), 0.2, 1e-15);
  EXPECT_NEAR(surface->report.scale, 0.02, 1e-15);
}

TEST(ImportSurface, RefusesOptionsOutOfRange) {
  const double nan = std::nan(""), inf = HUGE_VAL;
  const auto code = [](const ImportOptions& options) {
    const auto surface = import_surface("anything.obj", options);
    return surface.ok() ? IssueCode{} : surface.issue().code;
  };
  for (const char* unit : {"", "M", "metre", "mm ", "parsec"})
    EXPECT_EQ(code({unit, 0, 60, 1 << 30}), IssueCode::usage_bad_value) << unit;
  for (const double size : {-1.0, nan, inf})
    EXPECT_EQ(code({"m", size, 60, 1 << 30}), IssueCode::usage_bad_value) << size;
  for (const double time : {0.0, -1.0, nan, inf})
    EXPECT_EQ(code({"m", 0, time, 1 << 30}), IssueCode::usage_bad_value) << time;
  EXPECT_EQ(code({"m", 0, 60, 0}), IssueCode::usage_bad_value);
}

TEST(ImportSurface, GivesTheSameBytesTwice) {
  SOUPLE_NEEDS_REAL_SURFACES();
  for (const char* name : {"liver-smooth.obj", "bamboo_pen.obj", "simple_pole.glb"}) {
    const auto a = import_surface(real_surface_dir() / name, {});
    const auto b = import_surface(real_surface_dir() / name, {});
    ASSERT_TRUE(a.ok() && b.ok());
    EXPECT_EQ(a->mesh.vertices, b->mesh.vertices) << name;
    EXPECT_EQ(a->mesh.triangles, b->mesh.triangles) << name;
    EXPECT_EQ(a->report.file_hash, b->report.file_hash) << name;
  }
}

}  // namespace
}  // namespace souple
