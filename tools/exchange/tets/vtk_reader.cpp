// SPDX-License-Identifier: GPL-3.0-or-later
// Legacy VTK (VTK User's Guide, "VTK file formats"; version 5 as vtkDataReader.cxx reads it).
#include <cmath>
#include <string>

#include "tools/exchange/tets/tet_readers.hpp"
#include "tools/exchange/tets/vtk_attributes.hpp"

namespace souple {
namespace {

class VtkReader {
 public:
  explicit VtkReader(std::string_view bytes) : numbers_(bytes), in_(numbers_.in), data_(numbers_) {}

  Result<RawMesh> read() {
    read_header();
    while (!in_.at_end()) read_section(lower_case(in_.word()));
    if (in_.ok() && !has_points_) in_.fail("the file has no points");
    if (!in_.ok()) return in_.issue();
    return finish();
  }

 private:
  void read_header() {
    constexpr std::string_view mark = "# vtk DataFile Version ";
    const std::string_view first = in_.rest_of_line();
    if (!first.starts_with(mark)) return in_.fail("the first line does not begin \"# vtk DataFile\"");
    const char major = first.size() > mark.size() ? first[mark.size()] : '?';
    if (major < '1' || major > '5')
      return in_.refuse("version " + quoted(first.substr(mark.size())) + " is not read");
    has_offsets_ = major == '5';
    in_.rest_of_line();  // title
    const std::string encoding = lower_case(in_.word());
    if (encoding != "ascii" && encoding != "binary")
      return in_.fail("found " + quoted(encoding) + " instead of ASCII or BINARY");
    numbers_.binary = encoding == "binary";
    read_dataset();
  }

  void read_dataset() {
    // A field of the whole file may stand before.
    while (in_.ok() && lower_case(in_.peek()) != "dataset") data_.read(lower_case(in_.word()));
    in_.word();
    const std::string kind = lower_case(in_.word());
    is_poly_ = kind == "polydata";
    if (!is_poly_ && kind != "unstructured_grid")
      in_.refuse("only DATASET UNSTRUCTURED_GRID and POLYDATA are read, not " + quoted(kind));
  }

  void read_section(const std::string& keyword) {
    if (keyword == "points") return read_points();
    if (keyword == "cells" && !is_poly_) return read_cells(cells_);
    if (keyword == "cell_types" && !is_poly_) return read_cell_types();
    if (is_poly_ && keyword == "polygons") return read_poly_cells(vtk_polygon);
    if (is_poly_ && keyword == "triangle_strips") return read_poly_cells(vtk_triangle_strip);
    if (is_poly_ && keyword == "lines") return read_poly_cells(vtk_poly_line);
    if (is_poly_ && keyword == "vertices") return read_poly_cells(vtk_poly_vertex);
    data_.read(keyword);
  }

  void read_points() {
    if (has_points_) return in_.fail("a second section of points");
    has_points_ = true;
    const std::size_t announced = in_.count(3, largest_node_count);
    const NumberType type = numbers_.take_type();
    const std::size_t count = numbers_.checked(3 * static_cast<std::int64_t>(announced), type) / 3;
    const std::vector<double> values = numbers_.take_reals(3 * count, type);
    if (!in_.ok()) return;
    mesh_.nodes.reserve(count);
    for (std::size_t i = 0; i < count; ++i) {
      mesh_.nodes.push_back({values[3 * i], values[3 * i + 1], values[3 * i + 2]});
      for (const double x : mesh_.nodes.back())
        if (!std::isfinite(x)) return in_.fail("point " + std::to_string(i) + " is not finite");
    }
  }

  /// Before version 5: per cell the number of its points, then the points.
  void read_counted_cells(VtkCells& cells, std::size_t count, std::size_t size) {
    const std::vector<std::int64_t> values = numbers_.take_integers(size, int32_);
    cells.offsets.push_back(0);
    std::size_t at = 0;
    for (std::size_t i = 0; i < count && in_.ok(); ++i) {
      if (at >= size || values[at] < 0 || static_cast<std::uint64_t>(values[at]) >= size - at)
        return in_.fail("cell " + std::to_string(i) + " does not fit in the list of cells");
      const auto corners = static_cast<std::ptrdiff_t>(values[at]);
      const auto begin = values.begin() + static_cast<std::ptrdiff_t>(at) + 1;
      cells.connectivity.insert(cells.connectivity.end(), begin, begin + corners);
      cells.offsets.push_back(static_cast<std::int64_t>(cells.connectivity.size()));
      at += static_cast<std::size_t>(corners) + 1;
    }
    if (at != size) in_.fail("the list of cells is longer than its cells");
  }

  std::vector<std::int64_t> take_named(std::string_view name, std::size_t announced) {
    if (lower_case(in_.word()) != name) in_.fail("the word " + std::string(name) + " is missing");
    const NumberType type = numbers_.take_type();
    return numbers_.take_integers(numbers_.checked(static_cast<std::int64_t>(announced), type), type);
  }

  /// Version 5 counts the offsets, one more than cells; before, the cells were counted.
  void read_cells(VtkCells& cells) {
    if (!cells.offsets.empty()) return in_.fail("a second section of cells");
    const std::size_t count = in_.count(numbers_.binary ? 4 : 2, largest_cell_count);
    const std::size_t size = in_.count(numbers_.binary ? 4 : 2, VtkNumbers::most_values);
    if (!has_offsets_) return read_counted_cells(cells, count, size);
    if (count > 0) {
      cells.offsets = take_named("offsets", count);
      cells.connectivity = take_named("connectivity", size);
    }
    if (cells.offsets.empty()) cells.offsets.push_back(0);
  }

  void read_cell_types() { cells_.types = numbers_.take_integers(numbers_.take_count(int32_), int32_); }

  void read_poly_cells(std::int64_t type) {
    VtkCells cells;
    read_cells(cells);
    if (!in_.ok()) return;
    cells.types.assign(cells.offsets.size() - 1, type);
    const Status added = add_vtk_cells(mesh_, cells, 0, {});
    if (!added) in_.fail(added.issue().what);
  }

  Result<RawMesh> finish() {
    if (!is_poly_ && !cells_.offsets.empty()) {
      const bool has_labels = data_.labels().size() == cells_.types.size();
      const Status added =
          add_vtk_cells(mesh_, cells_, 0, has_labels ? data_.labels() : std::vector<std::int64_t>());
      if (!added) return added.issue();
    }
    mesh_.format = std::string("vtk ") + (has_offsets_ ? "5" : "legacy") +
                   (numbers_.binary ? " binary" : " ascii");
    return std::move(mesh_);
  }

  static constexpr NumberType int32_{NumberKind::signed_integer, 4};
  VtkNumbers numbers_;
  TextCursor& in_;
  VtkAttributes data_;
  RawMesh mesh_;
  VtkCells cells_;
  bool is_poly_ = false, has_offsets_ = false, has_points_ = false;
};

}  // namespace

Result<RawMesh> read_vtk(std::string_view bytes) { return VtkReader(bytes).read(); }

}  // namespace souple
