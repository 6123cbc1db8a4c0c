// SPDX-License-Identifier: GPL-3.0-or-later
// Variants of the formats that no real file of the set has.
#include "tools/exchange/tets/tet_readers.hpp"

#include <gtest/gtest.h>

#include <cstring>
#include <numeric>

#include "tools/exchange/base64.hpp"

namespace souple {
namespace {

const std::vector<Point> corners{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 1.5}};
const std::vector<Tet> two_tets{{0, 1, 2, 3}, {1, 4, 2, 3}};
using Labels = std::vector<std::int64_t>;

template <class T>
void put(std::string& bytes, T value, bool big = false) {
  char raw[sizeof(T)];
  std::memcpy(raw, &value, sizeof(T));
  for (std::size_t k = 0; k < sizeof(T); ++k) bytes += raw[big ? sizeof(T) - 1 - k : k];
}

void expect_two_tets(const Result<RawMesh>& read, const Labels& labels = {}) {
  ASSERT_TRUE(read.ok()) << format_issue(read.issue());
  EXPECT_EQ(read->nodes, corners);
  EXPECT_EQ(read->tets, two_tets);
  EXPECT_EQ(read->labels, labels);
}

IssueCode code_of(const Result<RawMesh>& read) {
  EXPECT_FALSE(read.ok());
  return read.ok() ? IssueCode{} : read.issue().code;
}

constexpr std::string_view node_rows = "0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 1 1.5\n";

TEST(GmshReader, ReadsVersion40WithEntitiesAndGroups) {
  const std::string text =
      "$MeshFormat\n4 0 8\n$EndMeshFormat\n$Comments\nanything $Nodes\n$EndComments\n"
      "$PhysicalNames\n2\n2 7 \"skin\"\n3 7 \"flesh and bone\"\n$EndPhysicalNames\n"
      "$Entities\n1 0 0 1\n1 0 0 0 0 0 0 0\n5 0 0 0 1 1 1 2 7 8 0\n$EndEntities\n"
      "$Nodes\n2 5\n1 0 0 1\n10 0 0 0\n5 3 1 4\n"
      "20 1 0 0 .1 .2 .3\n30 0 1 0 .1 .2 .3\n40 0 0 1 .1 .2 .3\n1000000000 1 1 1.5 .1 .2 "
      ".3\n$EndNodes\n"
      "$Elements\n2 3\n1 0 15 1\n1 10\n5 3 4 2\n2 10 20 30 40\n3 20 1000000000 30 40\n$EndElements\n";
  const auto read = read_gmsh(text);
  expect_two_tets(read, {7, 7});
  EXPECT_EQ(read->format, "gmsh 4.0 ascii");
  EXPECT_EQ(read->other_cell_count, 1u);
  ASSERT_EQ(read->label_names.size(), 1u);
  EXPECT_EQ(read->label_names[0].second, "flesh and bone");
}

std::string gmsh_2_binary(bool big) {
  std::string text = "$MeshFormat\n2.2 1 8\n";
  put(text, std::int32_t{1}, big);
  text += "\n$EndMeshFormat\n$Nodes\n5\n";
  for (std::size_t i = 0; i < 5; ++i) {
    put(text, static_cast<std::int32_t>(i + 1), big);
    for (const double x : corners[i]) put(text, x, big);
  }
  text += "\n$EndNodes\n$Elements\n2\n";
  for (const std::int32_t head : {4, 2, 2}) put(text, head, big);
  for (std::size_t t = 0; t < 2; ++t) {
    for (const std::int32_t tag :
         {static_cast<std::int32_t>(t + 1), 0, static_cast<std::int32_t>(3 - t)})
      put(text, tag, big);
    for (const Index i : two_tets[t]) put(text, i + 1, big);
  }
  return text + "\n$EndElements\n";
}

TEST(GmshReader, ReadsBinaryOfBothByteOrdersAndVolumesWhereNoGroupsAre) {
  expect_two_tets(read_gmsh(gmsh_2_binary(false)), {3, 2});
  expect_two_tets(read_gmsh(gmsh_2_binary(true)), {3, 2});
}

TEST(GmshReader, RefusesWhatItCannotRead) {
  EXPECT_EQ(code_of(read_gmsh("$MeshFormat\n3 0 8\n$EndMeshFormat\n")),
            IssueCode::tet_file_unsupported);
  EXPECT_EQ(code_of(read_gmsh("$MeshFormat\n4.1 1 4\n$EndMeshFormat\n")),
            IssueCode::tet_file_unsupported);
  EXPECT_EQ(code_of(read_gmsh("$MeshFormat\n4.1 0 8\n$EndMeshFormat\n")),
            IssueCode::tet_file_malformed);
  EXPECT_EQ(code_of(read_gmsh("$NOD\n1\n1 0 0 0\n$ENDNOD\n$ELM\n1\n1 99 0 0 1 1\n$ENDELM\n")),
            IssueCode::tet_file_unsupported);
}

TEST(GmshReader, RefusesTwoNodesWithOneNumberAndNodesThatAreNotThere) {
  EXPECT_EQ(code_of(read_gmsh("$NOD\n2\n1 0 0 0\n1 0 0 1\n$ENDNOD\n")), IssueCode::tet_file_malformed);
  EXPECT_EQ(code_of(read_gmsh("$NOD\n1\n1 0 0 0\n$ENDNOD\n$ELM\n1\n1 4 0 0 4 1 1 1 2\n$ENDELM\n")),
            IssueCode::tet_file_malformed);
}

TEST(MeditReader, ReadsSecondOrderTetsReferencesAndComments) {
  std::string text = "# by hand\nMeshVersionFormatted 2\r\nDimension\r\n3\r\nVertices # five\r\n10\r\n";
  for (int copy = 0; copy < 2; ++copy) text += "0 0 0 0\n1 0 0 0\n0 1 0 0\n0 0 1 0\n1 1 1.5 0\n";
  text +=
      "RequiredVertices\n1\n3\nTangents\n1\n1 0 0\nTetrahedraP2\n1\n1 2 3 4 6 7 8 9 10 5 -3\n"
      "Tetrahedra\n1\n2 5 3 4 8\nHexahedra 1\n1 2 3 4 5 6 7 8 0\nEnd\nnothing here is read";
  const auto read = read_medit(text);
  ASSERT_TRUE(read.ok()) << format_issue(read.issue());
  EXPECT_EQ(read->tets, two_tets);
  EXPECT_EQ(read->labels, (Labels{-3, 8}));
  EXPECT_EQ(read->linearised_count, 1u);
  EXPECT_EQ(read->volume_cell_count, 1u);
}

TEST(MeditReader, RefusesMeshesInThePlane) {
  EXPECT_EQ(code_of(read_medit("MeshVersionFormatted 1\nDimension 2\nVertices\n0\nEnd\n")),
            IssueCode::tet_file_unsupported);
}

TEST(VtkReader, ReadsVersion5WithOffsets) {
  std::string text = "# vtk DataFile Version 5.1\ntitle\nBINARY\nFIELD info 1\nTIME 1 1 double\n";
  put(text, 0.5, true);
  text += "\nDATASET UNSTRUCTURED_GRID\nPOINTS 5 double\n";
  for (const Point& p : corners)
    for (const double x : p) put(text, x, true);
  text += "\nCELLS 4 9\nOFFSETS vtktypeint64\n";
  for (const std::int64_t offset : {0, 1, 5, 9}) put(text, offset, true);
  text += "\nCONNECTIVITY vtktypeint64\n";
  put(text, std::int64_t{0}, true);
  for (const Tet& tet : two_tets)
    for (const Index i : tet) put(text, std::int64_t{i}, true);
  text += "\nCELL_TYPES 3\n";
  for (const std::int32_t type : {1, 10, 10}) put(text, type, true);
  text += "\nPOINT_DATA 5\nVECTORS v float\n" + std::string(60, 'x') +
          "\nCELL_DATA 3\nFIELD FieldData 2\nnot_regions 2 3 char\n" + std::string(6, 'x') +
          "\nMaterialIds 1 3 float\n";
  for (const float material : {9.f, 4.f, 5.f}) put(text, material, true);
  text += "\nMETADATA\nINFORMATION 1\nNAME L2_NORM LOCATION x\nDATA 2 0 1\n\n";
  const auto read = read_vtk(text);
  expect_two_tets(read, {4, 5});
  EXPECT_EQ(read->other_cell_count, 1u);
}

TEST(VtkReader, ReadsTextWithScalarsAndSkipsWhatIsNoNumber) {
  const std::string text =
      "# vtk DataFile Version 2.0\n\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 5 float\n" +
      std::string(node_rows) +
      "CELLS 2 10\n4 0 1 2 3\n4 1 4 2 3\nCELL_TYPES 2\n10 10\n"
      "CELL_DATA 2\nSCALARS pressure double\nLOOKUP_TABLE hot\nnan inf\n"
      "LOOKUP_TABLE hot 1\n0 0 0 1\nSCALARS gmsh:physical int 1\nLOOKUP_TABLE default\n6 6\n";
  expect_two_tets(read_vtk(text), {6, 6});
}

TEST(VtkReader, SplitsStripsPolygonsAndQuads) {
  const std::string text = "# vtk DataFile Version 3.0\n\nASCII\nDATASET POLYDATA\nPOINTS 5 float\n" +
                           std::string(node_rows) +
                           "VERTICES 1 2\n1 0\nLINES 1 3\n2 0 1\nPOLYGONS 1 5\n4 0 1 4 2\n"
                           "TRIANGLE_STRIPS 1 5\n4 0 1 2 3\n";
  const auto read = read_vtk(text);
  ASSERT_TRUE(read.ok()) << format_issue(read.issue());
  EXPECT_EQ(read->triangles, (std::vector<Triangle>{{0, 1, 4}, {0, 4, 2}, {0, 1, 2}, {2, 1, 3}}));
  EXPECT_EQ(read->other_cell_count, 2u);
}

TEST(VtkReader, RefusesCellsThatDoNotFitTheirList) {
  const std::string head =
      "# vtk DataFile Version 3.0\n\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 5 float\n" +
      std::string(node_rows);
  for (const char* cells :
       {"CELLS 1 5\n5 0 1 2 3\nCELL_TYPES 1\n10\n", "CELLS 1 6\n4 0 1 2 3 3\nCELL_TYPES 1\n10\n",
        "CELLS 1 5\n4 0 1 2 5\nCELL_TYPES 1\n10\n", "CELLS 1 4\n3 0 1 2\nCELL_TYPES 1\n10\n",
        "CELLS 1 5\n4 0 1 2 3\n", "CELLS 1 5\n4 0 1 2 3\nCELL_TYPES 2\n10 10\n"})
    EXPECT_EQ(code_of(read_vtk(head + cells)), IssueCode::tet_file_malformed) << cells;
}

/// A zlib stream that stores the bytes (RFC 1950, RFC 1951 3.2.4).
std::string zlib_stored(std::string_view bytes) {
  std::string stream("\x78\x01\x01", 3);
  put(stream, static_cast<std::uint16_t>(bytes.size()));
  put(stream, static_cast<std::uint16_t>(~bytes.size()));
  stream += bytes;
  std::uint32_t a = 1, b = 0;
  for (const unsigned char c : bytes) {
    a = (a + c) % 65521;
    b = (b + a) % 65521;
  }
  put(stream, b << 16 | a, true);
  return stream;
}

std::string base64(std::string_view bytes) {
  std::string text;
  append_base64(text, std::as_bytes(std::span(bytes.data(), bytes.size())));
  return text;
}

/// The encodings of VTK's writers.
struct VtuKind {
  bool appended, raw, compressed, big, wide;
};

class VtuFile {
 public:
  explicit VtuFile(VtuKind kind) : kind_(kind) {}

  std::string text() {
    std::string points, connectivity, offsets, types, regions;
    for (const Point& p : corners)
      for (const double x : p) put(points, static_cast<float>(x), kind_.big);
    for (const Tet& tet : two_tets)
      for (const Index i : tet) put(connectivity, std::int64_t{i}, kind_.big);
    for (const std::int64_t end : {4, 8}) put(offsets, end, kind_.big);
    for (const std::uint8_t type : {10, 10}) put(types, type, kind_.big);
    for (const std::int32_t region : {5, 2}) put(regions, region, kind_.big);
    std::string body = "<Points>" + array("Float32", "p", 3, points) + "</Points>\n<Cells>" +
                       array("Int64", "connectivity", 1, connectivity) +
                       array("Int64", "offsets", 1, offsets) + array("UInt8", "types", 1, types) +
                       "</Cells>\n<CellData Scalars=\"region\">" +
                       array("Int32", "region", 1, regions) + "</CellData>\n";
    std::string head =
        "<?xml version=\"1.0\"?>\n<!-- <a> & -->\n<VTKFile type='UnstructuredGrid' version=\"1.0\"";
    head += kind_.big ? " byte_order=\"BigEndian\"" : " byte_order=\"LittleEndian\"";
    if (kind_.wide) head += " header_type=\"UInt64\"";
    if (kind_.compressed) head += " compressor=\"vtkZLibDataCompressor\"";
    std::string text =
        head + ">\n<UnstructuredGrid><FieldData/>\n<Piece NumberOfPoints=\"5\" NumberOfCells=\"2\">\n" +
        body + "</Piece></UnstructuredGrid>\n";
    if (kind_.appended)
      text += std::string("<AppendedData encoding=\"") + (kind_.raw ? "raw" : "base64") + "\">\n _" +
              appended_ + "\n</AppendedData>\n";
    return text + "</VTKFile>\n";
  }

 private:
  void put_size(std::string& bytes, std::uint64_t size) const {
    if (kind_.wide)
      put(bytes, size, kind_.big);
    else
      put(bytes, static_cast<std::uint32_t>(size), kind_.big);
  }

  std::string encoded(const std::string& bytes) const {
    const auto text = [&](const std::string& raw) {
      return kind_.appended && kind_.raw ? raw : base64(raw);
    };
    std::string sizes;
    if (!kind_.compressed) {
      put_size(sizes, bytes.size());
      return text(sizes + bytes);
    }
    // Two blocks: one full, one smaller.
    const std::size_t block = bytes.size() / 2 + 1;
    const std::string first = zlib_stored(bytes.substr(0, block)),
                      second = zlib_stored(bytes.substr(block));
    const bool is_one = block >= bytes.size();
    put_size(sizes, is_one ? 1 : 2);
    put_size(sizes, is_one ? bytes.size() : block);
    put_size(sizes, is_one ? 0 : bytes.size() - block);
    put_size(sizes, first.size());
    if (!is_one) put_size(sizes, second.size());
    return text(sizes) + text(is_one ? first : first + second);
  }

  std::string array(const std::string& type, const std::string& name, int components,
                    const std::string& bytes) {
    std::string tag = "<DataArray type=\"" + type + "\" Name=\"" + name + "\" NumberOfComponents=\"" +
                      std::to_string(components) + "\" format=";
    if (!kind_.appended)
      return tag +
             "\"binary\">\n  <InformationKey name=\"k\"><Value "
             "index=\"0\">7</Value></InformationKey>\n  " +
             encoded(bytes) + "\n</DataArray>";
    tag += "\"appended\" offset=\"" + std::to_string(appended_.size()) + "\"/>";
    appended_ += encoded(bytes);
    return tag;
  }

  VtuKind kind_;
  std::string appended_;
};

TEST(VtuReader, ReadsEveryEncoding) {
  for (int bits = 0; bits < 32; ++bits) {
    const VtuKind kind{(bits & 1) != 0, (bits & 2) != 0, (bits & 4) != 0, (bits & 8) != 0,
                       (bits & 16) != 0};
    SCOPED_TRACE(bits);
    expect_two_tets(read_vtu(VtuFile(kind).text()), {5, 2});
  }
}

TEST(VtuReader, PutsPiecesTogether) {
  const std::string piece =
      "<Piece NumberOfPoints=\"4\" NumberOfCells=\"1\"><Points><DataArray type=\"Float32\" "
      "NumberOfComponents=\"3\" format=\"ascii\">0 0 0 1 0 0 0 1 0 0 0 1</DataArray></Points><Cells>"
      "<DataArray type=\"Int32\" Name=\"connectivity\">0 1 2 3</DataArray><DataArray type=\"Int32\" "
      "Name=\"offsets\">4</DataArray><DataArray type=\"UInt8\" "
      "Name=\"types\">10</DataArray></Cells></Piece>";
  const std::string text =
      "<VTKFile type=\"UnstructuredGrid\"><UnstructuredGrid>" + piece + piece +
      "<Piece NumberOfPoints=\"0\" NumberOfCells=\"0\"></Piece></UnstructuredGrid></VTKFile>";
  const auto read = read_vtu(text);
  ASSERT_TRUE(read.ok()) << format_issue(read.issue());
  EXPECT_EQ(read->nodes.size(), 8u);
  EXPECT_EQ(read->tets, (std::vector<Tet>{{0, 1, 2, 3}, {4, 5, 6, 7}}));
}

TEST(VtuReader, RefusesWhatItCannotReadAndWhatIsNoXml) {
  const auto code = [](const std::string& text) { return code_of(read_vtu(text)); };
  EXPECT_EQ(code("<VTKFile type=\"PolyData\"></VTKFile>"), IssueCode::tet_file_unsupported);
  EXPECT_EQ(code("<VTKFile type=\"UnstructuredGrid\" compressor=\"vtkLZ4DataCompressor\"></VTKFile>"),
            IssueCode::tet_file_unsupported);
  EXPECT_EQ(code("<!DOCTYPE a [<!ENTITY b \"c\">]><VTKFile type=\"UnstructuredGrid\"></VTKFile>"),
            IssueCode::tet_file_malformed);
  EXPECT_EQ(code("<VTKFile type=\"UnstructuredGrid\"><UnstructuredGrid></VTKFile>"),
            IssueCode::tet_file_malformed);
  EXPECT_EQ(code("<VTKFile type=\"UnstructuredGrid\" type=\"a\"></VTKFile>"),
            IssueCode::tet_file_malformed);
  EXPECT_EQ(code("<VTKFile type=\"UnstructuredGrid\"></VTKFile>"), IssueCode::tet_file_malformed);
}

TEST(VtuReader, DoesNotBelieveBlocksThatZlibCouldNotHold) {
  std::string sizes;
  const std::uint64_t claimed = std::uint64_t{3} * 8 * (std::uint64_t{1} << 30);
  for (const std::uint64_t size : {std::uint64_t{1}, claimed, std::uint64_t{0}, std::uint64_t{8}})
    put(sizes, size);
  const std::string text =
      "<VTKFile type=\"UnstructuredGrid\" compressor=\"vtkZLibDataCompressor\" header_type=\"UInt64\">"
      "<UnstructuredGrid><Piece NumberOfPoints=\"1073741824\" NumberOfCells=\"0\"><Points><DataArray "
      "type=\"Float64\" NumberOfComponents=\"3\" format=\"binary\">" +
      base64(sizes) + base64("12345678") + "</DataArray></Points></Piece></UnstructuredGrid></VTKFile>";
  EXPECT_EQ(code_of(read_vtu(text)), IssueCode::tet_file_malformed);
}

TEST(TetgenReader, CountsFromZeroOrOneAndReadsAttributes) {
  const std::string nodes = "# comment\n5 3 2 1\n1 0 0 0 .5 nought 1\n";
  EXPECT_EQ(code_of(read_tetgen(nodes, "0 4 0\n")), IssueCode::tet_file_malformed);
  std::string from_one = "# made by hand\n5 3 1 1\n", from_zero = "5 3 0 0\n";
  for (std::size_t i = 0; i < 5; ++i) {
    const Point& p = corners[i];
    const std::string xyz =
        " " + std::to_string(p[0]) + " " + std::to_string(p[1]) + " " + std::to_string(p[2]);
    from_one += std::to_string(i + 1) + xyz + " 0.25 1 # " + std::to_string(i) + "\n";
    from_zero += std::to_string(i) + xyz + "\n";
  }
  expect_two_tets(read_tetgen(from_one, "2 4 1\n1 1 2 3 4 6\n2 2 5 3 4 -6\n"), {6, -6});
  expect_two_tets(read_tetgen(from_zero, "2 4 0\n0 0 1 2 3\n1 1 4 2 3\n"));
  expect_two_tets(read_tetgen(from_zero, "2 4 1\n0 0 1 2 3 0.5\n1 1 4 2 3 1\n"));
  EXPECT_EQ(code_of(read_tetgen(from_one, "1 4 0\n1 0 1 2 3\n")), IssueCode::tet_file_malformed);
  EXPECT_EQ(code_of(read_tetgen(from_zero, "1 4 0\n1 0 1 2 3\n4 4 4 4 4\n")),
            IssueCode::tet_file_malformed);
  EXPECT_EQ(code_of(read_tetgen(from_zero, "1 8 0\n1 0 1 2 3 0 1 2 3\n")),
            IssueCode::tet_file_unsupported);
}

TEST(VegaReader, ReadsSetsAndRegionsAndRefusesIncludes) {
  const std::string mesh =
      "# hand\n*VERTICES\n5 3 0 0\n0 0 0 0\n1, 1, 0, 0\n2 0 1 0\n3 0 0 1\n4 1 1 1.5\n"
      "*ELEMENTS\nTETS\n2 4 0\n0 0 1 2 3\n1 1 4 2 3\n";
  expect_two_tets(read_vega(mesh));
  const auto read = read_vega(mesh +
                              "*MATERIAL soft\nENU, 1000, 1e6, 0.4\n*MATERIAL hard\nENU, 1, 2, .3\n"
                              "*SET tip\n1\n*REGION\nallElements, soft\n*REGION\ntip, hard\n");
  expect_two_tets(read, {1, 2});
  EXPECT_EQ(read->label_names[1].second, "hard");
  EXPECT_EQ(code_of(read_vega("*INCLUDE other.veg\n")), IssueCode::tet_file_unsupported);
  EXPECT_EQ(code_of(read_vega(mesh + "*REGION\nnowhere, soft\n")), IssueCode::tet_file_malformed);
  EXPECT_EQ(code_of(read_vega(mesh + "*SET tip\n2\n")), IssueCode::tet_file_malformed);
}

TEST(TetReaders, RefuseCountsThatTheBytesCannotHold) {
  for (const char* count :
       {"99999999999", "1000000000", "-1", "9223372036854775807", "1e9", "0x10", ""}) {
    SCOPED_TRACE(count);
    const std::string n = count;
    EXPECT_EQ(code_of(read_gmsh("$NOD\n" + n + "\n")), IssueCode::tet_file_malformed);
    EXPECT_EQ(code_of(read_gmsh("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n" + n + "\n")),
              IssueCode::tet_file_malformed);
    EXPECT_EQ(code_of(read_gmsh("$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Nodes\n1 " + n + " 1 1\n")),
              IssueCode::tet_file_malformed);
    EXPECT_EQ(code_of(read_medit("MeshVersionFormatted 1\nDimension 3\nVertices " + n)),
              IssueCode::tet_file_malformed);
    EXPECT_EQ(
        code_of(read_vtk("# vtk DataFile Version 3.0\n\nBINARY\nDATASET UNSTRUCTURED_GRID\nPOINTS " +
                         n + " double\n")),
        IssueCode::tet_file_malformed);
    EXPECT_EQ(code_of(read_vtu(
                  "<VTKFile type=\"UnstructuredGrid\"><UnstructuredGrid><Piece NumberOfPoints=\"" + n +
                  "\" NumberOfCells=\"" + n + "\"></Piece></UnstructuredGrid></VTKFile>")),
              IssueCode::tet_file_malformed);
    EXPECT_EQ(code_of(read_tetgen(n + " 3 0 0\n", "")), IssueCode::tet_file_malformed);
    EXPECT_EQ(code_of(read_vega("*VERTICES\n" + n + " 3 0 0\n")), IssueCode::tet_file_malformed);
  }
}

TEST(TetReaders, RefuseNumbersThatAreNotFinite) {
  for (const char* x : {"nan", "inf", "-inf", "1e999", "1,5", "0x1p3", "1.0.0"}) {
    SCOPED_TRACE(x);
    EXPECT_EQ(code_of(read_gmsh(std::string("$NOD\n1\n1 0 0 ") + x + "\n$ENDNOD\n")),
              IssueCode::tet_file_malformed);
    EXPECT_EQ(code_of(read_tetgen(std::string("1 3 0 0\n1 0 0 ") + x, "0 4 0\n")),
              IssueCode::tet_file_malformed);
  }
  std::string binary =
      "# vtk DataFile Version 3.0\n\nBINARY\nDATASET UNSTRUCTURED_GRID\nPOINTS 1 float\n";
  for (const std::uint32_t bits : {0u, 0u, 0x7FC00000u}) put(binary, bits, true);
  EXPECT_EQ(code_of(read_vtk(binary)), IssueCode::tet_file_malformed);
}

TEST(TetReaders, NameTheLine) {
  const auto read = read_gmsh("$NOD\r\n2\r\n1 0 0 0\r\n2 0 zero 0\r\n");
  ASSERT_FALSE(read.ok());
  EXPECT_EQ(read.issue().what, "line 4: \"zero\" is not a finite number");
}

}  // namespace
}  // namespace souple
