// SPDX-License-Identifier: GPL-3.0-or-later
// What import_tets refuses, mends and reports.
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/wait.h>

#include "tests/tools/exchange/tet_data.hpp"
#include "tools/exchange/tet_file.hpp"

namespace souple {
namespace {

namespace fs = std::filesystem;

constexpr const char* five_nodes =
    "$NOD\n6\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n5 1 1 1\n6 9 9 9\n$ENDNOD\n";

class TetImport : public ::testing::Test {
 protected:
  Result<ImportedTets> import(const std::string& name, const std::string& content, bool mend = false) {
    options_.mend = mend;
    return import_tets(folder_.write(name, content), options_);
  }
  Result<ImportedTets> import_elements(const std::string& rows, std::size_t count, bool mend = false) {
    return import("a.msh", five_nodes + ("$ELM\n" + std::to_string(count) + "\n") + rows + "$ENDELM\n",
                  mend);
  }
  static IssueCode code_of(const Result<ImportedTets>& read) {
    EXPECT_FALSE(read.ok());
    if (read.ok()) return {};
    EXPECT_FALSE(read.issue().where.empty());
    return read.issue().code;
  }

  TemporaryFolder folder_;
  ImportTetsOptions options_;
};

TEST_F(TetImport, RefusesWhatIsNotWhatItsNameSays) {
  EXPECT_EQ(code_of(import("a.msh", "Dear mesh,\nhow are you?\n")), IssueCode::tet_file_malformed);
  for (const char* name : {"a.msh", "a.mesh", "a.vtk", "a.vtu", "a.node", "a.veg"})
    EXPECT_EQ(code_of(import(name, "")), IssueCode::tet_file_malformed) << name;
  EXPECT_EQ(code_of(import("a.msh", " \r\n\t")), IssueCode::tet_file_malformed);
  EXPECT_EQ(code_of(import("a.MSH", std::string(1000, '\0'))), IssueCode::tet_file_malformed);
  EXPECT_EQ(code_of(import("a.txt", "hello")), IssueCode::tet_file_unsupported);
  EXPECT_EQ(code_of(import("a", "hello")), IssueCode::tet_file_unsupported);
}

TEST_F(TetImport, RefusesOtherEncodings) {
  std::string utf16("\xFF\xFE", 2);
  for (const char c : std::string(five_nodes)) utf16 += c, utf16 += '\0';
  EXPECT_EQ(code_of(import("a.msh", utf16)), IssueCode::tet_file_unsupported);
  EXPECT_EQ(code_of(import("a.mesh", std::string("\1\0\0\0\2\0\0\0", 8))),
            IssueCode::tet_file_unsupported);
  EXPECT_EQ(code_of(import("a.meshb", std::string("\0\0\0\1\0\0\0\2", 8))),
            IssueCode::tet_file_unsupported);
}

TEST_F(TetImport, KnowsAFormatByItsContentWhateverItsName) {
  const auto read = import(
      "a.dat", "\xEF\xBB\xBF" + std::string(five_nodes) + "$ELM\n1\n1 4 0 0 4 1 2 3 4\n$ENDELM\n");
  ASSERT_TRUE(read.ok()) << format_issue(read.issue());
  EXPECT_EQ(read->report.format, "gmsh 1 ascii");
  EXPECT_EQ(read->report.unused_node_count, 2u);
  EXPECT_TRUE(is_tet_file_name("x/Y.MesH"));
  EXPECT_FALSE(is_tet_file_name("mesh"));
  EXPECT_FALSE(is_tet_file_name("a.obj"));
}

TEST_F(TetImport, RefusesWhatIsNoRegularFileWithoutWaiting) {
  ASSERT_EQ(::mkfifo((folder_ / "pipe.msh").c_str(), 0600), 0);
  fs::create_directory(folder_ / "folder.msh");
  EXPECT_EQ(code_of(import_tets(folder_ / "pipe.msh", options_)), IssueCode::io_cannot_read);
  EXPECT_EQ(code_of(import_tets(folder_ / "folder.msh", options_)), IssueCode::io_cannot_read);
  EXPECT_EQ(code_of(import_tets(folder_ / "none.msh", options_)), IssueCode::io_file_missing);
}

TEST_F(TetImport, SaysWhichFileOfATetgenPairIsMissing) {
  const auto read = import("a.node", "1 3 0 0\n0 0 0 0\n");
  EXPECT_EQ(code_of(read), IssueCode::io_file_missing);
  EXPECT_EQ(read.issue().where, (folder_ / "a.ele").string());
  const auto other = import("b.ele", "0 4 0\n");
  EXPECT_EQ(code_of(other), IssueCode::io_file_missing);
  EXPECT_EQ(other.issue().where, (folder_ / "b.node").string());
}

TEST_F(TetImport, FindsAPartnerInUpperCase) {
  folder_.write("A.ELE", "1 4 0\n0 0 1 2 3\n");
  const auto read = import("A.NODE", "4 3 0 0\n0 0 0 0\n1 1 0 0\n2 0 1 0\n3 0 0 1\n");
  ASSERT_TRUE(read.ok()) << format_issue(read.issue());
  EXPECT_EQ(read->mesh.tets.size(), 1u);
}

TEST_F(TetImport, EndsWithinItsLimitsOnMemoryBombs) {
  EXPECT_EQ(
      code_of(import("a.msh", "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n99999999999\n1 0 0 0\n")),
      IssueCode::tet_file_malformed);
  options_.memory_limit_bytes = 1 << 20;
  EXPECT_EQ(code_of(import("a.msh", std::string(2 << 20, '1'))), IssueCode::io_file_too_large);
}

TEST_F(TetImport, RefusesOptionsOutOfRange) {
  options_.unit = "furlong";
  EXPECT_EQ(import_elements("", 0).issue().code, IssueCode::usage_bad_value);
  options_ = {};
  options_.size_m = -1;
  EXPECT_EQ(import_elements("", 0).issue().code, IssueCode::usage_bad_value);
}

TEST_F(TetImport, ScalesByUnitAndBySize) {
  options_.unit = "mm";
  const auto by_unit = import_elements("1 4 0 0 4 1 2 3 5\n", 1);
  ASSERT_TRUE(by_unit.ok());
  EXPECT_EQ(by_unit->mesh.nodes[1], (Point{1e-3, 0, 0}));
  EXPECT_EQ(by_unit->report.scale, 1e-3);
  options_.size_m = 0.2;  // the node that no tet uses does not count
  const auto by_size = import_elements("1 4 0 0 4 1 2 3 5\n", 1);
  ASSERT_TRUE(by_size.ok());
  EXPECT_EQ(by_size->mesh.nodes[1], (Point{0.2, 0, 0}));
}

TEST_F(TetImport, RefusesExtentsThatNoNumberCanHold) {
  const auto rows = [](const std::string& x) {
    return "$NOD\n4\n1 0 0 0\n2 " + x + " 0 0\n3 0 " + x + " 0\n4 0 0 " + x +
           "\n$ENDNOD\n$ELM\n1\n1 4 0 0 4 1 2 3 4\n$ENDELM\n";
  };
  EXPECT_EQ(code_of(import("a.msh", rows("1e16"))), IssueCode::tet_no_extent);
  EXPECT_EQ(code_of(import("a.msh", rows("1e-70"))), IssueCode::tet_no_extent);
  EXPECT_EQ(code_of(import("a.msh", rows("0"))), IssueCode::tet_no_extent);
  EXPECT_EQ(code_of(import("a.msh", rows("1e-12"))), IssueCode::tet_no_extent);
  options_.size_m = 1;
  EXPECT_TRUE(import("a.msh", rows("1e-12")).ok());
}

TEST_F(TetImport, TurnsAFileOfTheOtherConvention) {
  const auto read = import_elements("1 4 0 0 4 1 3 2 4\n2 4 0 0 4 5 2 3 4\n", 2);
  const auto straight = import_elements("1 4 0 0 4 1 2 3 4\n2 4 0 0 4 2 5 3 4\n", 2);
  ASSERT_TRUE(read.ok() && straight.ok());
  EXPECT_EQ(read->report.turned_count, 2u);
  EXPECT_EQ(volume_of(read->mesh), volume_of(straight->mesh));
}

TEST_F(TetImport, RefusesRepeatedAndFlatTetsOrLeavesThemOut) {
  const std::string rows =
      "1 4 7 0 4 1 2 3 4\n2 4 8 0 4 2 1 4 3\n3 4 9 0 4 1 2 3 3\n4 4 5 0 4 2 5 3 4\n";
  const auto refused = import_elements(rows, 4);
  EXPECT_EQ(code_of(refused), IssueCode::tet_degenerate);
  EXPECT_EQ(refused.issue().what, "1 flat and 1 repeated tets of 4");
  const auto mended = import_elements(rows, 4, true);
  ASSERT_TRUE(mended.ok()) << format_issue(mended.issue());
  EXPECT_EQ(mended->report.dropped_count, 2u);
  EXPECT_EQ(mended->report.raw_tet_count, 4u);
  EXPECT_EQ(mended->labels, (std::vector<Index>{1, 0}));
  EXPECT_EQ(mended->label_names, (std::vector<std::string>{"5", "7"}));
  EXPECT_EQ(code_of(import_elements("1 4 0 0 4 1 2 3 3\n", 1, true)), IssueCode::tet_degenerate);
}

TEST_F(TetImport, RefusesFacesOfThreeTets) {
  const std::string rows = "1 4 0 0 4 1 2 3 4\n2 4 0 0 4 1 2 3 5\n3 4 0 0 4 1 2 3 6\n";
  for (const bool mend : {false, true}) {
    const auto read = import_elements(rows, 3, mend);
    EXPECT_EQ(code_of(read), IssueCode::tet_not_manifold);
    EXPECT_EQ(read.issue().what.substr(0, 7), "1 faces");
  }
}

TEST_F(TetImport, RefusesVolumesOfAnotherKindAndHandsTrianglesOn) {
  EXPECT_EQ(code_of(import_elements("1 6 0 0 6 1 2 3 4 5 6\n2 2 0 0 3 1 2 3\n", 2)),
            IssueCode::tet_file_no_tets);
  EXPECT_EQ(code_of(import_elements("1 1 0 0 2 1 2\n", 1)), IssueCode::tet_file_no_tets);
  const auto read = import_elements("1 2 0 0 3 2 3 5\n2 3 0 0 4 1 2 5 3\n", 2);
  ASSERT_TRUE(read.ok());
  EXPECT_TRUE(read->mesh.nodes.empty());
  EXPECT_EQ(read->triangles.vertices.size(), 4u);
  EXPECT_EQ(read->triangles.triangles.size(), 3u);
}

TEST_F(TetImport, ReplacesNamesOfGroupsThatCannotBeNames) {
  const std::string head =
      "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n1\n3 4 \"a/b\"\n$EndPhysicalNames\n";
  std::string nodes = five_nodes;
  nodes.replace(0, 4, "$Nodes").replace(nodes.find("$ENDNOD"), 7, "$EndNodes");
  const auto read = import("a.msh", head + nodes + "$Elements\n1\n1 4 1 4 1 2 3 4\n$EndElements\n");
  ASSERT_TRUE(read.ok()) << format_issue(read.issue());
  EXPECT_EQ(read->label_names, std::vector<std::string>{"4"});
}

TEST_F(TetImport, LeavesNoChildBehind) {
  EXPECT_TRUE(import_elements("1 4 0 0 4 1 2 3 4\n", 1).ok());
  EXPECT_EQ(::waitpid(-1, nullptr, WNOHANG), -1);
}

}  // namespace
}  // namespace souple
