// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/exchange/tets/mesh_transfer.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace souple {
namespace {

/// Native byte order: both ends are one program.
struct Counts {
  std::uint64_t nodes, tets, triangles, labels;
  std::uint64_t names, text_bytes;  ///< label names, and the bytes of all texts
  std::uint64_t format_bytes;
  std::uint64_t volume_cells, other_cells, linearised;
};

struct NameEntry {
  std::int64_t label;
  std::uint64_t bytes;
};

template <class T>
void append(std::string& out, const std::vector<T>& values) {
  out.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T));
}

/// Nothing but what was checked to be there may be asked for.
template <class T>
std::vector<T> take(std::string_view& bytes, std::uint64_t count) {
  std::vector<T> values(count);
  if (count > 0) std::memcpy(values.data(), bytes.data(), count * sizeof(T));
  bytes.remove_prefix(count * sizeof(T));
  return values;
}

bool fits(const Counts& counts, std::uint64_t size) {
  std::uint64_t left = size;
  const auto holds = [&](std::uint64_t count, std::uint64_t bytes) {
    if (count > left / bytes) return false;
    left -= count * bytes;
    return true;
  };
  return holds(counts.nodes, sizeof(Point)) && holds(counts.tets, sizeof(Tet)) &&
         holds(counts.triangles, sizeof(Triangle)) && holds(counts.labels, sizeof(std::int64_t)) &&
         holds(counts.names, sizeof(NameEntry)) && holds(counts.text_bytes, 1) && left == 0 &&
         counts.format_bytes <= counts.text_bytes && counts.nodes <= largest_node_count &&
         (counts.labels == 0 || counts.labels == counts.tets);
}

template <class Cells>
bool are_in_range(const Cells& cells, std::size_t node_count) {
  return std::ranges::all_of(cells, [&](const auto& cell) {
    return std::ranges::all_of(
        cell, [&](Index i) { return i >= 0 && static_cast<std::size_t>(i) < node_count; });
  });
}

bool is_sound(const RawMesh& mesh) {
  const auto is_finite = [](const Point& p) {
    return std::isfinite(p[0]) && std::isfinite(p[1]) && std::isfinite(p[2]);
  };
  return std::ranges::all_of(mesh.nodes, is_finite) && are_in_range(mesh.tets, mesh.nodes.size()) &&
         are_in_range(mesh.triangles, mesh.nodes.size());
}

bool take_texts(std::string_view text, const std::vector<NameEntry>& names, std::size_t format_bytes,
                RawMesh& mesh) {
  mesh.format = text.substr(0, format_bytes);
  text.remove_prefix(format_bytes);
  for (const NameEntry& name : names) {
    if (name.bytes > text.size()) return false;
    mesh.label_names.emplace_back(name.label, text.substr(0, name.bytes));
    text.remove_prefix(name.bytes);
  }
  return text.empty();
}

}  // namespace

std::string pack_raw_mesh(const RawMesh& mesh) {
  std::vector<NameEntry> names;
  std::string text = mesh.format;
  for (const auto& [label, name] : mesh.label_names) {
    names.push_back({label, name.size()});
    text += name;
  }
  const Counts counts{mesh.nodes.size(),    mesh.tets.size(),       mesh.triangles.size(),
                      mesh.labels.size(),   names.size(),           text.size(),
                      mesh.format.size(),   mesh.volume_cell_count, mesh.other_cell_count,
                      mesh.linearised_count};
  std::string out(reinterpret_cast<const char*>(&counts), sizeof counts);
  append(out, mesh.nodes);
  append(out, mesh.tets);
  append(out, mesh.triangles);
  append(out, mesh.labels);
  append(out, names);
  return out += text;
}

Result<RawMesh> unpack_raw_mesh(std::string_view bytes) {
  const Issue damaged = make_issue(IssueCode::surface_reader_crashed, "the reader's answer is damaged");
  Counts counts;
  if (bytes.size() < sizeof counts) return damaged;
  std::memcpy(&counts, bytes.data(), sizeof counts);
  bytes.remove_prefix(sizeof counts);
  if (!fits(counts, bytes.size())) return damaged;
  RawMesh mesh;
  mesh.nodes = take<Point>(bytes, counts.nodes);
  mesh.tets = take<Tet>(bytes, counts.tets);
  mesh.triangles = take<Triangle>(bytes, counts.triangles);
  mesh.labels = take<std::int64_t>(bytes, counts.labels);
  const std::vector<NameEntry> names = take<NameEntry>(bytes, counts.names);
  mesh.volume_cell_count = counts.volume_cells;
  mesh.other_cell_count = counts.other_cells;
  mesh.linearised_count = counts.linearised;
  if (!take_texts(bytes, names, counts.format_bytes, mesh) || !is_sound(mesh)) return damaged;
  return mesh;
}

}  // namespace souple
