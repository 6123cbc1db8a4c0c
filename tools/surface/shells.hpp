// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstddef>
#include <vector>

#include "formats/core/mesh.hpp"
#include "tools/geometry/surface_measure.hpp"
#include "tools/surface/self_intersections.hpp"

namespace souple {

/// A piece of a surface connected over vertices.
struct Shell {
  TriangleMesh mesh;  ///< on its own, triangles in the order of the whole
  Box box;
  bool closed = false;    ///< every edge belongs to two triangles
  bool oriented = false;  ///< closed, and every edge is run through both ways
  double volume_m3 = 0;   ///< signed; of an oriented shell
  std::size_t depth = 0;  ///< oriented shells around it that it does not cut
  bool is_cut = false;    ///< cuts another shell
  bool faces_wrong() const { return oriented && (volume_m3 < 0) != (depth % 2 == 1); }
};

/// The pieces of a mesh whose vertices are merged by position, in the order of first appearance.
/// `cuts` are the self-intersections of the whole mesh.
std::vector<Shell> split_into_shells(const TriangleMesh& mesh, const std::vector<TrianglePair>& cuts);

/// One mesh of all that follow each other.
TriangleMesh join_meshes(const std::vector<TriangleMesh>& meshes);

/// Vertices sorted by position (those at the same one by the triangles around), triangles by their
/// vertices, each beginning with its lowest; unused vertices go. For results whose numbering depends on
/// memory addresses.
TriangleMesh in_canonical_order(const TriangleMesh& mesh);

/// Groups of shells that cut one another, directly or through others; shells that cut none stand alone.
/// Ascending, in the order of their first shells.
std::vector<std::vector<std::size_t>> groups_of_crossing_shells(const TriangleMesh& mesh,
                                                                const std::vector<TrianglePair>& cuts);

}  // namespace souple
