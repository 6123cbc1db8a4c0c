// SPDX-License-Identifier: GPL-3.0-or-later
// One reader per format: bytes in, plain mesh or issue (tet_file_malformed, tet_file_unsupported) out.
// They trust nothing, allocate no more than in proportion to the bytes, and are run in a child process
// all the same.
#pragma once
#include <string_view>

#include "tools/exchange/tets/raw_mesh.hpp"

namespace souple {

/// gmsh 1 ($NOD), 2.0 to 2.2, 4.0, 4.1; ascii and binary of either byte order. Labels: physical groups
/// of the volumes, or else the volumes, if there are several.
Result<RawMesh> read_gmsh(std::string_view bytes);
/// Medit .mesh, ascii. Labels: references, unless all are 0.
Result<RawMesh> read_medit(std::string_view bytes);
/// Legacy VTK 1 to 5, unstructured grid or polygons, ascii and binary. Labels: cell data with one of
/// the usual names (vtk_cells.hpp).
Result<RawMesh> read_vtk(std::string_view bytes);
/// VTK's XML unstructured grid: inline or appended, ascii, base64 or raw, plain or by zlib.
Result<RawMesh> read_vtu(std::string_view bytes);
/// TetGen's two files. Labels: the last attribute of the tets.
Result<RawMesh> read_tetgen(std::string_view node_bytes, std::string_view ele_bytes);
/// Vega .veg. Labels: regions, with the names of their materials.
Result<RawMesh> read_vega(std::string_view bytes);

}  // namespace souple
