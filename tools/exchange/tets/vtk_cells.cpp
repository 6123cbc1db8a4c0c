// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/exchange/tets/vtk_cells.hpp"

#include <algorithm>
#include <array>
#include <span>

#include "tools/exchange/tets/text_cursor.hpp"

namespace souple {
namespace {

using Corners = std::span<const std::int64_t>;

/// Least number of points, for the types with a fixed or a least number.
CellType cell_type(std::int64_t type) {
  using enum CellKind;
  switch (type) {
    case 5:   // triangle
    case 69:  // Lagrange triangle, of any order
    case 76:  // Bézier triangle
      return {triangle, 3};
    case 22:  // quadratic triangle
    case 34:  // biquadratic triangle
      return {triangle, 6};
    case 9:  // quad
      return {quad, 4};
    case 10:  // tetra
    case 71:  // Lagrange tetrahedron, of any order
    case 78:  // Bézier tetrahedron
      return {tet, 4};
    case 24:  // quadratic tetra
      return {tet, 10};
    // voxel, hexahedron, wedge, pyramid, prisms, their higher orders, polyhedron
    case 11:
    case 12:
    case 13:
    case 14:
    case 15:
    case 16:
    case 25:
    case 26:
    case 27:
    case 29:
    case 31:
    case 32:
    case 33:
    case 37:
    case 42:
    case 72:
    case 73:
    case 74:
    case 79:
    case 80:
    case 81:
      return {volume, 0};
    default:
      return {other, 0};
  }
}

class CellAdder {
 public:
  CellAdder(RawMesh& mesh, std::size_t first_node)
      : mesh_(mesh), first_(first_node), count_(mesh.nodes.size() - first_node) {}

  /// False: a point or the number of points is wrong.
  bool add(std::int64_t type, Corners points) {
    nodes_.clear();
    for (const std::int64_t point : points) {
      if (point < 0 || static_cast<std::uint64_t>(point) >= count_) return false;
      nodes_.push_back(static_cast<Index>(first_ + static_cast<std::size_t>(point)));
    }
    if (type == vtk_triangle_strip) return add_strip();
    if (type == vtk_polygon) return add_polygon();
    if (type == vtk_pixel) return add_pixel();
    CellType cell = cell_type(type);
    if (nodes_.size() < static_cast<std::size_t>(cell.node_count)) return false;
    cell.node_count = static_cast<int>(nodes_.size());
    add_cell(mesh_, cell, nodes_);
    return true;
  }

 private:
  /// A quad with its points in rows.
  bool add_pixel() {
    if (nodes_.size() != 4) return false;
    std::swap(nodes_[2], nodes_[3]);
    add_cell(mesh_, {CellKind::quad, 4}, nodes_);
    return true;
  }

  bool add_polygon() {
    if (nodes_.size() < 3) return false;
    for (std::size_t k = 2; k < nodes_.size(); ++k)
      mesh_.triangles.push_back({nodes_[0], nodes_[k - 1], nodes_[k]});
    return true;
  }

  /// Every second triangle runs the other way round.
  bool add_strip() {
    if (nodes_.size() < 3) return false;
    for (std::size_t k = 2; k < nodes_.size(); ++k) {
      const std::size_t odd = k % 2;
      mesh_.triangles.push_back({nodes_[k - 2 + odd], nodes_[k - 1 - odd], nodes_[k]});
    }
    return true;
  }

  RawMesh& mesh_;
  std::size_t first_, count_;
  std::vector<Index> nodes_;
};

bool are_sound_offsets(const VtkCells& cells) {
  return cells.offsets.size() == cells.types.size() + 1 && cells.offsets.front() == 0 &&
         std::ranges::is_sorted(cells.offsets) &&
         static_cast<std::uint64_t>(cells.offsets.back()) == cells.connectivity.size();
}

}  // namespace

Status add_vtk_cells(RawMesh& mesh, const VtkCells& cells, std::size_t first_node,
                     const std::vector<std::int64_t>& labels) {
  if (!are_sound_offsets(cells)) return malformed("the offsets of the cells do not fit their points");
  CellAdder adder(mesh, first_node);
  const Corners all(cells.connectivity);
  for (std::size_t i = 0; i < cells.types.size(); ++i) {
    const auto begin = static_cast<std::size_t>(cells.offsets[i]);
    const auto end = static_cast<std::size_t>(cells.offsets[i + 1]);
    const std::size_t tets_before = mesh.tets.size();
    if (!adder.add(cells.types[i], all.subspan(begin, end - begin)))
      return malformed("cell " + std::to_string(i) + " of type " + std::to_string(cells.types[i]) +
                       " has too few points or names one that is not there");
    if (mesh.tets.size() > tets_before && !labels.empty()) mesh.labels.push_back(labels[i]);
  }
  return {};
}

std::optional<std::size_t> label_rank(std::string_view name) {
  // What gmsh, medit and TetGen converters, Exodus, ParaView and FEniCS call it.
  static constexpr std::array<std::string_view, 20> names{
      "region",       "gmsh:physical", "medit:ref",   "tetgen:ref", "materialids",
      "material_ids", "materialid",    "material_id", "material",   "materials",
      "region_id",    "regionid",      "regions",     "label",      "labels",
      "cell_tags",    "physical",      "attribute",   "objectid",   "cellentityids"};
  const auto* found = std::ranges::find(names, std::string_view(lower_case(name)));
  if (found == names.end()) return std::nullopt;
  return static_cast<std::size_t>(found - names.begin());
}

}  // namespace souple
