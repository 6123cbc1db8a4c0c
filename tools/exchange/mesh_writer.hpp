// SPDX-License-Identifier: GPL-3.0-or-later
// Meshes for other programs. Deterministic: same mesh, same bytes. All numbers in metres.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "formats/core/mesh.hpp"
#include "formats/core/result.hpp"

namespace souple {

/// By the extension: .obj .off .ply (binary) .stl (binary) .glb. Issues: unsupported_feature (another
/// extension), io_cannot_write, mesh_not_writable (indices out of range, NaN, numbers beyond float32
/// for stl and glb).
Status write_surface(const TriangleMesh& mesh, const std::filesystem::path& file);

/// By the extension: .msh (gmsh 4.1, ascii) .mesh (medit) .vtu .vtk .node (TetGen, with .ele beside).
/// `labels`: region of every tet, from 0, or empty. Where a format's own numbers start at 1 (gmsh's
/// physical groups) or 0 means none (medit's references), label l is written as l + 1. Issues as above.
Status write_tets(const TetMesh& mesh, const std::vector<Index>& labels,
                  const std::filesystem::path& file);

/// Refuses early, before long work, what the two above would refuse of the file: its extension, its
/// folder. Issues: unsupported_feature, io_cannot_write.
Status check_surface_output(const std::filesystem::path& file);
Status check_tets_output(const std::filesystem::path& file);

/// Which extensions the two take, for messages.
std::string surface_extensions();
std::string tet_extensions();

}  // namespace souple
