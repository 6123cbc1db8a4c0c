// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <string>

#include "tools/exchange/tets/gmsh_file.hpp"
#include "tools/exchange/tets/tet_readers.hpp"

namespace souple {
namespace {

std::string format_name(const GmshFile& file) {
  static constexpr std::string_view versions[] = {"1", "2", "4.0", "4.1"};
  return "gmsh " + std::string(versions[static_cast<std::size_t>(file.version)]) +
         (file.binary ? " binary" : " ascii");
}

void read_version(GmshFile& file) {
  const std::string_view version = file.in.word();
  if (version == "2" || version == "2.0" || version == "2.1" || version == "2.2")
    file.version = GmshVersion::v2;
  else if (version == "4" || version == "4.0")
    file.version = GmshVersion::v4_0;
  else if (version == "4.1")
    file.version = GmshVersion::v4_1;
  else if (file.in.ok())
    file.in.refuse("version " + quoted(version) + " of gmsh's format is not read");
}

/// $MeshFormat: version, 0 or 1 for binary, bytes of a number; a binary file shows its byte order.
void read_format(GmshFile& file) {
  read_version(file);
  const std::int64_t kind = file.in.integer(), width = file.in.integer();
  if (kind != 0 && kind != 1) file.in.fail("the file is neither ascii (0) nor binary (1)");
  file.binary = kind == 1;
  if (!file.binary || !file.in.ok()) return;
  if (width != 8) return file.in.refuse("binary files with " + std::to_string(width) + "-byte numbers");
  file.in.end_line();
  const std::string_view one = file.in.take(4);
  if (!file.in.ok()) return;
  file.swap = load_number<std::int32_t>(one.data(), true) == 1;
  if (!file.swap && load_number<std::int32_t>(one.data(), false) != 1)
    file.in.fail("the byte order cannot be told: the binary 1 is missing");
}

/// $PhysicalNames: dimension, number, name in quotes; text in binary files too.
void read_group_names(GmshFile& file) {
  const std::size_t count = file.in.count(6, largest_cell_count);
  for (std::size_t i = 0; i < count && file.in.ok(); ++i) {
    const std::int64_t dimension = file.in.integer(), group = file.in.integer();
    const std::string_view line = file.in.rest_of_line();
    const std::size_t open = line.find('"'), close = line.rfind('"');
    if (open == line.npos || close == open) return file.in.fail("the name of a group lacks its quotes");
    if (dimension == 3)
      file.mesh.label_names.emplace_back(group, line.substr(open + 1, close - open - 1));
  }
}

void read_nodes(GmshFile& file) {
  if (file.has_nodes) return file.in.fail("a second section of nodes");
  if (file.version == GmshVersion::v1 || file.version == GmshVersion::v2)
    return read_gmsh_nodes_2(file);
  if (file.binary) file.in.end_line();
  read_gmsh_nodes_4(file);
}

void read_elements(GmshFile& file) {
  if (!file.has_nodes) return file.in.fail("the elements stand before the nodes");
  if (file.version == GmshVersion::v1) return read_gmsh_elements_1(file);
  if (file.version == GmshVersion::v2) return read_gmsh_elements_2(file);
  if (file.binary) file.in.end_line();
  read_gmsh_elements_4(file);
}

void read_entities(GmshFile& file) {
  if (file.binary) file.in.end_line();
  read_gmsh_entities_4(file);
}

/// The section called `name` up to its end.
void read_section(GmshFile& file, const std::string& name) {
  const bool is_4 = file.version == GmshVersion::v4_0 || file.version == GmshVersion::v4_1;
  const bool is_1 = file.version == GmshVersion::v1;
  if (is_1 && (name == "NOD" || name == "ELM")) {
    name == "NOD" ? read_nodes(file) : read_elements(file);
    file.in.expect("$END" + name);
    return;
  }
  if (name == "MeshFormat" && is_1 && !file.has_nodes) {
    read_format(file);
  } else if (name == "Nodes" && !is_1) {
    read_nodes(file);
  } else if (name == "Elements" && !is_1) {
    read_elements(file);
  } else if (name == "PhysicalNames") {
    read_group_names(file);
  } else if (name == "Entities" && is_4) {
    read_entities(file);
  } else {
    return file.in.skip_past("$End" + name);
  }
  file.in.expect("$End" + name);
}

bool has_several(const std::vector<std::int64_t>& values) {
  return std::ranges::any_of(values, [&](std::int64_t value) { return value != values.front(); });
}

void choose_labels(GmshFile& file) {
  if (std::ranges::any_of(file.groups, [](std::int64_t group) { return group != 0; }))
    file.mesh.labels = std::move(file.groups);
  else if (has_several(file.volumes))
    file.mesh.labels = std::move(file.volumes);
  if (file.mesh.labels.empty()) file.mesh.label_names.clear();
}

}  // namespace

Result<RawMesh> read_gmsh(std::string_view bytes) {
  GmshFile file(bytes);
  const std::string_view first = file.in.peek();
  if (first != "$MeshFormat" && first != "$NOD" && first != "$Comments")
    return malformed("the file begins with " + quoted(first) + " instead of $MeshFormat or $NOD");
  while (!file.in.at_end()) {
    const std::string_view name = file.in.word();
    if (!name.starts_with('$') || name.size() < 2)
      file.in.fail("found " + quoted(name) + " where a section should begin");
    else
      read_section(file, std::string(name.substr(1)));
  }
  if (file.in.ok() && !file.has_nodes) file.in.fail("the file has no nodes");
  if (!file.in.ok()) return file.in.issue();
  choose_labels(file);
  file.mesh.format = format_name(file);
  return std::move(file.mesh);
}

}  // namespace souple
