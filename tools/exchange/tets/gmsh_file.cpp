// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/exchange/tets/gmsh_file.hpp"

#include <array>
#include <cmath>
#include <string>

namespace souple {

double GmshFile::real() {
  if (!binary) return in.number();
  const std::string_view bytes = in.take(sizeof(double));
  const double value = bytes.empty() ? 0 : load_number<double>(bytes.data(), swap);
  if (!std::isfinite(value)) in.fail("a coordinate is not finite");
  return value;
}

void GmshFile::add_node(std::int64_t tag, const Point& position) {
  tags.add(tag);
  mesh.nodes.push_back(position);
}

void GmshFile::finish_nodes() {
  has_nodes = true;
  if (!tags.finish()) in.fail("two nodes have the same number");
}

void GmshFile::add_element(const CellType& type, const std::vector<std::int64_t>& node_tags,
                           std::int64_t group, std::int64_t volume) {
  corners_.clear();
  for (const std::int64_t tag : node_tags) {
    corners_.push_back(tags.find(tag));
    if (corners_.back() < 0)
      in.fail("an element names node " + std::to_string(tag) + ", which is not there");
  }
  if (!in.ok() || !add_cell(mesh, type, corners_)) return;
  groups.push_back(group);
  volumes.push_back(volume);
}

const CellType* gmsh_element_type(std::int64_t number) {
  using enum CellKind;
  static constexpr std::array<CellType, 32> types{{{},
                                                   {other, 2},
                                                   {triangle, 3},
                                                   {quad, 4},
                                                   {tet, 4},
                                                   {volume, 8},
                                                   {volume, 6},
                                                   {volume, 5},
                                                   {other, 3},
                                                   {triangle, 6},
                                                   {quad, 9},
                                                   {tet, 10},
                                                   {volume, 27},
                                                   {volume, 18},
                                                   {volume, 14},
                                                   {other, 1},
                                                   {quad, 8},
                                                   {volume, 20},
                                                   {volume, 15},
                                                   {volume, 13},
                                                   {triangle, 9},
                                                   {triangle, 10},
                                                   {triangle, 12},
                                                   {triangle, 15},
                                                   {triangle, 15},
                                                   {triangle, 21},
                                                   {other, 4},
                                                   {other, 5},
                                                   {other, 6},
                                                   {tet, 20},
                                                   {tet, 35},
                                                   {tet, 56}}};
  static constexpr CellType hexahedron64{volume, 64}, hexahedron125{volume, 125};
  if (number == 92) return &hexahedron64;
  if (number == 93) return &hexahedron125;
  if (number < 1 || number >= static_cast<std::int64_t>(types.size())) return nullptr;
  return &types[static_cast<std::size_t>(number)];
}

}  // namespace souple
