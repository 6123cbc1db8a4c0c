// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "tools/surface/mend.hpp"

namespace souple {

/// Removes the self-intersections, and the edges where it touches itself, within each shell of a closed
/// oriented manifold surface; whatever
/// step leaves fewer of them and is still sound is taken. Triangles elsewhere stay.
void clear_intersections_of_shells(Mended& mended);

/// The same of one shell; the mesh comes back as it was where nothing helps. `removed` counts
/// pairs and edges.
TriangleMesh clear_intersections(const TriangleMesh& shell, std::size_t& removed);

}  // namespace souple
