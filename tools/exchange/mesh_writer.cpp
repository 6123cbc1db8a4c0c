// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/exchange/mesh_writer.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <new>

#include "tools/exchange/atomic_file.hpp"
#include "tools/exchange/nearest_name.hpp"
#include "tools/exchange/vtu_writer.hpp"
#include "tools/exchange/writers/mesh_text.hpp"

namespace souple {
namespace {

namespace fs = std::filesystem;

const std::vector<std::string> surface_kinds{".obj", ".off", ".ply", ".stl", ".glb"};
const std::vector<std::string> tet_kinds{".msh", ".mesh", ".vtu", ".vtk", ".node"};

Issue not_writable(std::string what) {
  return make_issue(IssueCode::mesh_not_writable, std::move(what));
}

/// In lower case; refuses others than those that are written.
Result<std::string> extension_of(const fs::path& file, const std::vector<std::string>& kinds) {
  std::string extension = file.extension().string();
  for (char& c : extension)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  if (std::ranges::find(kinds, extension) != kinds.end()) return extension;
  return make_issue(IssueCode::unsupported_feature,
                    "files ending in '" + extension.substr(0, 16) + "' are not written; " +
                        join_names(kinds) + " are",
                    file.string());
}

Status check_points(const std::vector<Point>& points, double largest) {
  for (std::size_t i = 0; i < points.size(); ++i)
    for (const double x : points[i])
      if (!(std::abs(x) <= largest))
        return not_writable("node " + std::to_string(i) +
                            " is not finite, or too large for the format");
  return {};
}

template <class Cell>
Status check_cells(const std::vector<Cell>& cells, std::size_t point_count) {
  if (cells.empty()) return not_writable("the mesh is empty");
  for (std::size_t c = 0; c < cells.size(); ++c)
    for (const Index i : cells[c])
      if (i < 0 || static_cast<std::size_t>(i) >= point_count)
        return not_writable("cell " + std::to_string(c) + " names node " + std::to_string(i) + " of " +
                            std::to_string(point_count));
  return {};
}

Status check_surface(const TriangleMesh& mesh, const std::string& extension) {
  const bool is_single = extension == ".stl" || extension == ".glb";
  const double largest =
      is_single ? double{std::numeric_limits<float>::max()} : std::numeric_limits<double>::max();
  if (Status status = check_points(mesh.vertices, largest); !status) return status;
  // Both formats count in 32 bits; glTF counts bytes.
  constexpr std::size_t most_cells = std::numeric_limits<std::uint32_t>::max() / 32;
  if (is_single && mesh.vertices.size() + mesh.triangles.size() > most_cells)
    return not_writable("the mesh is too large for this format");
  return check_cells(mesh.triangles, mesh.vertices.size());
}

Status check_tets(const TetMesh& mesh, const std::vector<Index>& labels) {
  if (Status status = check_points(mesh.nodes, std::numeric_limits<double>::max()); !status)
    return status;
  if (Status status = check_cells(mesh.tets, mesh.nodes.size()); !status) return status;
  if (!labels.empty() && labels.size() != mesh.tets.size())
    return not_writable(std::to_string(labels.size()) + " labels for " +
                        std::to_string(mesh.tets.size()) + " tets");
  if (std::ranges::any_of(labels, [](Index label) { return label < 0; }))
    return not_writable("a label is negative");
  // VTK's 32-bit lists.
  if (mesh.tets.size() > std::size_t{1} << 28) return not_writable("the mesh has too many tets");
  return {};
}

std::string surface_content(const TriangleMesh& mesh, const std::string& extension) {
  if (extension == ".obj") return obj_text(mesh);
  if (extension == ".off") return off_text(mesh);
  if (extension == ".ply") return ply_bytes(mesh);
  return extension == ".stl" ? stl_bytes(mesh) : glb_bytes(mesh);
}

/// The .ele first, and away again if its .node cannot be written.
Status write_tetgen(const TetMesh& mesh, const std::vector<Index>& labels, const fs::path& file) {
  fs::path tets_file = file;
  tets_file.replace_extension(".ele");
  if (Status status = check_output_file(file); !status) return status;
  const auto [nodes, tets] = tetgen_texts(mesh, labels);
  if (Status status = write_file_atomically(tets_file, tets); !status) return status;
  Status status = write_file_atomically(file, nodes);
  std::error_code ignored;
  if (!status) fs::remove(tets_file, ignored);
  return status;
}

Status write_tet_file(const TetMesh& mesh, const std::vector<Index>& labels, const fs::path& file,
                      const std::string& extension) {
  if (extension == ".node") return write_tetgen(mesh, labels, file);
  if (extension == ".msh") return write_file_atomically(file, gmsh_text(mesh, labels));
  if (extension == ".mesh") return write_file_atomically(file, medit_text(mesh, labels));
  if (extension == ".vtk") return write_file_atomically(file, vtk_bytes(mesh, labels));
  VtuMesh vtu;
  vtu.points = mesh.nodes;
  vtu.tets = mesh.tets;
  vtu.tet_regions = labels;
  return write_vtu(vtu, file);
}

Issue at(Issue issue, const fs::path& file) {
  if (issue.where.empty()) issue.where = file.string();
  return issue;
}

}  // namespace

Status write_surface(const TriangleMesh& mesh, const fs::path& file) try {
  const auto extension = extension_of(file, surface_kinds);
  if (!extension) return extension.issue();
  if (const Status status = check_surface(mesh, *extension); !status) return at(status.issue(), file);
  return write_file_atomically(file, surface_content(mesh, *extension));
} catch (const std::bad_alloc&) {
  return make_issue(IssueCode::io_out_of_memory, "not enough memory to write the mesh", file.string());
}

Status write_tets(const TetMesh& mesh, const std::vector<Index>& labels, const fs::path& file) try {
  const auto extension = extension_of(file, tet_kinds);
  if (!extension) return extension.issue();
  if (const Status status = check_tets(mesh, labels); !status) return at(status.issue(), file);
  return write_tet_file(mesh, labels, file, *extension);
} catch (const std::bad_alloc&) {
  return make_issue(IssueCode::io_out_of_memory, "not enough memory to write the mesh", file.string());
}

Status check_surface_output(const fs::path& file) {
  if (const auto extension = extension_of(file, surface_kinds); !extension) return extension.issue();
  return check_output_file(file);
}

Status check_tets_output(const fs::path& file) {
  if (const auto extension = extension_of(file, tet_kinds); !extension) return extension.issue();
  return check_output_file(file);
}

std::string surface_extensions() { return join_names(surface_kinds); }
std::string tet_extensions() { return join_names(tet_kinds); }

}  // namespace souple
