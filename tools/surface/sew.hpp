// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "tools/surface/mend_steps.hpp"

namespace souple {

/// Where a vertex of a rim lies on the side of a triangle at another rim (a T-junction; dropping
/// triangles without area leaves such), the triangle is split there. Vertices must be merged by
/// position; `tolerance` in their unit. Counts sides split.
MendStep split_at_t_junctions(const TriangleMesh& mesh, double tolerance);

/// Merges vertices of rims closer than `tolerance` to one another, the lower index stays. Counts
/// vertices merged.
MendStep merge_rim_vertices(const TriangleMesh& mesh, double tolerance);

}  // namespace souple
