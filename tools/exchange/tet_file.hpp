// SPDX-License-Identifier: GPL-3.0-or-later
// Tet meshes of other programs: gmsh 1, 2 and 4 (ascii, binary), medit, legacy VTK and VTU, TetGen,
// Vega.
#pragma once
#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "formats/core/mesh.hpp"
#include "formats/core/result.hpp"

namespace souple {

enum class TetFormat { gmsh, medit, vtk, vtu, tetgen, vega };

/// "gmsh", "medit", "vtk", "vtu", "tetgen", "vega".
std::string_view tet_format_name(TetFormat format);

/// By extension (.msh .mesh .vtk .vtu .node .ele .veg, any case); false: not a tet file.
bool is_tet_file_name(const std::filesystem::path& file);

struct ImportTetsOptions {
  std::string unit = "m";  ///< of the file's numbers: m, cm, mm, um, km, in, ft
  double size_m = 0;       ///< > 0: scale so that the longest side of the bounding box has this length
  /// Instead of refusing: turn inverted tets, leave out flat and repeated ones and pieces that touch a
  /// larger one along an edge or node only, split nodes at which the mesh pinches itself.
  bool mend = false;
  double time_limit_s = 60;
  std::size_t memory_limit_bytes = std::size_t{2} << 30;  ///< of the child process that parses
};

struct ImportTetsReport {
  std::string format;  ///< with version and encoding: "gmsh 4.1 binary"
  std::size_t file_bytes = 0;
  std::string file_hash;  ///< hex of the bytes of all files read (XXH3, 128 bits)
  std::size_t raw_node_count = 0;
  std::size_t raw_tet_count = 0;
  std::size_t unused_node_count = 0;
  std::size_t other_element_count = 0;  ///< lines, hexes …: left out
  std::size_t linearised_count = 0;     ///< second-order tets of which only the corners were taken
  std::size_t turned_count = 0;         ///< all of a file with the other orientation, or mended
  std::size_t dropped_count = 0;        ///< flat, repeated, or touching along an edge or node; mended
  std::size_t split_node_count = 0;     ///< copies made where the mesh pinched itself; mended
  double scale = 1;                     ///< metres per unit of the file
};

struct ImportedTets {
  TetMesh mesh;               ///< metres, positive, every node used; empty: only triangles
  std::vector<Index> labels;  ///< region of every tet (physical group, reference …); or empty
  std::vector<std::string> label_names;  ///< of labels 0, 1, …
  TriangleMesh triangles;                ///< metres; given only if the file has no tets
  ImportTetsReport report;
};

/// Reads a file in a child process with limits. Issues: tet_file_malformed, tet_file_unsupported,
/// tet_inverted, tet_degenerate, tet_not_manifold, tet_file_no_tets (hexahedra …), tet_no_extent,
/// usage_bad_value, io_*, surface_reader_*. TetGen: name either of the two files.
Result<ImportedTets> import_tets(const std::filesystem::path& file, const ImportTetsOptions& options);

}  // namespace souple
