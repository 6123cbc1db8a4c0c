// SPDX-License-Identifier: GPL-3.0-or-later
// MSH 4.1, ascii (gmsh reference manual, "MSH file format").
#include <algorithm>
#include <set>

#include "tools/exchange/writers/append.hpp"
#include "tools/exchange/writers/mesh_text.hpp"

namespace souple {
namespace {

/// Numbers of the volumes; one without a group if there are no labels.
std::set<Index> volumes_of(const std::vector<Index>& labels) {
  std::set<Index> volumes;
  for (const Index label : labels) volumes.insert(label);
  if (volumes.empty()) volumes.insert(0);
  return volumes;
}

std::string box_text(const std::vector<Point>& nodes) {
  Point low = nodes.front(), high = low;
  for (const Point& node : nodes)
    for (std::size_t k = 0; k < 3; ++k) {
      low[k] = std::min(low[k], node[k]);
      high[k] = std::max(high[k], node[k]);
    }
  std::string text;
  append_point(text, low);
  text += ' ';
  append_point(text, high);
  return text;
}

/// "1 17 1 17": blocks, how many, least and greatest number.
std::string counts_text(std::size_t blocks, std::size_t count) {
  return std::to_string(blocks) + " " + std::to_string(count) + " 1 " + std::to_string(count) + "\n";
}

void append_groups(std::string& text, const std::set<Index>& volumes) {
  text += "$PhysicalNames\n" + std::to_string(volumes.size()) + "\n";
  for (const Index volume : volumes)
    text += "3 " + std::to_string(std::int64_t{volume} + 1) + " \"region_" + std::to_string(volume) +
            "\"\n";
  text += "$EndPhysicalNames\n";
}

void append_entities(std::string& text, const TetMesh& mesh, const std::set<Index>& volumes,
                     bool are_groups) {
  const std::string box = box_text(mesh.nodes);
  text += "$Entities\n0 0 0 " + std::to_string(volumes.size()) + "\n";
  for (const Index volume : volumes) {
    const std::string number = std::to_string(std::int64_t{volume} + 1);
    text += number + " " + box + (are_groups ? " 1 " + number : " 0") + " 0\n";
  }
  text += "$EndEntities\n";
}

/// One block of nodes, in the first volume.
void append_nodes(std::string& text, const TetMesh& mesh, Index volume) {
  text += "$Nodes\n" + counts_text(1, mesh.nodes.size()) + "3 " +
          std::to_string(std::int64_t{volume} + 1) + " 0 " + std::to_string(mesh.nodes.size()) + "\n";
  for (std::size_t i = 1; i <= mesh.nodes.size(); ++i) {
    append_number(text, i);
    text += '\n';
  }
  for (const Point& node : mesh.nodes) {
    append_point(text, node);
    text += '\n';
  }
  text += "$EndNodes\n";
}

/// A block per run of tets with the same label, so that the tets keep their order.
void append_elements(std::string& text, const TetMesh& mesh, const std::vector<Index>& labels) {
  std::vector<std::size_t> begins{0};
  for (std::size_t t = 1; t < labels.size(); ++t)
    if (labels[t] != labels[t - 1]) begins.push_back(t);
  text += "$Elements\n" + counts_text(begins.size(), mesh.tets.size());
  begins.push_back(mesh.tets.size());
  for (std::size_t b = 0; b + 1 < begins.size(); ++b) {
    const std::int64_t volume = labels.empty() ? 1 : std::int64_t{labels[begins[b]]} + 1;
    text += "3 " + std::to_string(volume) + " 4 " + std::to_string(begins[b + 1] - begins[b]) + "\n";
    for (std::size_t t = begins[b]; t < begins[b + 1]; ++t) {
      append_number(text, t + 1);
      text += ' ';
      append_cell(text, mesh.tets[t], 1);
      text += '\n';
    }
  }
  text += "$EndElements\n";
}

}  // namespace

std::string gmsh_text(const TetMesh& mesh, const std::vector<Index>& labels) {
  const std::set<Index> volumes = volumes_of(labels);
  std::string text = "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n";
  if (!labels.empty()) append_groups(text, volumes);
  append_entities(text, mesh, volumes, !labels.empty());
  append_nodes(text, mesh, *volumes.begin());
  append_elements(text, mesh, labels);
  return text;
}

}  // namespace souple
