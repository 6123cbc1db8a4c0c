// SPDX-License-Identifier: GPL-3.0-or-later
// Meshes as the content of files. What they are given was checked: indices in range, finite numbers,
// labels one per tet and not negative, or none.
#pragma once
#include <string>
#include <utility>
#include <vector>

#include "formats/core/mesh.hpp"

namespace souple {

std::string obj_text(const TriangleMesh& mesh);
std::string off_text(const TriangleMesh& mesh);
std::string ply_bytes(const TriangleMesh& mesh);  ///< binary, float64
std::string stl_bytes(const TriangleMesh& mesh);  ///< binary, float32, normals of the triangles
std::string glb_bytes(const TriangleMesh& mesh);  ///< glTF 2.0: one mesh, float32, uint32 indices

/// gmsh 4.1, ascii. Label l becomes the physical volume l + 1, named "region_l"; gmsh's start at 1.
std::string gmsh_text(const TetMesh& mesh, const std::vector<Index>& labels);
/// Medit, with boundary triangles. Label l becomes the reference l + 1: 0 says none.
std::string medit_text(const TetMesh& mesh, const std::vector<Index>& labels);
/// Legacy VTK 3.0, binary, float64; labels as cell data "region".
std::string vtk_bytes(const TetMesh& mesh, const std::vector<Index>& labels);
/// TetGen's .node and .ele, numbered from 0; labels as the attribute of the tets.
std::pair<std::string, std::string> tetgen_texts(const TetMesh& mesh, const std::vector<Index>& labels);

}  // namespace souple
