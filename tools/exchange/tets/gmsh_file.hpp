// SPDX-License-Identifier: GPL-3.0-or-later
// What the readers of gmsh's sections share. Format: gmsh reference manual, "MSH file format" and
// "Legacy formats".
#pragma once
#include <map>
#include <string_view>
#include <vector>

#include "tools/exchange/tets/node_tags.hpp"
#include "tools/exchange/tets/number_type.hpp"
#include "tools/exchange/tets/raw_mesh.hpp"
#include "tools/exchange/tets/text_cursor.hpp"

namespace souple {

enum class GmshVersion : std::uint8_t { v1, v2, v4_0, v4_1 };

struct GmshFile {
  explicit GmshFile(std::string_view bytes) : in(bytes) {}

  TextCursor in;
  GmshVersion version = GmshVersion::v1;
  bool binary = false;
  bool swap = false;  ///< the binary numbers are big-endian

  RawMesh mesh;
  NodeTags tags;
  bool has_nodes = false;
  std::map<std::int64_t, std::int64_t> group_of_volume;  ///< physical group of an entity
  std::vector<std::int64_t> groups, volumes;             ///< of every tet

  /// A number as text, or of this many bytes.
  std::int64_t int32() { return binary ? load<std::int32_t>() : in.integer(); }
  std::int64_t size64() { return binary ? load<std::int64_t>() : in.integer(); }
  double real();
  /// Bytes that `ints` 32-bit and `wides` 64-bit numbers take at least.
  std::size_t least_bytes(std::size_t ints, std::size_t wides) const {
    return binary ? 4 * ints + 8 * wides : 2 * (ints + wides);
  }

  void add_node(std::int64_t tag, const Point& position);
  void finish_nodes();
  /// A cell of `type`; nodes by tag.
  void add_element(const CellType& type, const std::vector<std::int64_t>& node_tags, std::int64_t group,
                   std::int64_t volume);

 private:
  template <class T>
  std::int64_t load() {
    const std::string_view bytes = in.take(sizeof(T));
    return bytes.empty() ? 0 : std::int64_t{load_number<T>(bytes.data(), swap)};
  }
  std::vector<Index> corners_;  ///< of the element that is being added
};

/// nullptr: gmsh has no such element, or one that is not known here.
const CellType* gmsh_element_type(std::int64_t number);

// Sections, without the words at their begin and end.
void read_gmsh_nodes_2(GmshFile& file);  ///< of versions 1 and 2
void read_gmsh_elements_1(GmshFile& file);
void read_gmsh_elements_2(GmshFile& file);
void read_gmsh_entities_4(GmshFile& file);
void read_gmsh_nodes_4(GmshFile& file);
void read_gmsh_elements_4(GmshFile& file);

}  // namespace souple
