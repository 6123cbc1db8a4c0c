// SPDX-License-Identifier: GPL-3.0-or-later
// The steps of mending that lean on CGAL's Polygon_mesh_processing. They take triangles at unit size
// and merged by position, and may throw, crash or run long on hostile input: call them through
// guarded_step.hpp. None is trusted: what they return is checked by others.
#pragma once
#include <cstddef>
#include <vector>

#include "formats/core/mesh.hpp"

namespace souple {

struct MendStep {
  TriangleMesh mesh;
  std::size_t count = 0;  ///< of what was done; see each step
};

/// Neighbours face alike; edges of more than two triangles are cut apart and their rims sewn again
/// where only two match; vertices of several fans are split. By index the result is oriented and
/// manifold, and usually open. Counts vertices added.
MendStep orient_and_cut(const TriangleMesh& mesh);

/// Triangles of no or almost no height go, by collapses and flips. Counts triangles less.
MendStep remove_slivers(const TriangleMesh& mesh);

/// Closes every rim of at most `most_edges` edges and a perimeter of at most `longest` (times the
/// unit). Counts holes closed.
MendStep fill_holes(const TriangleMesh& mesh, std::size_t most_edges, double longest);

/// CGAL's experimental local removal by smoothing and hole filling; triangles away from
/// self-intersections stay. Counts triangles that changed in number.
MendStep remove_intersections(const TriangleMesh& mesh);

/// Removes the triangles that cut each other or touch at edges of more than two, with `rings`
/// rings around them, and closes the gap.
/// Counts triangles removed.
MendStep cut_out_intersections(const TriangleMesh& mesh, std::size_t rings);

/// The union of closed oriented shells, each free of self-intersection, with exact constructions.
/// An empty mesh if the result would not be manifold. Counts shells united.
MendStep unite_shells(const std::vector<TriangleMesh>& shells);

/// CGAL's Alpha_wrap_3: alpha and offset in the same unit as the mesh. Counts triangles.
MendStep wrap_triangles(const TriangleMesh& mesh, double alpha, double offset);

}  // namespace souple
