// SPDX-License-Identifier: GPL-3.0-or-later
// What is written is read back by import_tets and, the surfaces, by CGAL's and assimp's readers.
#include "tools/exchange/mesh_writer.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <nlohmann/json.hpp>
#include <random>

#include "tests/tools/exchange/tet_data.hpp"
#include "tools/exchange/tet_file.hpp"
#include "tools/surface/import_surface.hpp"

namespace souple {
namespace {

namespace fs = std::filesystem;

/// Cubes of six tets in a row, with digits that no short text can hold.
TetMesh sample_tets() {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> noise(-0.05, 0.05);
  constexpr Index length = 6;
  TetMesh mesh;
  for (Index i = 0; i <= length; ++i)
    for (Index k = 0; k < 4; ++k)
      mesh.nodes.push_back({i + noise(random), k % 2 + noise(random), k / 2 + noise(random) * 1e-3});
  for (Index i = 0; i < length; ++i)
    for (const Tet& t : {Tet{0, 4, 5, 7}, Tet{0, 5, 1, 7}, Tet{0, 1, 3, 7}, Tet{0, 3, 2, 7},
                         Tet{0, 2, 6, 7}, Tet{0, 6, 4, 7}})
      mesh.tets.push_back({t[0] + 4 * i, t[1] + 4 * i, t[2] + 4 * i, t[3] + 4 * i});
  return mesh;
}

std::vector<Index> sample_labels(std::size_t count) {
  std::vector<Index> labels;
  for (std::size_t t = 0; t < count; ++t) labels.push_back(static_cast<Index>(t / 4 % 3));
  return labels;
}

TriangleMesh sample_surface() {
  const TetMesh tets = sample_tets();
  TriangleMesh mesh{tets.nodes, boundary_triangles(tets.tets)};
  return mesh;
}

class MeshWriter : public ::testing::Test {
 protected:
  TemporaryFolder folder_;
};

TEST_F(MeshWriter, TetsComeBackBitForBitWithTheirLabels) {
  const TetMesh mesh = sample_tets();
  for (const char* name : {"a.msh", "a.mesh", "a.vtu", "a.vtk", "a.node"})
    for (const auto& labels : {std::vector<Index>{}, sample_labels(mesh.tets.size()),
                               std::vector<Index>(mesh.tets.size(), 0)}) {
      SCOPED_TRACE(name);
      const Status written = write_tets(mesh, labels, folder_ / name);
      ASSERT_TRUE(written.ok()) << format_issue(written.issue());
      const auto read = import_tets(folder_ / name, {});
      ASSERT_TRUE(read.ok()) << format_issue(read.issue());
      EXPECT_EQ(read->mesh.nodes, mesh.nodes);
      EXPECT_EQ(read->mesh.tets, mesh.tets);
      EXPECT_EQ(read->labels, labels);
      EXPECT_EQ(read->report.turned_count, 0u);
    }
}

TEST_F(MeshWriter, RealTetsComeBackBitForBitFromEveryFormat) {
  SOUPLE_NEEDS_REAL_TETS();
  const auto real = import_tets(real_tet_dir() / "bunny.msh", {});
  ASSERT_TRUE(real.ok());
  for (const char* name : {"a.msh", "a.mesh", "a.vtu", "a.vtk", "a.node"}) {
    ASSERT_TRUE(write_tets(real->mesh, {}, folder_ / name).ok());
    const auto read = import_tets(folder_ / name, {});
    ASSERT_TRUE(read.ok()) << name << format_issue(read.issue());
    EXPECT_EQ(read->mesh.nodes, real->mesh.nodes) << name;
    EXPECT_EQ(read->mesh.tets, real->mesh.tets) << name;
  }
}

TEST_F(MeshWriter, GmshNamesItsRegions) {
  const TetMesh mesh = sample_tets();
  ASSERT_TRUE(write_tets(mesh, sample_labels(mesh.tets.size()), folder_ / "a.msh").ok());
  const auto read = import_tets(folder_ / "a.msh", {});
  ASSERT_TRUE(read.ok());
  EXPECT_EQ(read->label_names, (std::vector<std::string>{"region_0", "region_1", "region_2"}));
}

/// GCC 12 at -O3 leaves out a rounding to float and back in a loop over three numbers, unless it has to
/// store the float.
double rounded_to_float(double x) {
  volatile float stored = static_cast<float>(x);
  return double{stored};
}

/// Corners of the triangles, which survive another numbering of the vertices.
std::vector<std::array<Point, 3>> corners_of(const TriangleMesh& mesh, bool rounded) {
  std::vector<std::array<Point, 3>> corners;
  for (const Triangle& t : mesh.triangles) {
    std::array<Point, 3> three;
    for (std::size_t k = 0; k < 3; ++k) {
      three[k] = mesh.vertices[static_cast<std::size_t>(t[k])];
      if (rounded)
        for (double& x : three[k]) x = rounded_to_float(x);
    }
    std::ranges::rotate(three, std::ranges::min_element(three));
    corners.push_back(three);
  }
  std::ranges::sort(corners);
  return corners;
}

TEST_F(MeshWriter, SurfacesComeBackExactlyOrRoundedToFloat) {
  const TriangleMesh mesh = sample_surface();
  for (const char* name : {"a.obj", "a.off", "a.ply", "a.stl", "a.glb", "A.OBJ"}) {
    SCOPED_TRACE(name);
    const Status written = write_surface(mesh, folder_ / name);
    ASSERT_TRUE(written.ok()) << format_issue(written.issue());
    const auto read = import_surface(folder_ / name, {});
    ASSERT_TRUE(read.ok()) << format_issue(read.issue());
    const bool rounded = name[2] == 's' || name[2] == 'g';
    const auto found = corners_of(read->mesh, false), expected = corners_of(mesh, rounded);
    ASSERT_EQ(found.size(), expected.size());
    for (std::size_t t = 0; t < found.size(); ++t) ASSERT_EQ(found[t], expected[t]) << t;
  }
}

std::uint32_t word(const std::string& bytes, std::size_t at) {
  std::uint32_t value = 0;
  std::memcpy(&value, bytes.data() + at, 4);
  return value;
}

TEST_F(MeshWriter, GlbFollowsTheSpecification) {
  TriangleMesh mesh = sample_surface();
  mesh.triangles.pop_back();
  ASSERT_TRUE(write_surface(mesh, folder_ / "a.glb").ok());
  const std::string glb = file_content(folder_ / "a.glb");
  EXPECT_EQ(glb.substr(0, 4), "glTF");
  EXPECT_EQ(word(glb, 4), 2u);
  EXPECT_EQ(word(glb, 8), glb.size());
  const std::uint32_t json_bytes = word(glb, 12);
  EXPECT_EQ(json_bytes % 4, 0u);
  EXPECT_EQ(glb.substr(16, 4), "JSON");
  const auto json = nlohmann::json::parse(glb.substr(20, json_bytes));
  const std::size_t buffer_at = 28 + json_bytes;
  EXPECT_EQ(word(glb, buffer_at - 8), glb.size() - buffer_at);
  EXPECT_EQ(glb.substr(buffer_at - 4, 4), std::string("BIN\0", 4));
  EXPECT_EQ(json["buffers"][0]["byteLength"], glb.size() - buffer_at);
  EXPECT_EQ(json["accessors"][0]["count"], mesh.vertices.size());
  EXPECT_EQ(json["accessors"][1]["count"], 3 * mesh.triangles.size());
  EXPECT_EQ(json["bufferViews"][1]["byteOffset"].get<std::size_t>() % 4, 0u);
  for (std::size_t k = 0; k < 3; ++k) {
    float low = std::numeric_limits<float>::max(), high = -low;
    for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
      float x = 0;
      std::memcpy(&x, glb.data() + buffer_at + 12 * i + 4 * k, 4);
      low = std::min(low, x);
      high = std::max(high, x);
    }
    EXPECT_EQ(json["accessors"][0]["min"][k].get<float>(), low);
    EXPECT_EQ(json["accessors"][0]["max"][k].get<float>(), high);
  }
}

TEST_F(MeshWriter, RefusesMeshesThatAreNoneAndLeavesNothingBehind) {
  const TetMesh sound = sample_tets();
  TetMesh outside = sound, not_finite = sound;
  outside.tets[3][2] = static_cast<Index>(sound.nodes.size());
  not_finite.nodes[5][1] = std::nan("");
  const auto code = [&](const TetMesh& mesh, const std::vector<Index>& labels, const char* name) {
    const Status written = write_tets(mesh, labels, folder_ / name);
    EXPECT_FALSE(written.ok());
    EXPECT_FALSE(fs::exists(folder_ / name));
    return written.ok() ? IssueCode{} : written.issue().code;
  };
  for (const char* name : {"a.msh", "a.mesh", "a.vtu", "a.vtk", "a.node"}) {
    EXPECT_EQ(code(outside, {}, name), IssueCode::mesh_not_writable);
    EXPECT_EQ(code(not_finite, {}, name), IssueCode::mesh_not_writable);
    EXPECT_EQ(code(sound, {1, 2}, name), IssueCode::mesh_not_writable);
    EXPECT_EQ(code(sound, std::vector<Index>(sound.tets.size(), -1), name),
              IssueCode::mesh_not_writable);
    EXPECT_EQ(code({}, {}, name), IssueCode::mesh_not_writable);
  }
  EXPECT_EQ(code(sound, {}, "a.obj"), IssueCode::unsupported_feature);
  EXPECT_EQ(code(sound, {}, "folder/a.msh"), IssueCode::io_cannot_write);
}

TEST_F(MeshWriter, RefusesNumbersBeyondFloatOnlyWhereFloatsAreWritten) {
  TriangleMesh mesh = sample_surface();
  mesh.vertices[0][0] = 1e39;
  EXPECT_EQ(write_surface(mesh, folder_ / "a.stl").issue().code, IssueCode::mesh_not_writable);
  EXPECT_EQ(write_surface(mesh, folder_ / "a.glb").issue().code, IssueCode::mesh_not_writable);
  EXPECT_TRUE(write_surface(mesh, folder_ / "a.ply").ok());
  EXPECT_EQ(write_surface(mesh, folder_ / "a.fbx").issue().code, IssueCode::unsupported_feature);
}

TEST_F(MeshWriter, KeepsNoHalfOfATetgenPair) {
  fs::create_directory(folder_ / "a.ele");
  EXPECT_EQ(write_tets(sample_tets(), {}, folder_ / "a.node").issue().code, IssueCode::io_cannot_write);
  EXPECT_FALSE(fs::exists(folder_ / "a.node"));
}

TEST_F(MeshWriter, WritesTheSameBytesAgain) {
  const TetMesh mesh = sample_tets();
  for (const std::string name : {".msh", ".mesh", ".vtu", ".vtk", ".node"}) {
    ASSERT_TRUE(write_tets(mesh, sample_labels(mesh.tets.size()), folder_ / ("a" + name)).ok());
    ASSERT_TRUE(write_tets(mesh, sample_labels(mesh.tets.size()), folder_ / ("b" + name)).ok());
    EXPECT_EQ(file_content(folder_ / ("a" + name)), file_content(folder_ / ("b" + name)));
  }
}

}  // namespace
}  // namespace souple
