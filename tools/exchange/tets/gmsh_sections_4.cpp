// SPDX-License-Identifier: GPL-3.0-or-later
#include <string>

#include "tools/exchange/tets/gmsh_file.hpp"

namespace souple {
namespace {

bool is_4_0(const GmshFile& file) { return file.version == GmshVersion::v4_0; }

/// Version 4.0 counts nodes and elements by 32 bits, 4.1 by 64; counts of things have 64 in both.
std::int64_t take_number(GmshFile& file) { return is_4_0(file) ? file.int32() : file.size64(); }

std::size_t take_count(GmshFile& file, std::size_t least_bytes, std::size_t most) {
  return file.in.checked_count(file.size64(), least_bytes, most);
}

/// Which entity a block belongs to.
struct Block {
  std::int64_t dimension = 0, entity = 0, third = 0;  ///< third: parametric flag or element type
  std::size_t count = 0;
};

Block take_block(GmshFile& file, std::size_t most) {
  Block block;
  block.dimension = file.int32();
  block.entity = file.int32();
  if (is_4_0(file)) std::swap(block.dimension, block.entity);
  block.third = file.int32();
  block.count = file.in.ok() ? take_count(file, file.least_bytes(1, 0), most) : 0;
  if (block.dimension < 0 || block.dimension > 3)
    file.in.fail("a block of dimension " + std::to_string(block.dimension));
  return block;
}

Point take_position(GmshFile& file, std::int64_t parameter_count) {
  const double x = file.real(), y = file.real(), z = file.real();
  for (std::int64_t k = 0; k < parameter_count; ++k) file.real();
  return {x, y, z};
}

void read_node_block(GmshFile& file, const Block& block) {
  const std::int64_t parameter_count = block.third != 0 ? block.dimension : 0;
  if (is_4_0(file)) {
    for (std::size_t i = 0; i < block.count && file.in.ok(); ++i) {
      const std::int64_t tag = file.int32();
      file.add_node(tag, take_position(file, parameter_count));
    }
    return;
  }
  // All numbers first, then all positions.
  std::vector<std::int64_t> tags;
  tags.reserve(block.count);
  for (std::size_t i = 0; i < block.count && file.in.ok(); ++i) tags.push_back(file.size64());
  for (std::size_t i = 0; i < block.count && file.in.ok(); ++i)
    file.add_node(tags[i], take_position(file, parameter_count));
}

void read_element_block(GmshFile& file, const Block& block) {
  const CellType* type = gmsh_element_type(block.third);
  if (type == nullptr)
    return file.in.refuse("element type " + std::to_string(block.third) + " is not read");
  const auto group = file.group_of_volume.find(block.entity);
  const std::int64_t group_tag = group == file.group_of_volume.end() ? 0 : group->second;
  std::vector<std::int64_t> nodes;
  for (std::size_t i = 0; i < block.count && file.in.ok(); ++i) {
    take_number(file);  // the element's own number
    nodes.clear();
    for (int k = 0; k < type->node_count && file.in.ok(); ++k) nodes.push_back(take_number(file));
    file.add_element(*type, nodes, group_tag, block.entity);
  }
}

/// An entity: number, box, physical groups, and what bounds it.
void read_entity(GmshFile& file, int dimension) {
  const std::int64_t entity = file.int32();
  const int box_numbers = dimension == 0 && !is_4_0(file) ? 3 : 6;
  for (int k = 0; k < box_numbers; ++k) file.real();
  const std::size_t group_count = take_count(file, file.least_bytes(1, 0), largest_cell_count);
  for (std::size_t k = 0; k < group_count && file.in.ok(); ++k) {
    const std::int64_t group = file.int32();
    if (k == 0 && dimension == 3) file.group_of_volume[entity] = group;
  }
  if (dimension == 0) return;
  const std::size_t bound_count = take_count(file, file.least_bytes(1, 0), largest_cell_count);
  for (std::size_t k = 0; k < bound_count && file.in.ok(); ++k) file.int32();
}

}  // namespace

void read_gmsh_entities_4(GmshFile& file) {
  std::size_t counts[4];
  for (std::size_t& count : counts)
    count = take_count(file, file.least_bytes(1, 4), largest_cell_count);
  for (int dimension = 0; dimension < 4; ++dimension)
    for (std::size_t i = 0; i < counts[dimension] && file.in.ok(); ++i) read_entity(file, dimension);
}

void read_gmsh_nodes_4(GmshFile& file) {
  const std::size_t block_count = take_count(file, file.least_bytes(3, 1), largest_node_count);
  const std::size_t count = take_count(file, file.least_bytes(1, 3), largest_node_count);
  if (!is_4_0(file)) file.size64(), file.size64();  // least and greatest number
  file.mesh.nodes.reserve(count);
  file.tags.reserve(count);
  std::size_t left = count;
  for (std::size_t i = 0; i < block_count && file.in.ok(); ++i) {
    const Block block = take_block(file, left);
    if (file.in.ok()) read_node_block(file, block);
    left -= block.count;
  }
  if (left > 0) file.in.fail(std::to_string(left) + " nodes are in no block");
  file.finish_nodes();
}

void read_gmsh_elements_4(GmshFile& file) {
  const std::size_t block_count = take_count(file, file.least_bytes(3, 1), largest_cell_count);
  std::size_t left = take_count(file, file.least_bytes(2, 0), largest_cell_count);
  if (!is_4_0(file)) file.size64(), file.size64();  // least and greatest number
  for (std::size_t i = 0; i < block_count && file.in.ok(); ++i) {
    const Block block = take_block(file, left);
    if (file.in.ok()) read_element_block(file, block);
    left -= block.count;
  }
  if (left > 0) file.in.fail(std::to_string(left) + " elements are in no block");
}

}  // namespace souple
