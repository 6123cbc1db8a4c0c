// SPDX-License-Identifier: GPL-3.0-or-later
// VTK's XML unstructured grid (VTK User's Guide, "XML file formats").
#include <cmath>
#include <string>

#include "tools/exchange/numbers.hpp"
#include "tools/exchange/tets/tet_readers.hpp"
#include "tools/exchange/tets/text_cursor.hpp"
#include "tools/exchange/tets/vtk_cells.hpp"
#include "tools/exchange/tets/vtu_array.hpp"
#include "tools/exchange/tets/xml_reader.hpp"

namespace souple {
namespace {

struct Piece {
  std::size_t point_count = 0, cell_count = 0;
  std::optional<VtuArray> points, connectivity, offsets, types, labels;
  std::size_t label_rank = 1000;
};

/// The elements of the file; arrays are decoded later, when appended data are known.
class VtuDocument {
 public:
  explicit VtuDocument(std::string_view bytes) : xml_(bytes) {}

  Status read() {
    bool is_over = false;
    while (!is_over && !refusal_) {
      const XmlEvent event = xml_.next();
      if (event == XmlEvent::open) open_element();
      if (event == XmlEvent::text) add_text();
      is_over = event == XmlEvent::end || has_appended_;
    }
    if (refusal_) return *refusal_;
    if (!xml_.ok()) return xml_.issue();
    if (pieces.empty()) return malformed("the file has no <Piece> of an <UnstructuredGrid>");
    return {};
  }

  std::vector<Piece> pieces;
  VtuEncoding encoding;

 private:
  std::string_view parent() const {
    const auto& open = xml_.open_elements();
    return open.size() < 2 ? std::string_view() : open[open.size() - 2];
  }

  void open_element() {
    const std::string_view name = xml_.name();
    if (name == "DataArray") array_ = nullptr;
    if (xml_.open_elements().size() == 1)
      open_file();
    else if (name == "Piece" && parent() == "UnstructuredGrid")
      open_piece();
    else if (name == "DataArray" && !pieces.empty())
      open_array();
    else if (name == "AppendedData")
      open_appended();
  }

  void open_file() {
    if (xml_.name() != "VTKFile") return xml_.fail("the outermost element is not <VTKFile>");
    const auto type = xml_.attribute("type"), order = xml_.attribute("byte_order");
    const auto size_type = xml_.attribute("header_type"), compressor = xml_.attribute("compressor");
    if (type != "UnstructuredGrid") return refuse("only VTKFile type=\"UnstructuredGrid\" is read");
    if (order && *order != "LittleEndian" && *order != "BigEndian")
      return xml_.fail("the byte order " + quoted(*order) + " is not known");
    if (size_type && *size_type != "UInt32" && *size_type != "UInt64")
      return xml_.fail("the header type " + quoted(*size_type) + " is not known");
    if (compressor && !compressor->empty() && *compressor != "vtkZLibDataCompressor")
      return refuse("the compressor " + quoted(*compressor) + " is not read; zlib and none are");
    encoding.swap = order == "BigEndian";
    encoding.size_width = size_type == "UInt64" ? 8 : 4;
    encoding.compressed = compressor && !compressor->empty();
  }

  void open_piece() {
    Piece piece;
    piece.point_count = count_attribute("NumberOfPoints", largest_node_count);
    piece.cell_count = count_attribute("NumberOfCells", largest_cell_count);
    pieces.push_back(std::move(piece));
  }

  std::size_t count_attribute(std::string_view name, std::size_t most) {
    const auto text = xml_.attribute(name);
    const std::int64_t value = text ? parse_integer(*text).value_or(-1) : -1;
    const bool is_possible = value >= 0 && static_cast<std::uint64_t>(value) <= most;
    if (!is_possible)
      xml_.fail("the attribute " + std::string(name) + " is missing or is no possible count");
    return is_possible ? static_cast<std::size_t>(value) : 0;
  }

  /// Where an array belongs in its piece; nullptr: nobody asks for it.
  std::optional<VtuArray>* place_of(std::string_view name) {
    Piece& piece = pieces.back();
    if (parent() == "Points") return &piece.points;
    if (parent() == "Cells" && name == "connectivity") return &piece.connectivity;
    if (parent() == "Cells" && name == "offsets") return &piece.offsets;
    if (parent() == "Cells" && name == "types") return &piece.types;
    const auto rank = parent() == "CellData" ? label_rank(name) : std::nullopt;
    if (!rank || *rank >= piece.label_rank) return nullptr;
    piece.label_rank = *rank;
    piece.labels.reset();
    return &piece.labels;
  }

  void open_array() {
    const std::string name(xml_.attribute("Name").value_or(""));
    std::optional<VtuArray>* place = place_of(name);
    if (place == nullptr) return;
    if (place->has_value()) return xml_.fail("a second array " + quoted(name));
    VtuArray array;
    array.name = name;
    const auto type = vtu_number_type(xml_.attribute("type").value_or(""));
    if (!type) return xml_.fail("the type of the array " + quoted(name) + " is not known");
    array.type = *type;
    if (xml_.attribute("NumberOfComponents"))
      array.component_count = count_attribute("NumberOfComponents", 1000);
    const std::string_view format = xml_.attribute("format").value_or("ascii");
    if (format == "appended") {
      array.storage = VtuArray::Storage::appended;
      array.offset = count_attribute("offset", std::size_t{1} << 50);
    } else if (format == "binary") {
      array.storage = VtuArray::Storage::base64;
    } else if (format != "ascii") {
      return xml_.fail("the format " + quoted(format) + " of an array is not known");
    }
    array_ = &place->emplace(std::move(array));
  }

  /// Numbers may stand before or behind an <InformationKey>.
  void add_text() {
    const auto& open = xml_.open_elements();
    if (array_ == nullptr || open.empty() || open.back() != "DataArray") return;
    if (xml_.text().find_first_not_of(" \t\r\n") == std::string_view::npos) return;
    if (!array_->content.empty()) return xml_.fail("an array is broken into parts");
    array_->content = xml_.text();
  }

  void open_appended() {
    const auto how = xml_.attribute("encoding");
    if (how != "raw" && how != "base64") return xml_.fail("appended data are neither raw nor base64");
    encoding.appended_is_raw = how == "raw";
    const std::string_view rest = xml_.rest();
    const std::size_t mark = rest.find_first_not_of(" \t\r\n");
    if (mark == rest.npos || rest[mark] != '_') return xml_.fail("appended data do not begin with _");
    encoding.appended = rest.substr(mark + 1);
    has_appended_ = true;
  }

  void refuse(std::string what) { refusal_ = unsupported(std::move(what)); }

  XmlReader xml_;
  VtuArray* array_ = nullptr;  ///< of the last <DataArray>, if it is asked for
  bool has_appended_ = false;
  std::optional<Issue> refusal_;
};

Status add_points(RawMesh& mesh, const Piece& piece, const VtuEncoding& encoding) {
  if (piece.point_count == 0) return {};
  if (!piece.points || piece.points->component_count != 3)
    return malformed("a piece has no <Points> of three components");
  const auto values = vtu_reals(*piece.points, encoding, 3 * piece.point_count);
  if (!values) return values.issue();
  for (std::size_t i = 0; i < piece.point_count; ++i) {
    mesh.nodes.push_back({(*values)[3 * i], (*values)[3 * i + 1], (*values)[3 * i + 2]});
    for (const double x : mesh.nodes.back())
      if (!std::isfinite(x)) return malformed("point " + std::to_string(i) + " is not finite");
  }
  return {};
}

Result<VtkCells> read_cells(const Piece& piece, const VtuEncoding& encoding) {
  if (!piece.connectivity || !piece.offsets || !piece.types)
    return malformed("a piece lacks connectivity, offsets or types of its cells");
  auto offsets = vtu_integers(*piece.offsets, encoding, piece.cell_count);
  if (!offsets) return offsets.issue();
  auto types = vtu_integers(*piece.types, encoding, piece.cell_count);
  if (!types) return types.issue();
  offsets->insert(offsets->begin(), 0);
  const std::int64_t size = offsets->back();
  if (size < 0 || static_cast<std::uint64_t>(size) > 64 * largest_cell_count)
    return malformed("the offsets of the cells end at " + std::to_string(size));
  auto connectivity = vtu_integers(*piece.connectivity, encoding, static_cast<std::size_t>(size));
  if (!connectivity) return connectivity.issue();
  return VtkCells{std::move(*offsets), std::move(*connectivity), std::move(*types)};
}

/// Empty if the array holds something else than one integer per cell.
std::vector<std::int64_t> read_labels(const Piece& piece, const VtuEncoding& encoding) {
  if (!piece.labels || piece.labels->component_count != 1) return {};
  const auto values = vtu_reals(*piece.labels, encoding, piece.cell_count);
  std::vector<std::int64_t> labels;
  if (!values) return labels;
  for (const double value : *values)
    if (const auto whole = exact_integer(value)) labels.push_back(*whole);
  if (labels.size() != piece.cell_count) labels.clear();
  return labels;
}

}  // namespace

Result<RawMesh> read_vtu(std::string_view bytes) {
  VtuDocument document(bytes);
  if (const Status read = document.read(); !read) return read.issue();
  RawMesh mesh;
  for (const Piece& piece : document.pieces) {
    const std::size_t first_node = mesh.nodes.size();
    if (const Status added = add_points(mesh, piece, document.encoding); !added) return added.issue();
    if (mesh.nodes.size() > largest_node_count) return malformed("the pieces have too many points");
    if (piece.cell_count == 0) continue;
    const auto cells = read_cells(piece, document.encoding);
    if (!cells) return cells.issue();
    const auto labels = read_labels(piece, document.encoding);
    if (const Status added = add_vtk_cells(mesh, *cells, first_node, labels); !added)
      return added.issue();
  }
  if (mesh.labels.size() != mesh.tets.size()) mesh.labels.clear();
  mesh.format = "vtu";
  return mesh;
}

}  // namespace souple
