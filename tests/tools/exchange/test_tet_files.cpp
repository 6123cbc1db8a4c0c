// SPDX-License-Identifier: GPL-3.0-or-later
// Every file of the set of real tet meshes, against the counts that its README lists.
#include <gtest/gtest.h>

#include <optional>
#include <set>

#include "tests/tools/exchange/tet_data.hpp"
#include "tools/exchange/tet_file.hpp"

namespace souple {
namespace {

struct Expected {
  const char* file;
  const char* format;
  std::size_t node_count, tet_count;
  double volume;
  std::size_t other_count = 0;  ///< of elements
  std::size_t region_count = 0;
};

std::ostream& operator<<(std::ostream& out, const Expected& e) { return out << e.file; }

/// Numbers of the data set's README; volumes to its four digits.
const Expected sound_files[] = {
    {"22_ascii.msh", "gmsh 2 ascii", 8, 5, 0.8333, 0, 3},
    {"22_binary.msh", "gmsh 2 binary", 8, 5, 0.8333, 0, 3},
    {"41_ascii.msh", "gmsh 4.1 ascii", 8, 5, 0.8333, 0, 3},
    {"41_binary.msh", "gmsh 4.1 binary", 8, 5, 0.8333, 0, 3},
    {"adhesion_sphere.msh", "gmsh 4.1 ascii", 1760, 6851, 0.5185},
    {"armadillo_4k.ele", "tetgen", 1180, 3717, 1.86},
    {"armadillo_4k.node", "tetgen", 1180, 3717, 1.86},
    {"bar-186.msh", "gmsh 4.1 ascii", 86, 186, 5},
    {"bar-2523.msh", "gmsh 4.1 ascii", 886, 2523, 5},
    {"beam3_tet.veg", "vega", 208, 450, 0.0048, 0, 1},
    {"bunny.msh", "gmsh 4.1 ascii", 4670, 19379, 6.01},
    {"cube.mesh", "medit ascii", 152, 373, 1, 360},
    {"cube.vtk", "vtk legacy binary", 152, 373, 1, 360},
    {"cube_low_res.msh", "gmsh 2 ascii", 26, 44, 343},
    {"cylinder.msh", "gmsh 1 ascii", 510, 2430, 0.1837, 0, 1},
    {"link.msh", "gmsh 4.1 ascii", 233, 673, 0.102},
    {"liver.msh", "gmsh 1 ascii", 181, 596, 36.56, 0, 1},
    {"msh4_cube.msh", "gmsh 4.1 ascii", 14, 24, 1, 44},
    {"sphere.mesh", "medit ascii", 4505, 24013, 0.1004, 2880},
    {"sphere_coarse_P1.msh", "gmsh 4.1 binary", 18, 30, 2.862, 35},
    {"sphere_coarse_P2.msh", "gmsh 4.1 binary", 18, 30, 2.862},
    {"square_beam.mesh", "medit ascii", 739, 2886, 4e4},
    {"torus_low_res.msh", "gmsh 1 ascii", 264, 862, 8.217, 608, 1},
    {"truthcylinder1.msh", "gmsh 1 ascii", 642, 2524, 1513, 778, 1},
    {"turtle-volumetric-homogeneous.veg", "vega", 347, 1185, 45.19, 0, 1},
};
const std::set<std::string> other_files = {"6_tetra_bad.msh", "Armadillo_Tetra_4406.vtu", "liver.vtk",
                                           "liver_for_test_broken.vtk", "microstructure_P1.msh"};

Result<ImportedTets> import_real(const std::string& name, bool mend = false) {
  ImportTetsOptions options;
  options.mend = mend;
  return import_tets(real_tet_dir() / name, options);
}

class SoundTetFiles : public ::testing::TestWithParam<Expected> {};

TEST_P(SoundTetFiles, AreReadWithEveryNodeTetAndRegion) {
  SOUPLE_NEEDS_REAL_TETS();
  const Expected& expected = GetParam();
  const auto read = import_real(expected.file);
  ASSERT_TRUE(read.ok()) << format_issue(read.issue());
  EXPECT_EQ(read->report.format, expected.format);
  EXPECT_EQ(read->mesh.nodes.size(), expected.node_count);
  EXPECT_EQ(read->mesh.tets.size(), expected.tet_count);
  EXPECT_NEAR(volume_of(read->mesh), expected.volume, 5e-4 * expected.volume);
  EXPECT_EQ(read->report.other_element_count, expected.other_count);
  EXPECT_EQ(read->label_names.size(), expected.region_count);
  EXPECT_EQ(read->labels.size(), expected.region_count > 0 ? expected.tet_count : 0);
  EXPECT_EQ(read->report.turned_count, 0u);
  EXPECT_EQ(read->report.scale, 1);
  EXPECT_EQ(read->report.file_hash.size(), 32u);
}

INSTANTIATE_TEST_SUITE_P(Real, SoundTetFiles, ::testing::ValuesIn(sound_files),
                         [](const auto& test) { return "File" + std::to_string(test.index); });

TEST(RealTetFiles, AreAllInTheseTests) {
  SOUPLE_NEEDS_REAL_TETS();
  std::set<std::string> named = other_files;
  for (const Expected& expected : sound_files) named.insert(expected.file);
  for (const auto& entry : std::filesystem::directory_iterator(real_tet_dir()))
    EXPECT_TRUE(named.contains(entry.path().filename().string())) << entry.path();
}

TEST(RealTetFiles, SecondOrderTetsAreTakenByTheirCorners) {
  SOUPLE_NEEDS_REAL_TETS();
  const auto read = import_real("sphere_coarse_P2.msh");
  ASSERT_TRUE(read.ok());
  EXPECT_EQ(read->report.linearised_count, 30u);
  EXPECT_EQ(read->report.raw_node_count, 80u);
  EXPECT_EQ(read->report.unused_node_count, 62u);
}

TEST(RealTetFiles, TheSameMeshInFourEncodingsIsTheSame) {
  SOUPLE_NEEDS_REAL_TETS();
  const auto first = import_real("22_ascii.msh");
  ASSERT_TRUE(first.ok());
  EXPECT_EQ(first->labels, (std::vector<Index>{0, 1, 1, 1, 2}));
  for (const char* name : {"22_binary.msh", "41_ascii.msh", "41_binary.msh"}) {
    const auto other = import_real(name);
    ASSERT_TRUE(other.ok()) << name;
    ASSERT_EQ(other->mesh.tets.size(), 5u);
    // Version 4 stores the nodes by volume, in another order.
    for (std::size_t t = 0; t < 5; ++t)
      for (std::size_t k = 0; k < 4; ++k)
        EXPECT_EQ(other->mesh.nodes[static_cast<std::size_t>(other->mesh.tets[t][k])],
                  first->mesh.nodes[static_cast<std::size_t>(first->mesh.tets[t][k])]);
    EXPECT_EQ(other->labels, first->labels);
    EXPECT_EQ(other->label_names, first->label_names);
  }
}

TEST(RealTetFiles, EitherFileOfATetgenPairGivesTheSameMesh) {
  SOUPLE_NEEDS_REAL_TETS();
  const auto a = import_real("armadillo_4k.node"), b = import_real("armadillo_4k.ele");
  ASSERT_TRUE(a.ok() && b.ok());
  EXPECT_EQ(a->mesh.nodes, b->mesh.nodes);
  EXPECT_EQ(a->mesh.tets, b->mesh.tets);
  EXPECT_EQ(a->report.file_hash, b->report.file_hash);
}

TEST(RealTetFiles, MaterialsOfVegaNameTheRegions) {
  SOUPLE_NEEDS_REAL_TETS();
  const auto read = import_real("beam3_tet.veg");
  ASSERT_TRUE(read.ok());
  EXPECT_EQ(read->label_names, std::vector<std::string>{"BODY"});
}

TEST(RealTetFiles, InvertedTetsAreRefusedAndTurnedOnRequest) {
  SOUPLE_NEEDS_REAL_TETS();
  const auto refused = import_real("microstructure_P1.msh");
  ASSERT_FALSE(refused.ok());
  EXPECT_EQ(refused.issue().code, IssueCode::tet_inverted);
  EXPECT_EQ(refused.issue().what, "8 of 6414 tets");
  const auto mended = import_real("microstructure_P1.msh", true);
  ASSERT_TRUE(mended.ok()) << format_issue(mended.issue());
  EXPECT_EQ(mended->report.turned_count, 8u);
  EXPECT_EQ(mended->report.dropped_count, 0u);
  EXPECT_EQ(mended->mesh.tets.size(), 6414u);
  EXPECT_NEAR(volume_of(mended->mesh), 0.04672, 2e-5);
}

TEST(RealTetFiles, TetsThatTouchAtEdgesAreRefusedOrReducedToPiecesApart) {
  SOUPLE_NEEDS_REAL_TETS();
  EXPECT_EQ(import_real("6_tetra_bad.msh").issue().code, IssueCode::tet_inverted);
  const auto mended = import_real("6_tetra_bad.msh", true);
  ASSERT_TRUE(mended.ok()) << format_issue(mended.issue());
  EXPECT_EQ(mended->report.turned_count, 1u);
  EXPECT_EQ(mended->report.dropped_count, 4u);
  EXPECT_EQ(mended->mesh.tets.size(), 2u);
  EXPECT_EQ(mended->mesh.nodes.size(), 8u);
}

TEST(RealTetFiles, ANodeAtWhichAMeshPinchesItselfIsRefusedOrSplit) {
  SOUPLE_NEEDS_REAL_TETS();
  const auto refused = import_real("Armadillo_Tetra_4406.vtu");
  ASSERT_FALSE(refused.ok());
  EXPECT_EQ(refused.issue().code, IssueCode::tet_not_manifold);
  EXPECT_EQ(refused.issue().what, "0 edges and 1 nodes where the boundary touches itself");
  const auto mended = import_real("Armadillo_Tetra_4406.vtu", true);
  ASSERT_TRUE(mended.ok()) << format_issue(mended.issue());
  EXPECT_EQ(mended->report.split_node_count, 1u);
  EXPECT_EQ(mended->report.dropped_count, 0u);
  EXPECT_EQ(mended->mesh.nodes.size(), 1447u);
  EXPECT_EQ(mended->mesh.tets.size(), 4406u);
}

TEST(RealTetFiles, PolygonsAreHandedOnAsTriangles) {
  SOUPLE_NEEDS_REAL_TETS();
  const auto read = import_real("liver.vtk");
  ASSERT_TRUE(read.ok()) << format_issue(read.issue());
  EXPECT_TRUE(read->mesh.tets.empty());
  EXPECT_EQ(read->triangles.vertices.size(), 5008u);
  EXPECT_EQ(read->triangles.triangles.size(), 10000u);
}

TEST(RealTetFiles, AFileBrokenOnPurposeIsRefused) {
  SOUPLE_NEEDS_REAL_TETS();
  EXPECT_EQ(import_real("liver_for_test_broken.vtk").issue().code, IssueCode::tet_file_malformed);
}

}  // namespace
}  // namespace souple
