// SPDX-License-Identifier: GPL-3.0-or-later
// Medit's .mesh (INRIA RT-0253): keywords with counts, rows of numbers, comments behind '#'.
#include <algorithm>
#include <array>
#include <string>

#include "tools/exchange/tets/tet_readers.hpp"
#include "tools/exchange/tets/text_cursor.hpp"

namespace souple {
namespace {

struct CellKeyword {
  std::string_view name;
  CellType type;
};
constexpr std::array<CellKeyword, 10> cell_keywords{{{"Tetrahedra", {CellKind::tet, 4}},
                                                     {"TetrahedraP2", {CellKind::tet, 10}},
                                                     {"Triangles", {CellKind::triangle, 3}},
                                                     {"TrianglesP2", {CellKind::triangle, 6}},
                                                     {"Quadrilaterals", {CellKind::quad, 4}},
                                                     {"Edges", {CellKind::other, 2}},
                                                     {"Hexahedra", {CellKind::volume, 8}},
                                                     {"Hexaedra", {CellKind::volume, 8}},
                                                     {"Prisms", {CellKind::volume, 6}},
                                                     {"Pyramids", {CellKind::volume, 5}}}};

class MeditReader {
 public:
  explicit MeditReader(std::string_view bytes) : in_(bytes, {.hash_comments = true}) {}

  Result<RawMesh> read() {
    if (in_.peek() != "MeshVersionFormatted")
      return malformed("the file begins with " + quoted(in_.peek()) +
                       " instead of MeshVersionFormatted");
    in_.word();
    in_.integer();  // width of the program's numbers
    while (!in_.at_end() && !is_over_) read_section(in_.word());
    if (in_.ok() && !has_vertices_) in_.fail("the file has no vertices");
    if (!in_.ok()) return in_.issue();
    if (std::ranges::all_of(mesh_.labels, [](std::int64_t label) { return label == 0; }))
      mesh_.labels.clear();
    mesh_.format = "medit ascii";
    return std::move(mesh_);
  }

 private:
  void read_section(std::string_view keyword) {
    const auto* cells = std::ranges::find(cell_keywords, keyword, &CellKeyword::name);
    if (cells != cell_keywords.end())
      read_cells(cells->type);
    else if (keyword == "Vertices")
      read_vertices();
    else if (keyword == "Dimension")
      read_dimension();
    else if (keyword == "End")
      is_over_ = true;
    else if (is_keyword(keyword))
      skip_numbers();
    else
      in_.fail("found " + quoted(keyword) + " where a keyword should stand");
  }

  void read_dimension() {
    if (in_.integer() != 3) in_.refuse("meshes in another dimension than 3 are not read");
  }

  void read_vertices() {
    if (has_vertices_) return in_.fail("a second section of vertices");
    has_vertices_ = true;
    const std::size_t count = in_.count(8, largest_node_count);
    mesh_.nodes.reserve(count);
    for (std::size_t i = 0; i < count && in_.ok(); ++i) {
      const double x = in_.number(), y = in_.number(), z = in_.number();
      in_.integer();  // reference
      mesh_.nodes.push_back({x, y, z});
    }
  }

  void read_cells(const CellType& type) {
    if (!has_vertices_) return in_.fail("cells stand before the vertices");
    const std::size_t count =
        in_.count(2 * static_cast<std::size_t>(type.node_count + 1), largest_cell_count);
    std::vector<Index> nodes;
    for (std::size_t i = 0; i < count && in_.ok(); ++i) {
      nodes.clear();
      for (int k = 0; k < type.node_count && in_.ok(); ++k) nodes.push_back(take_vertex());
      const std::int64_t reference = in_.integer();
      if (in_.ok() && add_cell(mesh_, type, nodes)) mesh_.labels.push_back(reference);
    }
  }

  Index take_vertex() {
    const std::int64_t number = in_.integer();
    if (in_.ok() && (number < 1 || static_cast<std::uint64_t>(number) > mesh_.nodes.size()))
      in_.fail("a cell names vertex " + std::to_string(number) + " of " +
               std::to_string(mesh_.nodes.size()));
    return static_cast<Index>(number - 1);
  }

  static bool is_keyword(std::string_view word) {
    return !word.empty() && ((word[0] >= 'A' && word[0] <= 'Z') || (word[0] >= 'a' && word[0] <= 'z'));
  }

  /// Ridges, corners, normals …: rows of numbers up to the next keyword.
  void skip_numbers() {
    while (!in_.at_end() && !is_keyword(in_.peek())) in_.number();
  }

  TextCursor in_;
  RawMesh mesh_;
  bool has_vertices_ = false;
  bool is_over_ = false;
};

}  // namespace

Result<RawMesh> read_medit(std::string_view bytes) { return MeditReader(bytes).read(); }

}  // namespace souple
