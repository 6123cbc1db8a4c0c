// SPDX-License-Identifier: GPL-3.0-or-later
// glTF 2.0 in its binary container (Khronos specification, chapters 3.6 and 4.4).
#include <algorithm>

#include "tools/exchange/writers/append.hpp"
#include "tools/exchange/writers/mesh_text.hpp"

namespace souple {
namespace {

using Corner = std::array<float, 3>;

Corner rounded(const Point& p) {
  return {static_cast<float>(p[0]), static_cast<float>(p[1]), static_cast<float>(p[2])};
}

std::string corner_text(const Corner& corner) {
  std::string text = "[";
  for (std::size_t k = 0; k < 3; ++k) {
    if (k > 0) text += ',';
    append_number(text, corner[k]);
  }
  return text + "]";
}

/// glTF asks for the bounds of the positions, as stored.
std::string bounds_text(const TriangleMesh& mesh) {
  Corner low = rounded(mesh.vertices.front()), high = low;
  for (const Point& vertex : mesh.vertices)
    for (std::size_t k = 0; k < 3; ++k) {
      low[k] = std::min(low[k], rounded(vertex)[k]);
      high[k] = std::max(high[k], rounded(vertex)[k]);
    }
  return "\"min\":" + corner_text(low) + ",\"max\":" + corner_text(high);
}

std::string json_text(const TriangleMesh& mesh, std::size_t position_bytes, std::size_t index_bytes) {
  constexpr std::string_view vertex_data = "34962", index_data = "34963";  // targets of buffer views
  constexpr std::string_view float32 = "5126", uint32 = "5125";            // types of components
  const auto number = [](std::size_t value) { return std::to_string(value); };
  std::string json = R"({"asset":{"version":"2.0","generator":"souple"},"scene":0,)";
  json += R"("scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],)";
  json += R"("meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1,"mode":4}]}],)";
  json += R"("accessors":[{"bufferView":0,"componentType":)" + std::string(float32) +
          R"(,"type":"VEC3","count":)" + number(mesh.vertices.size()) + "," + bounds_text(mesh) +
          R"(},{"bufferView":1,"componentType":)" + std::string(uint32) +
          R"(,"type":"SCALAR","count":)" + number(3 * mesh.triangles.size()) + "}],";
  json += R"("bufferViews":[{"buffer":0,"byteOffset":0,"byteLength":)" + number(position_bytes) +
          R"(,"target":)" + std::string(vertex_data) + R"(},{"buffer":0,"byteOffset":)" +
          number(position_bytes) + R"(,"byteLength":)" + number(index_bytes) + R"(,"target":)" +
          std::string(index_data) + "}],";
  json += R"("buffers":[{"byteLength":)" + number(position_bytes + index_bytes) + "}]}";
  return json;
}

/// Length, kind, content, which must be a multiple of four bytes long.
void append_chunk(std::string& glb, std::uint32_t kind, std::string_view content) {
  append_bytes<ByteOrder::little>(glb, static_cast<std::uint32_t>(content.size()));
  append_bytes<ByteOrder::little>(glb, kind);
  glb += content;
}

}  // namespace

std::string glb_bytes(const TriangleMesh& mesh) {
  constexpr std::uint32_t magic = 0x46546C67, version = 2, json_kind = 0x4E4F534A,
                          bin_kind = 0x004E4942;
  const std::size_t position_bytes = 12 * mesh.vertices.size(),
                    index_bytes = 12 * mesh.triangles.size();
  std::string json = json_text(mesh, position_bytes, index_bytes);
  json.resize((json.size() + 3) / 4 * 4, ' ');
  std::string buffer;
  buffer.reserve(position_bytes + index_bytes);
  for (const Point& vertex : mesh.vertices)
    for (const float x : rounded(vertex)) append_bytes<ByteOrder::little>(buffer, x);
  for (const Triangle& triangle : mesh.triangles)
    for (const Index i : triangle)
      append_bytes<ByteOrder::little>(buffer, static_cast<std::uint32_t>(i));

  std::string glb;
  append_bytes<ByteOrder::little>(glb, magic);
  append_bytes<ByteOrder::little>(glb, version);
  append_bytes<ByteOrder::little>(glb,
                                  static_cast<std::uint32_t>(12 + 8 + json.size() + 8 + buffer.size()));
  append_chunk(glb, json_kind, json);
  append_chunk(glb, bin_kind, buffer);
  return glb;
}

}  // namespace souple
