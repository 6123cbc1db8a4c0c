// SPDX-License-Identifier: GPL-3.0-or-later
// The readers of third-party libraries. They run on untrusted bytes and may crash, hang or devour
// memory: call them in a child process only (child_process.hpp).
#pragma once
#include <filesystem>
#include <string_view>

#include "tools/surface/polygon_soup.hpp"
#include "tools/surface/surface_format.hpp"

namespace souple {

/// OBJ, OFF, PLY, STL in double (CGAL's stream readers, into a soup so that non-manifold files
/// survive).
Result<PolygonSoup> read_with_cgal(SurfaceFormat format, std::string_view bytes);

/// glTF, FBX, Collada, 3DS; node transforms applied, mirrored ones with their winding turned back.
/// `file` serves to find the buffers beside it; its own content is `bytes`.
Result<PolygonSoup> read_with_assimp(SurfaceFormat format, std::string_view bytes,
                                     const std::filesystem::path& file);

/// Splits every polygon of a checked soup, concave ones too (CGAL: constrained Delaunay, else the least
/// cover of the polyline).
TriangleSoup triangulate_polygons(PolygonSoup soup);

}  // namespace souple
