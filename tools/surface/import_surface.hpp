// SPDX-License-Identifier: GPL-3.0-or-later
// A surface file, of whatever origin, becomes a checked triangle mesh in metres.
#pragma once
#include <cstddef>
#include <filesystem>
#include <string>

#include "formats/core/mesh.hpp"
#include "formats/core/result.hpp"

namespace souple {

struct ImportOptions {
  std::string unit = "m";  ///< unit of the file's numbers: m, cm, mm, um, km, in, ft
  double size_m = 0;       ///< > 0: scale so that the longest side of the bounding box has this length
  double time_limit_s = 60;
  std::size_t memory_limit_bytes = std::size_t{2} << 30;  ///< of the child process that parses
};

struct ImportReport {
  std::string format;  ///< "obj", "off", "ply", "stl", "gltf", "fbx", "collada", "3ds"
  std::size_t file_bytes = 0;
  std::string file_hash;                ///< hex of the file's bytes (XXH3, 128 bits)
  std::size_t raw_vertex_count = 0;     ///< before merging
  std::size_t merged_vertex_count = 0;  ///< duplicates removed by exact position
  std::size_t raw_polygon_count = 0;
  std::size_t dropped_triangle_count = 0;  ///< degenerate (zero area or repeated vertex) or duplicate
  double scale = 1;                        ///< metres per unit of the file, target size included
  Point box_min{}, box_max{};              ///< metres, after scaling
};

struct ImportedSurface {
  TriangleMesh mesh;  ///< metres; node transforms applied; may still be open or self-intersecting
  ImportReport report;
};

/// Reads OBJ, OFF, PLY, STL (double, CGAL) and glTF/GLB, FBX, Collada, 3DS (assimp) in a child process
/// with a time and memory limit. Refuses with a coded issue: missing or unreadable file, unknown or
/// malformed format, non-finite or huge coordinates, indices out of range, no triangles, limits
/// reached.
Result<ImportedSurface> import_surface(const std::filesystem::path& file, const ImportOptions& options);

}  // namespace souple
