// SPDX-License-Identifier: GPL-3.0-or-later
// TetGen's .node and .ele (TetGen manual, "File formats"): rows of numbers, comments behind '#'.
#include <string>

#include "tools/exchange/tets/number_type.hpp"
#include "tools/exchange/tets/tet_readers.hpp"
#include "tools/exchange/tets/text_cursor.hpp"

namespace souple {
namespace {

constexpr TextCursor::Syntax tetgen_syntax{.hash_comments = true};
constexpr std::size_t most_columns = 1000;

/// Issues of two files need the name of one.
Issue in_file(const char* which, Issue issue) {
  issue.what = std::string(which) + " file, " + issue.what;
  return issue;
}

/// <points> 3 <attributes> <0 or 1 boundary marker>, then <number> x y z …; returns the first number.
std::int64_t read_nodes(TextCursor& in, RawMesh& mesh) {
  const std::size_t count = in.count(8, largest_node_count);
  if (in.integer() != 3) in.refuse("points of another dimension than 3 are not read");
  const std::size_t attribute_count = in.count(0, most_columns);
  const std::size_t extra = attribute_count + in.count(0, 1);
  mesh.nodes.reserve(count);
  std::int64_t first = 0;
  for (std::size_t i = 0; i < count && in.ok(); ++i) {
    const std::int64_t number = in.integer();
    if (i == 0) first = number;
    if (number != first + static_cast<std::int64_t>(i) || first < 0 || first > 1)
      in.fail("point " + std::to_string(number) + " is out of order: points are numbered from 0 or 1");
    const double x = in.number(), y = in.number(), z = in.number();
    for (std::size_t k = 0; k < extra && in.ok(); ++k) in.number();
    mesh.nodes.push_back({x, y, z});
  }
  return first;
}

/// <tets> <4 or 10 nodes> <attributes>, then <number> nodes … attributes …
void read_tets(TextCursor& in, RawMesh& mesh, std::int64_t first) {
  const std::size_t count = in.count(10, largest_cell_count);
  const std::int64_t node_count = in.integer();
  if (node_count != 4 && node_count != 10)
    in.refuse("tets of " + std::to_string(node_count) + " nodes are not read");
  const std::size_t attribute_count = in.count(0, most_columns);
  const CellType type{CellKind::tet, static_cast<int>(node_count)};
  std::vector<Index> nodes;
  bool is_whole = attribute_count > 0;
  for (std::size_t i = 0; i < count && in.ok(); ++i) {
    in.integer();  // its own number
    nodes.clear();
    for (std::int64_t k = 0; k < node_count && in.ok(); ++k) {
      const std::int64_t node = in.integer();
      if (in.ok() && (node < first || static_cast<std::uint64_t>(node - first) >= mesh.nodes.size()))
        in.fail("a tet names point " + std::to_string(node) + ", which is not there");
      nodes.push_back(static_cast<Index>(node - first));
    }
    double attribute = 0;
    for (std::size_t k = 0; k < attribute_count && in.ok(); ++k) attribute = in.number();
    if (!in.ok()) return;
    add_cell(mesh, type, nodes);
    const auto label = exact_integer(attribute);
    is_whole = is_whole && label.has_value();
    if (is_whole) mesh.labels.push_back(*label);
  }
  if (!is_whole) mesh.labels.clear();
}

}  // namespace

Result<RawMesh> read_tetgen(std::string_view node_bytes, std::string_view ele_bytes) {
  RawMesh mesh;
  TextCursor nodes(node_bytes, tetgen_syntax), tets(ele_bytes, tetgen_syntax);
  const std::int64_t first = read_nodes(nodes, mesh);
  if (!nodes.at_end()) nodes.fail("there is more than the points that were announced");
  if (!nodes.ok()) return in_file(".node", nodes.issue());
  read_tets(tets, mesh, first);
  if (!tets.at_end()) tets.fail("there is more than the tets that were announced");
  if (!tets.ok()) return in_file(".ele", tets.issue());
  mesh.format = "tetgen";
  return mesh;
}

}  // namespace souple
