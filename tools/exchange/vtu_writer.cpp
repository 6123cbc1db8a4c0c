// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/exchange/vtu_writer.hpp"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstring>
#include <string_view>

#include "tools/exchange/atomic_file.hpp"
#include "tools/exchange/base64.hpp"
#include "tools/exchange/numbers.hpp"

namespace souple {
namespace {

static_assert(std::endian::native == std::endian::little, "the arrays are written as they lie");

// Cell types of VTK's vtkCellType.h.
constexpr std::uint8_t vtk_triangle = 5;
constexpr std::uint8_t vtk_tetra = 10;

/// <DataArray> with its bytes; VTK encodes the byte count and the data as one base64 stream.
template <class T>
void append_array(std::string& text, std::string_view type, std::string_view name, int component_count,
                  const std::vector<T>& values) {
  text += "<DataArray type=\"" + std::string(type) + "\" Name=\"" + xml_escaped(name) +
          "\" NumberOfComponents=\"" + std::to_string(component_count) + "\" format=\"binary\">";
  const std::uint64_t size = values.size() * sizeof(T);
  std::vector<std::byte> bytes(sizeof size + size);
  std::memcpy(bytes.data(), &size, sizeof size);
  if (size > 0) std::memcpy(bytes.data() + sizeof size, values.data(), size);
  append_base64(text, bytes);
  text += "</DataArray>\n";
}

std::vector<double> flat(std::span<const Point> rows) {
  std::vector<double> values;
  values.reserve(3 * rows.size());
  for (const Point& row : rows) values.insert(values.end(), row.begin(), row.end());
  return values;
}

void append_cells(std::string& text, const VtuMesh& mesh) {
  std::vector<std::int32_t> connectivity, offsets;
  std::vector<std::uint8_t> types(mesh.triangles.size(), vtk_triangle);
  types.resize(mesh.cell_count(), vtk_tetra);
  for (const Triangle& t : mesh.triangles) {
    connectivity.insert(connectivity.end(), t.begin(), t.end());
    offsets.push_back(static_cast<std::int32_t>(connectivity.size()));
  }
  for (const Tet& t : mesh.tets) {
    connectivity.insert(connectivity.end(), t.begin(), t.end());
    offsets.push_back(static_cast<std::int32_t>(connectivity.size()));
  }
  text += "<Cells>\n";
  append_array(text, "Int32", "connectivity", 1, connectivity);
  append_array(text, "Int32", "offsets", 1, offsets);
  append_array(text, "UInt8", "types", 1, types);
  text += "</Cells>\n";
}

void append_fields(std::string& text, const std::vector<VtuField>& fields) {
  text += "<PointData>\n";
  for (const VtuField& field : fields)
    append_array(text, "Float64", field.name, field.component_count, field.values);
  text += "</PointData>\n";
}

/// Cells that are no tets, or whose mesh has no regions.
constexpr Index no_region = -1;

void append_regions(std::string& text, const VtuMesh& mesh) {
  if (mesh.tet_regions.empty()) return;
  std::vector<std::int32_t> regions(mesh.triangles.size(), no_region);
  regions.insert(regions.end(), mesh.tet_regions.begin(), mesh.tet_regions.end());
  text += "<CellData>\n";
  append_array(text, "Int32", "region", 1, regions);
  text += "</CellData>\n";
}

Status check_fields(const std::vector<VtuField>& fields, std::size_t row_count) {
  for (const VtuField& field : fields)
    if (field.component_count < 1 ||
        field.values.size() != row_count * static_cast<std::size_t>(field.component_count))
      return make_issue(IssueCode::vtu_mesh_invalid,
                        "the field has " + std::to_string(field.values.size()) + " values for " +
                            std::to_string(row_count) + " rows of " +
                            std::to_string(field.component_count),
                        field.name);
  return {};
}

template <class Cell>
Status check_cells(const std::vector<Cell>& cells, std::size_t point_count) {
  for (std::size_t i = 0; i < cells.size(); ++i)
    for (const Index node : cells[i])
      if (node < 0 || static_cast<std::size_t>(node) >= point_count)
        return make_issue(IssueCode::vtu_mesh_invalid, "cell " + std::to_string(i) + " names point " +
                                                           std::to_string(node) + " of " +
                                                           std::to_string(point_count));
  return {};
}

Status check_mesh(const VtuMesh& mesh) {
  // Offsets count the corners of all cells in 32 bits.
  constexpr std::size_t cell_limit = std::size_t{1} << 29;
  if (mesh.cell_count() >= cell_limit)
    return make_issue(IssueCode::vtu_mesh_invalid,
                      std::to_string(mesh.cell_count()) + " cells are too many for one file");
  if (auto status = check_cells(mesh.triangles, mesh.points.size()); !status) return status;
  if (auto status = check_cells(mesh.tets, mesh.points.size()); !status) return status;
  if (!mesh.tet_regions.empty() && mesh.tet_regions.size() != mesh.tets.size())
    return make_issue(IssueCode::vtu_mesh_invalid, std::to_string(mesh.tet_regions.size()) +
                                                       " regions for " +
                                                       std::to_string(mesh.tets.size()) + " tets");
  return check_fields(mesh.fields, mesh.points.size());
}

void append_fields_of(std::vector<VtuField>& fields, std::size_t rows,
                      const std::vector<VtuField>& added, std::size_t added_rows) {
  const auto matches = [](const VtuField& field) {
    return [&field](const VtuField& other) {
      return other.name == field.name && other.component_count == field.component_count;
    };
  };
  for (const VtuField& field : added)
    if (std::ranges::none_of(fields, matches(field)))
      fields.push_back({field.name, field.component_count,
                        std::vector<double>(rows * static_cast<std::size_t>(field.component_count))});
  for (VtuField& field : fields) {
    const auto found = std::ranges::find_if(added, matches(field));
    if (found != added.end())
      field.values.insert(field.values.end(), found->values.begin(), found->values.end());
    else
      field.values.resize((rows + added_rows) * static_cast<std::size_t>(field.component_count));
  }
}

}  // namespace

VtuField vector_field(std::string name, std::span<const Point> rows) {
  return {std::move(name), 3, flat(rows)};
}

void append_mesh(VtuMesh& mesh, const VtuMesh& part) {
  append_fields_of(mesh.fields, mesh.points.size(), part.fields, part.points.size());
  if (!mesh.tet_regions.empty() || !part.tet_regions.empty()) {
    mesh.tet_regions.resize(mesh.tets.size(), no_region);
    mesh.tet_regions.insert(mesh.tet_regions.end(), part.tet_regions.begin(), part.tet_regions.end());
    mesh.tet_regions.resize(mesh.tets.size() + part.tets.size(), no_region);
  }
  const auto shift = static_cast<Index>(mesh.points.size());
  mesh.points.insert(mesh.points.end(), part.points.begin(), part.points.end());
  for (Triangle t : part.triangles) {
    for (Index& node : t) node += shift;
    mesh.triangles.push_back(t);
  }
  for (Tet t : part.tets) {
    for (Index& node : t) node += shift;
    mesh.tets.push_back(t);
  }
}

Result<std::string> vtu_text(const VtuMesh& mesh) {
  if (auto status = check_mesh(mesh); !status) return status.issue();
  std::string text =
      "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" "
      "byte_order=\"LittleEndian\" header_type=\"UInt64\">\n<UnstructuredGrid>\n";
  text += "<Piece NumberOfPoints=\"" + std::to_string(mesh.points.size()) + "\" NumberOfCells=\"" +
          std::to_string(mesh.cell_count()) + "\">\n";
  append_fields(text, mesh.fields);
  append_regions(text, mesh);
  text += "<Points>\n";
  append_array(text, "Float64", "Points", 3, flat(mesh.points));
  text += "</Points>\n";
  append_cells(text, mesh);
  text += "</Piece>\n</UnstructuredGrid>\n</VTKFile>\n";
  return text;
}

Status write_vtu(const VtuMesh& mesh, const std::filesystem::path& file) {
  const auto text = vtu_text(mesh);
  if (!text) return text.issue();
  return write_file_atomically(file, *text);
}

std::string pvd_text(std::span<const PvdEntry> entries) {
  std::string text =
      "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"1.0\" "
      "byte_order=\"LittleEndian\">\n<Collection>\n";
  for (const PvdEntry& entry : entries)
    text += "<DataSet timestep=\"" + exact_text(entry.time_s) + "\" part=\"" +
            std::to_string(entry.part) + "\" name=\"" + xml_escaped(entry.name) + "\" file=\"" +
            xml_escaped(entry.file) + "\"/>\n";
  return text + "</Collection>\n</VTKFile>\n";
}

std::string xml_escaped(std::string_view text) {
  std::string escaped;
  for (const char c : text) {
    switch (c) {
      case '&':
        escaped += "&amp;";
        break;
      case '<':
        escaped += "&lt;";
        break;
      case '>':
        escaped += "&gt;";
        break;
      case '"':
        escaped += "&quot;";
        break;
      case '\'':
        escaped += "&apos;";
        break;
      default:
        escaped += c;
    }
  }
  return escaped;
}

}  // namespace souple
