// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "tools/surface/mend_steps.hpp"

namespace souple {

/// Edges of more than two triangles once vertices are merged by position.
std::size_t crowded_edge_count(const TriangleMesh& mesh);

/// By index: whether a vertex ends such an edge.
std::vector<bool> vertices_at_crowded_edges(const TriangleMesh& mesh);

/// Where parts of a closed oriented manifold surface at unit size touch along an edge, so that vertices
/// merged by position would give an edge of four triangles, the parts draw back from one another by
/// about 1e-4. The mesh comes back as it was if that does not help or folds something over. Counts
/// vertices moved.
MendStep pull_apart_touching_edges(const TriangleMesh& mesh);

}  // namespace souple
