// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/surface/soup_transfer.hpp"

#define XXH_INLINE_ALL
#include <xxhash.h>

#include <algorithm>
#include <cstdint>
#include <cstring>

#include "tools/geometry/vector.hpp"

namespace souple {
namespace {

constexpr std::uint64_t magic = 0x3150554f53504c53;
constexpr std::size_t longest_text = 1000;

/// Native byte order: both ends are one program.
struct Header {
  std::uint64_t magic;
  std::uint64_t issue_code;  ///< 0: a soup follows, else the text of the issue
  std::uint64_t text_bytes;
  std::uint64_t vertex_count;
  std::uint64_t triangle_count;
  std::uint64_t raw_vertex_count;
  std::uint64_t raw_polygon_count;
  std::uint64_t lost_triangle_count;
  std::uint64_t checksum;  ///< XXH3 of everything after the header
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

Issue unpack_issue(const Header& header, std::string_view text) {
  const IssueEntry* entry = find_issue_entry(std::to_string(header.issue_code));
  if (entry == nullptr || text.size() != header.text_bytes) return damaged();
  std::string printable(text.substr(0, longest_text));
  std::ranges::replace_if(
      printable, [](unsigned char c) { return c < 32 || c == 127; }, ' ');
  return make_issue(entry->code, printable);
}

bool is_sound(const TriangleMesh& mesh) {
  const auto count = static_cast<Index>(mesh.vertices.size());
  return std::ranges::all_of(mesh.vertices, is_finite) &&
         std::ranges::all_of(mesh.triangles, [&](const Triangle& t) {
           return std::ranges::all_of(t, [&](Index i) { return i >= 0 && i < count; });
         });
}

}  // namespace

std::string pack_answer(const Result<TriangleSoup>& answer) {
  Header header{};
  header.magic = magic;
  std::string body;
  if (!answer) {
    header.issue_code = static_cast<std::uint64_t>(answer.issue().code);
    body = answer.issue().what.substr(0, longest_text);
    header.text_bytes = body.size();
  } else {
    header.vertex_count = answer->mesh.vertices.size();
    header.triangle_count = answer->mesh.triangles.size();
    header.raw_vertex_count = answer->raw_vertex_count;
    header.raw_polygon_count = answer->raw_polygon_count;
    header.lost_triangle_count = answer->lost_triangle_count;
    append_values(body, answer->mesh.vertices);
    append_values(body, answer->mesh.triangles);
  }
  header.checksum = XXH3_64bits(body.data(), body.size());
  std::string out(reinterpret_cast<const char*>(&header), sizeof header);
  return out += body;
}

Result<TriangleSoup> unpack_answer(std::string_view bytes) {
  Header header;
  if (bytes.size() < sizeof header) return damaged();
  std::memcpy(&header, bytes.data(), sizeof header);
  bytes.remove_prefix(sizeof header);
  if (header.magic != magic || header.checksum != XXH3_64bits(bytes.data(), bytes.size()))
    return damaged();
  if (header.issue_code != 0) return unpack_issue(header, bytes);
  const std::uint64_t most = bytes.size();  // no count can exceed the bytes, so no product overflows
  if (header.vertex_count > most || header.triangle_count > most ||
      header.vertex_count * sizeof(Point) + header.triangle_count * sizeof(Triangle) != most)
    return damaged();
  TriangleSoup soup;
  take_values(bytes, header.vertex_count, soup.mesh.vertices);
  take_values(bytes, header.triangle_count, soup.mesh.triangles);
  soup.raw_vertex_count = header.raw_vertex_count;
  soup.raw_polygon_count = header.raw_polygon_count;
  soup.lost_triangle_count = header.lost_triangle_count;
  if (!is_sound(soup.mesh)) return damaged();
  return soup;
}

}  // namespace souple
