// SPDX-License-Identifier: GPL-3.0-or-later
#include <string>

#include "tools/exchange/tets/gmsh_file.hpp"

namespace souple {
namespace {

constexpr std::int64_t most_element_tags = 1000;  // partitions are listed among them

/// The number of elements or nodes, which is text even in a binary file.
std::size_t take_count(GmshFile& file, std::size_t least_bytes, std::size_t most) {
  const std::size_t count = file.in.count(least_bytes, most);
  if (file.binary) file.in.end_line();
  return count;
}

void take_nodes(GmshFile& file, std::int64_t count, std::vector<std::int64_t>& nodes) {
  nodes.clear();
  for (std::int64_t k = 0; k < count && file.in.ok(); ++k) nodes.push_back(file.int32());
}

const CellType* take_type(GmshFile& file) {
  const std::int64_t number = file.int32();
  const CellType* type = gmsh_element_type(number);
  if (file.in.ok() && type == nullptr)
    file.in.refuse("element type " + std::to_string(number) + " is not read");
  return file.in.ok() ? type : nullptr;
}

/// Physical group and elementary volume come first.
struct ElementTags {
  std::int64_t group = 0, volume = 0;
};

ElementTags take_tags(GmshFile& file, std::int64_t count) {
  ElementTags tags;
  for (std::int64_t k = 0; k < count && file.in.ok(); ++k) {
    const std::int64_t tag = file.int32();
    if (k == 0) tags.group = tag;
    if (k == 1) tags.volume = tag;
  }
  return tags;
}

std::int64_t take_tag_count(GmshFile& file) {
  const std::int64_t count = file.int32();
  if (count < 0 || count > most_element_tags)
    file.in.fail("an element with " + std::to_string(count) + " tags");
  return count;
}

void read_element_blocks(GmshFile& file, std::size_t count) {
  std::vector<std::int64_t> nodes;
  for (std::size_t done = 0; done < count && file.in.ok();) {
    const CellType* type = take_type(file);
    const std::int64_t block = file.int32();
    const std::int64_t tag_count = take_tag_count(file);
    if (type == nullptr) return;
    if (block < 1 || static_cast<std::uint64_t>(block) > count - done)
      return file.in.fail("a block of " + std::to_string(block) + " elements, of which " +
                          std::to_string(count - done) + " are left");
    for (std::int64_t k = 0; k < block && file.in.ok(); ++k) {
      file.int32();  // the element's own number
      const ElementTags tags = take_tags(file, tag_count);
      take_nodes(file, type->node_count, nodes);
      file.add_element(*type, nodes, tags.group, tags.volume);
    }
    done += static_cast<std::size_t>(block);
  }
}

}  // namespace

void read_gmsh_nodes_2(GmshFile& file) {
  const std::size_t count = take_count(file, file.least_bytes(1, 3), largest_node_count);
  file.mesh.nodes.reserve(count);
  file.tags.reserve(count);
  for (std::size_t i = 0; i < count && file.in.ok(); ++i) {
    const std::int64_t tag = file.int32();
    const double x = file.real(), y = file.real(), z = file.real();
    file.add_node(tag, {x, y, z});
  }
  file.finish_nodes();
}

void read_gmsh_elements_1(GmshFile& file) {
  const std::size_t count = take_count(file, file.least_bytes(6, 0), largest_cell_count);
  std::vector<std::int64_t> nodes;
  for (std::size_t i = 0; i < count && file.in.ok(); ++i) {
    file.int32();  // the element's own number
    const CellType* type = take_type(file);
    const ElementTags tags = take_tags(file, 2);
    const std::int64_t node_count = file.int32();
    if (type == nullptr) return;
    if (node_count != type->node_count)
      return file.in.fail("an element has " + std::to_string(node_count) + " nodes instead of " +
                          std::to_string(type->node_count));
    take_nodes(file, node_count, nodes);
    file.add_element(*type, nodes, tags.group, tags.volume);
  }
}

void read_gmsh_elements_2(GmshFile& file) {
  const std::size_t count =
      take_count(file, file.least_bytes(file.binary ? 2 : 4, 0), largest_cell_count);
  if (file.binary) return read_element_blocks(file, count);
  std::vector<std::int64_t> nodes;
  for (std::size_t i = 0; i < count && file.in.ok(); ++i) {
    file.int32();  // the element's own number
    const CellType* type = take_type(file);
    const ElementTags tags = take_tags(file, take_tag_count(file));
    if (type == nullptr) return;
    take_nodes(file, type->node_count, nodes);
    file.add_element(*type, nodes, tags.group, tags.volume);
  }
}

}  // namespace souple
