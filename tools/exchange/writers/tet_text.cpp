// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/exchange/writers/append.hpp"
#include "tools/exchange/writers/mesh_text.hpp"

namespace souple {
namespace {

std::string text_of(std::size_t number) { return std::to_string(number); }

}  // namespace

std::string medit_text(const TetMesh& mesh, const std::vector<Index>& labels) {
  std::string text =
      "MeshVersionFormatted 2\nDimension 3\nVertices\n" + text_of(mesh.nodes.size()) + "\n";
  for (const Point& node : mesh.nodes) {
    append_point(text, node);
    text += " 0\n";
  }
  const std::vector<Triangle> boundary = boundary_triangles(mesh.tets);
  text += "Triangles\n" + text_of(boundary.size()) + "\n";
  for (const Triangle& triangle : boundary) {
    append_cell(text, triangle, 1);
    text += " 0\n";
  }
  text += "Tetrahedra\n" + text_of(mesh.tets.size()) + "\n";
  for (std::size_t t = 0; t < mesh.tets.size(); ++t) {
    append_cell(text, mesh.tets[t], 1);
    text += ' ';
    append_number(text, labels.empty() ? 0 : std::int64_t{labels[t]} + 1);
    text += '\n';
  }
  return text + "End\n";
}

std::string vtk_bytes(const TetMesh& mesh, const std::vector<Index>& labels) {
  constexpr std::int32_t vtk_tetra = 10;
  const std::string count = text_of(mesh.tets.size());
  std::string bytes =
      "# vtk DataFile Version 3.0\nsouple, metres\nBINARY\nDATASET UNSTRUCTURED_GRID\nPOINTS " +
      text_of(mesh.nodes.size()) + " double\n";
  for (const Point& node : mesh.nodes)
    for (const double x : node) append_bytes<ByteOrder::big>(bytes, x);
  bytes += "\nCELLS " + count + " " + text_of(5 * mesh.tets.size()) + "\n";
  for (const Tet& tet : mesh.tets) {
    append_bytes<ByteOrder::big>(bytes, std::int32_t{4});
    for (const Index i : tet) append_bytes<ByteOrder::big>(bytes, i);
  }
  bytes += "\nCELL_TYPES " + count + "\n";
  for (std::size_t t = 0; t < mesh.tets.size(); ++t) append_bytes<ByteOrder::big>(bytes, vtk_tetra);
  bytes += '\n';
  if (labels.empty()) return bytes;
  bytes += "CELL_DATA " + count + "\nSCALARS region int 1\nLOOKUP_TABLE default\n";
  for (const Index label : labels) append_bytes<ByteOrder::big>(bytes, label);
  return bytes += '\n';
}

std::pair<std::string, std::string> tetgen_texts(const TetMesh& mesh,
                                                 const std::vector<Index>& labels) {
  std::string nodes = text_of(mesh.nodes.size()) + " 3 0 0\n";
  for (std::size_t i = 0; i < mesh.nodes.size(); ++i) {
    append_number(nodes, i);
    nodes += ' ';
    append_point(nodes, mesh.nodes[i]);
    nodes += '\n';
  }
  std::string tets = text_of(mesh.tets.size()) + (labels.empty() ? " 4 0\n" : " 4 1\n");
  for (std::size_t t = 0; t < mesh.tets.size(); ++t) {
    append_number(tets, t);
    tets += ' ';
    append_cell(tets, mesh.tets[t], 0);
    if (!labels.empty()) {
      tets += ' ';
      append_number(tets, labels[t]);
    }
    tets += '\n';
  }
  return {std::move(nodes), std::move(tets)};
}

}  // namespace souple
