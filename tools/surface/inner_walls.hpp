// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "tools/surface/mend_steps.hpp"

namespace souple {

/// Solids that share a wall with a common rim (merged by position, the wall is there once or, with
/// other diagonals, twice, and its rim has edges of three or four triangles) become one: the walls
/// between the chambers that such pieces divide space into go, and what stays faces outward. A chamber
/// that every triangle around faces into is a cavity and stays one. Pieces that are manifold, open, or
/// of unclear order about an edge come back as they are. Counts triangles removed. At unit size, merged
/// by position.
MendStep drop_inner_walls(const TriangleMesh& mesh);

}  // namespace souple
