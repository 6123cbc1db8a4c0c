// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/surface/soup_transfer.hpp"

#include <algorithm>
#include <cstdint>
#include <cstring>

#include "tools/geometry/vector.hpp"
#include "tools/process/child_answer.hpp"

namespace souple {
namespace {

/// Native byte order: both ends are one program.
struct Counts {
  std::uint64_t vertices;
  std::uint64_t triangles;
  std::uint64_t raw_vertices;
  std::uint64_t raw_polygons;
  std::uint64_t lost_triangles;
};

template <class T>
void append_values(std::string& out, const std::vector<T>& values) {
  out.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T));
}

template <class T>
void take_values(std::string_view& bytes, std::size_t count, std::vector<T>& values) {
  values.resize(count);
  if (count > 0) std::memcpy(values.data(), bytes.data(), count * sizeof(T));
  bytes.remove_prefix(count * sizeof(T));
}

Issue damaged() {
  return make_issue(IssueCode::surface_reader_crashed, "the reader's answer is damaged");
}

bool is_sound(const TriangleMesh& mesh) {
  const auto count = static_cast<Index>(mesh.vertices.size());
  return std::ranges::all_of(mesh.vertices, is_finite) &&
         std::ranges::all_of(mesh.triangles, [&](const Triangle& t) {
           return std::ranges::all_of(t, [&](Index i) { return i >= 0 && i < count; });
         });
}

std::string pack_soup(const TriangleSoup& soup) {
  const Counts counts{soup.mesh.vertices.size(), soup.mesh.triangles.size(), soup.raw_vertex_count,
                      soup.raw_polygon_count, soup.lost_triangle_count};
  std::string out(reinterpret_cast<const char*>(&counts), sizeof counts);
  append_values(out, soup.mesh.vertices);
  append_values(out, soup.mesh.triangles);
  return out;
}

Result<TriangleSoup> unpack_soup(std::string_view bytes) {
  Counts counts;
  if (bytes.size() < sizeof counts) return damaged();
  std::memcpy(&counts, bytes.data(), sizeof counts);
  bytes.remove_prefix(sizeof counts);
  const std::uint64_t most = bytes.size();  // no count can exceed the bytes, so no product overflows
  if (counts.vertices > most || counts.triangles > most ||
      counts.vertices * sizeof(Point) + counts.triangles * sizeof(Triangle) != most)
    return damaged();
  TriangleSoup soup;
  take_values(bytes, counts.vertices, soup.mesh.vertices);
  take_values(bytes, counts.triangles, soup.mesh.triangles);
  soup.raw_vertex_count = counts.raw_vertices;
  soup.raw_polygon_count = counts.raw_polygons;
  soup.lost_triangle_count = counts.lost_triangles;
  if (!is_sound(soup.mesh)) return damaged();
  return soup;
}

}  // namespace

std::string pack_answer(const Result<TriangleSoup>& answer) {
  return seal_answer(answer ? Result<std::string>(pack_soup(*answer)) : answer.issue());
}

Result<TriangleSoup> unpack_answer(std::string_view bytes) {
  const Result<std::string_view> answer = open_answer(bytes);
  if (!answer) return answer.issue();
  return unpack_soup(*answer);
}

}  // namespace souple
