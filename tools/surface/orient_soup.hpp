// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "formats/core/mesh.hpp"

namespace souple {

/// Orientation by neighbourhood: consistent where the surface allows it. Vertices with several fans are
/// split, so that every vertex has one. The order of triangles is kept.
TriangleMesh orient_soup(const TriangleMesh& mesh);

}  // namespace souple
