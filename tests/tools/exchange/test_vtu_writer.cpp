// SPDX-License-Identifier: GPL-3.0-or-later
// The files are read back by expat, a strict XML parser that shares no code with the writer.
#include "tools/exchange/vtu_writer.hpp"

#include <expat.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <map>
#include <random>

#include "tools/exchange/atomic_file.hpp"
#include "tools/exchange/shape_mesh.hpp"

namespace souple {
namespace {

struct Element {
  std::map<std::string, std::string> attributes;
  std::string text;
};

/// Every element by "Parent/Name" or "Parent/Name:Name attribute".
struct XmlDocument {
  bool well_formed = false;
  std::multimap<std::string, Element> elements;
  std::vector<std::pair<std::string, std::multimap<std::string, Element>::iterator>> open;

  const Element& at(const std::string& path) const {
    const auto found = elements.find(path);
    if (found == elements.end()) throw std::runtime_error("no element " + path);
    return found->second;
  }
};

void begin_element(void* data, const char* tag, const char** attributes) {
  auto& document = *static_cast<XmlDocument*>(data);
  Element element;
  for (; *attributes != nullptr; attributes += 2) element.attributes[attributes[0]] = attributes[1];
  const std::string parent = document.open.empty() ? "" : document.open.back().first + "/";
  std::string path = parent + tag;
  if (std::string(tag) == "DataArray") path += ":" + element.attributes["Name"];
  document.open.emplace_back(tag, document.elements.emplace(path, element));
}

void end_element(void* data, const char*) { static_cast<XmlDocument*>(data)->open.pop_back(); }

void add_text(void* data, const char* text, int length) {
  auto& document = *static_cast<XmlDocument*>(data);
  if (!document.open.empty())
    document.open.back().second->second.text.append(text, static_cast<std::size_t>(length));
}

XmlDocument parse_xml(const std::string& text) {
  XmlDocument document;
  XML_Parser parser = XML_ParserCreate(nullptr);
  XML_SetUserData(parser, &document);
  XML_SetElementHandler(parser, begin_element, end_element);
  XML_SetCharacterDataHandler(parser, add_text);
  document.well_formed =
      XML_Parse(parser, text.data(), static_cast<int>(text.size()), 1) == XML_STATUS_OK;
  XML_ParserFree(parser);
  return document;
}

std::vector<unsigned char> decode_base64(const std::string& text) {
  static const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::vector<unsigned char> bytes;
  unsigned group = 0;
  int bits = 0;
  for (const char c : text) {
    if (c == '=') break;
    group = group << 6 | static_cast<unsigned>(digits.find(c));
    bits += 6;
    if (bits < 8) continue;
    bits -= 8;
    bytes.push_back(static_cast<unsigned char>(group >> bits & 255u));
  }
  return bytes;
}

template <class T>
std::vector<T> array_values(const XmlDocument& document, const std::string& path) {
  const auto bytes = decode_base64(document.at(path).text);
  std::uint64_t size = 0;
  EXPECT_GE(bytes.size(), sizeof size);
  std::memcpy(&size, bytes.data(), sizeof size);
  EXPECT_EQ(bytes.size(), sizeof size + size);
  std::vector<T> values(size / sizeof(T));
  std::memcpy(values.data(), bytes.data() + sizeof size, values.size() * sizeof(T));
  return values;
}

VtuMesh sample_mesh() {
  std::mt19937 random(3);
  std::normal_distribution<double> any;
  VtuMesh mesh;
  for (int i = 0; i < 50; ++i) mesh.points.push_back({any(random), any(random), any(random)});
  for (Index i = 0; i < 20; ++i) mesh.triangles.push_back({i, i + 1, i + 2});
  for (Index i = 0; i < 30; ++i) mesh.tets.push_back({i, i + 3, i + 7, i + 11});
  mesh.fields = {vector_field("velocity", mesh.points), {"a<b>&\"c'", 1, std::vector<double>(50, 0.5)}};
  return mesh;
}

TEST(VtuWriter, WritesWhatAStrictXmlReaderReadsBackExactly) {
  const VtuMesh mesh = sample_mesh();
  const auto text = vtu_text(mesh);
  ASSERT_TRUE(text.ok());
  const XmlDocument document = parse_xml(*text);
  ASSERT_TRUE(document.well_formed);
  EXPECT_EQ(document.at("UnstructuredGrid/Piece").attributes.at("NumberOfPoints"), "50");
  EXPECT_EQ(document.at("UnstructuredGrid/Piece").attributes.at("NumberOfCells"), "50");
  const auto points = array_values<double>(document, "Points/DataArray:Points");
  ASSERT_EQ(points.size(), 150u);
  for (std::size_t i = 0; i < 150; ++i) EXPECT_EQ(points[i], mesh.points[i / 3][i % 3]);
  EXPECT_EQ(array_values<double>(document, "PointData/DataArray:velocity"), points);
  EXPECT_EQ(array_values<double>(document, "PointData/DataArray:a<b>&\"c'"),
            std::vector<double>(50, 0.5));
}

TEST(VtuWriter, ListsTrianglesBeforeTetsWithTheirTypes) {
  const VtuMesh mesh = sample_mesh();
  const XmlDocument document = parse_xml(*vtu_text(mesh));
  const auto connectivity = array_values<std::int32_t>(document, "Cells/DataArray:connectivity");
  const auto offsets = array_values<std::int32_t>(document, "Cells/DataArray:offsets");
  const auto types = array_values<std::uint8_t>(document, "Cells/DataArray:types");
  ASSERT_EQ(connectivity.size(), 20u * 3 + 30u * 4);
  ASSERT_EQ(offsets.size(), 50u);
  EXPECT_EQ(offsets[19], 60);
  EXPECT_EQ(offsets[49], 180);
  for (std::size_t i = 0; i < 50; ++i) EXPECT_EQ(types[i], i < 20 ? 5 : 10);
  EXPECT_EQ(connectivity[60 + 4 * 7 + 3], mesh.tets[7][3]);
}

TEST(VtuWriter, RefusesIndicesOutsideThePointsAndFieldsOfAnotherLength) {
  VtuMesh mesh = sample_mesh();
  mesh.tets.push_back({0, 1, 2, 50});
  EXPECT_EQ(vtu_text(mesh).issue().code, IssueCode::vtu_mesh_invalid);
  mesh = sample_mesh();
  mesh.triangles.push_back({0, -1, 2});
  EXPECT_EQ(vtu_text(mesh).issue().code, IssueCode::vtu_mesh_invalid);
  mesh = sample_mesh();
  mesh.fields[0].values.pop_back();
  EXPECT_EQ(vtu_text(mesh).issue().code, IssueCode::vtu_mesh_invalid);
}

TEST(VtuWriter, WritesAnEmptyMesh) {
  const auto text = vtu_text({});
  ASSERT_TRUE(text.ok());
  EXPECT_TRUE(parse_xml(*text).well_formed);
}

TEST(VtuWriter, AppendsMeshesAndPadsFieldsThatOnlyOneHas) {
  VtuMesh all = sample_mesh();
  VtuMesh part;
  part.points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  part.triangles = {{0, 1, 2}};
  part.fields = {{"speed", 1, {1, 2, 3}}};
  append_mesh(all, part);
  ASSERT_TRUE(vtu_text(all).ok());
  EXPECT_EQ(all.triangles.back(), (Triangle{50, 51, 52}));
  EXPECT_EQ(all.fields[0].values.size(), 159u);
  EXPECT_EQ(all.fields[0].values[158], 0);
  EXPECT_EQ(all.fields[2].values[49], 0);
  EXPECT_EQ(all.fields[2].values[52], 3);
}

TEST(VtuWriter, RegionsStandForEveryCellAndAreKeptWhenMeshesAreAppended) {
  VtuMesh all = sample_mesh(), part;
  part.points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  part.triangles = {{0, 1, 2}};
  part.tets = {{0, 1, 2, 3}};
  part.tet_regions = {4};
  append_mesh(all, part);
  const auto text = vtu_text(all);
  ASSERT_TRUE(text.ok()) << format_issue(text.issue());
  const auto regions = array_values<std::int32_t>(parse_xml(*text), "CellData/DataArray:region");
  ASSERT_EQ(regions.size(), 21u + 31u);
  EXPECT_EQ(std::ranges::count(regions, -1), 51);
  EXPECT_EQ(regions.back(), 4);
  all.tet_regions.pop_back();
  EXPECT_EQ(vtu_text(all).issue().code, IssueCode::vtu_mesh_invalid);
}

TEST(VtuWriter, CollectionIsWellFormedAndKeepsTimesExactly) {
  const std::vector<PvdEntry> entries{{0.1, 0, "a & b", "frames/a_000000.vtu"}};
  const XmlDocument document = parse_xml(pvd_text(entries));
  ASSERT_TRUE(document.well_formed);
  const auto& set = document.at("Collection/DataSet").attributes;
  EXPECT_EQ(set.at("name"), "a & b");
  EXPECT_EQ(std::stod(set.at("timestep")), 0.1);
}

/// Volume inside closed triangles, by the divergence theorem.
double enclosed_volume(const TriangleMesh& mesh) {
  double six = 0;
  for (const Triangle& t : mesh.triangles) {
    const auto corner = [&](int k) {
      return mesh.vertices[static_cast<std::size_t>(t[static_cast<std::size_t>(k)])];
    };
    six += signed_volume6({0, 0, 0}, corner(0), corner(1), corner(2));
  }
  return six / 6;
}

TEST(ShapeMesh, IsWoundOutwardAndHasTheShapesVolumeAtAnyPose) {
  const double half = std::sqrt(0.5);
  const Pose pose{{half, 0, half, 0}, {1, 2, 3}};
  RigidShape box;
  box.kind = RigidShapeKind::box;
  box.half_extents_m = {0.5, 1, 2};
  EXPECT_NEAR(enclosed_volume(triangulate_shape(box, pose, 1)), 8, 1e-12);
  RigidShape sphere;
  sphere.kind = RigidShapeKind::sphere;
  sphere.radius_m = 0.5;
  EXPECT_NEAR(enclosed_volume(triangulate_shape(sphere, pose, 1)), 4.0 / 3 * 3.14159265 * 0.125, 0.01);
}

TEST(ShapeMesh, PlaceTurnsByTheQuaternion) {
  const double half = std::sqrt(0.5);
  const Point x = place({{half, 0, 0, half}, {0, 0, 1}}, {1, 0, 0});  // 90 degrees about z
  EXPECT_NEAR(x[0], 0, 1e-15);
  EXPECT_NEAR(x[1], 1, 1e-15);
  EXPECT_NEAR(x[2], 1, 1e-15);
}

}  // namespace
}  // namespace souple
