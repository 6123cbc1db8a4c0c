// SPDX-License-Identifier: GPL-3.0-or-later
// What legacy VTK and VTU share: cell types (vtkCellType.h), number types, labels among cell data.
#pragma once
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "tools/exchange/tets/number_type.hpp"
#include "tools/exchange/tets/raw_mesh.hpp"

namespace souple {

inline constexpr std::int64_t vtk_poly_vertex = 2, vtk_poly_line = 4, vtk_triangle_strip = 6,
                              vtk_polygon = 7, vtk_pixel = 8;

/// Cells in VTK's layout: cell i has the points connectivity[offsets[i] … offsets[i + 1]).
struct VtkCells {
  std::vector<std::int64_t> offsets;  ///< one more than cells, from 0
  std::vector<std::int64_t> connectivity;
  std::vector<std::int64_t> types;
};

/// Adds the cells to the mesh; their points count from `first_node`. Labels are those of all cells, or
/// empty. Issues: tet_file_malformed (offsets, points, number of corners).
Status add_vtk_cells(RawMesh& mesh, const VtkCells& cells, std::size_t first_node,
                     const std::vector<std::int64_t>& labels);

/// How good a name of cell data is for the regions, 0 best; nothing: it is about something else.
std::optional<std::size_t> label_rank(std::string_view name);

/// Rows of cell data that may hold the regions; the best one so far is kept.
struct VtkLabels {
  std::size_t rank = 1000;
  std::vector<std::int64_t> values;

  /// `values`: one per cell.
  void offer(std::size_t new_rank, std::vector<std::int64_t> new_values) {
    if (new_rank >= rank) return;
    rank = new_rank;
    values = std::move(new_values);
  }
};

}  // namespace souple
