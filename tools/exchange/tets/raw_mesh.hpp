// SPDX-License-Identifier: GPL-3.0-or-later
// What a reader of a tet file hands on: the content in the file's own numbers, checked for what cannot
// be checked later (indices in range, finite numbers).
#pragma once
#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "formats/core/mesh.hpp"
#include "formats/core/result.hpp"

namespace souple {

struct RawMesh {
  std::string format;  ///< "gmsh 4.1 binary"
  std::vector<Point> nodes;
  std::vector<Tet> tets;                                          ///< as wound in the file
  std::vector<Triangle> triangles;                                ///< quads and strips split
  std::vector<std::int64_t> labels;                               ///< one per tet, or empty
  std::vector<std::pair<std::int64_t, std::string>> label_names;  ///< of some labels
  std::size_t volume_cell_count = 0;  ///< hexahedra, prisms, pyramids …: left out
  std::size_t other_cell_count = 0;   ///< points, lines …: left out
  std::size_t linearised_count = 0;   ///< tets of higher order
};

enum class CellKind : std::uint8_t { tet, triangle, quad, volume, other };

/// A kind of cell in a format's table; the corners come first in every format read here.
struct CellType {
  CellKind kind = CellKind::other;
  int node_count = 0;
};

/// Files with more are refused; nodes, and corners of cells, must be countable by Index.
inline constexpr std::size_t largest_node_count = std::size_t{1} << 30;
inline constexpr std::size_t largest_cell_count = std::size_t{1} << 28;

inline Issue malformed(std::string what) {
  return make_issue(IssueCode::tet_file_malformed, std::move(what));
}
inline Issue unsupported(std::string what) {
  return make_issue(IssueCode::tet_file_unsupported, std::move(what));
}

/// Adds a cell whose corners were checked; returns whether it was a tet.
bool add_cell(RawMesh& mesh, const CellType& type, const std::vector<Index>& nodes);

}  // namespace souple
