// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>

#include "tools/exchange/writers/append.hpp"
#include "tools/exchange/writers/mesh_text.hpp"

namespace souple {
namespace {

void append_rows(std::string& text, std::string_view before, const TriangleMesh& mesh,
                 std::string_view before_triangle, std::int64_t first) {
  for (const Point& vertex : mesh.vertices) {
    text += before;
    append_point(text, vertex);
    text += '\n';
  }
  for (const Triangle& triangle : mesh.triangles) {
    text += before_triangle;
    append_cell(text, triangle, first);
    text += '\n';
  }
}

/// Of length 1, or zero for a triangle without area.
std::array<float, 3> unit_normal(const Point& a, const Point& b, const Point& c) {
  const Point u{b[0] - a[0], b[1] - a[1], b[2] - a[2]}, v{c[0] - a[0], c[1] - a[1], c[2] - a[2]};
  const Point n{u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
  const double length = std::hypot(n[0], n[1], n[2]);
  if (!(length > 0) || !std::isfinite(length)) return {0, 0, 0};
  return {static_cast<float>(n[0] / length), static_cast<float>(n[1] / length),
          static_cast<float>(n[2] / length)};
}

}  // namespace

std::string obj_text(const TriangleMesh& mesh) {
  std::string text = "# metres\n";
  append_rows(text, "v ", mesh, "f ", 1);
  return text;
}

std::string off_text(const TriangleMesh& mesh) {
  std::string text = "OFF\n" + std::to_string(mesh.vertices.size()) + " " +
                     std::to_string(mesh.triangles.size()) + " 0\n";
  append_rows(text, "", mesh, "3 ", 0);
  return text;
}

std::string ply_bytes(const TriangleMesh& mesh) {
  std::string bytes = "ply\nformat binary_little_endian 1.0\ncomment metres\nelement vertex " +
                      std::to_string(mesh.vertices.size()) +
                      "\nproperty double x\nproperty double y\nproperty double z\nelement face " +
                      std::to_string(mesh.triangles.size()) +
                      "\nproperty list uchar int vertex_indices\nend_header\n";
  for (const Point& vertex : mesh.vertices)
    for (const double x : vertex) append_bytes<ByteOrder::little>(bytes, x);
  for (const Triangle& triangle : mesh.triangles) {
    bytes += '\3';
    for (const Index i : triangle) append_bytes<ByteOrder::little>(bytes, i);
  }
  return bytes;
}

std::string stl_bytes(const TriangleMesh& mesh) {
  std::string bytes = "binary STL, metres";  // must not begin with "solid"
  bytes.resize(80, ' ');
  append_bytes<ByteOrder::little>(bytes, static_cast<std::uint32_t>(mesh.triangles.size()));
  for (const Triangle& triangle : mesh.triangles) {
    const auto corner = [&](std::size_t k) -> const Point& {
      return mesh.vertices[static_cast<std::size_t>(triangle[k])];
    };
    for (const float x : unit_normal(corner(0), corner(1), corner(2)))
      append_bytes<ByteOrder::little>(bytes, x);
    for (std::size_t k = 0; k < 3; ++k)
      for (const double x : corner(k)) append_bytes<ByteOrder::little>(bytes, static_cast<float>(x));
    append_bytes<ByteOrder::little>(bytes, std::uint16_t{0});
  }
  return bytes;
}

}  // namespace souple
