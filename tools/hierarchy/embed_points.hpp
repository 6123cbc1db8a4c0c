// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <span>
#include <vector>

#include "formats/core/asset.hpp"
#include "formats/core/result.hpp"

namespace souple {

/// No weight may be larger: a point at so many sizes of a tet from the mesh does not belong to it, and
/// would magnify every deformation as much.
inline constexpr double most_embedding_weight = 1000;

struct EmbeddedPoints {
  std::vector<Embedding> rows;    ///< one per point
  std::size_t outside_count = 0;  ///< points in no tet
  double farthest_outside_m = 0;  ///< distance of the farthest of them from the mesh
  double largest_weight = 0;      ///< largest |weight|: 1 inside, more where extrapolated
};

/// The tet and barycentric weights of every point; points outside take the weights of the nearest
/// boundary tet, extrapolated, so that affine motions stay exact; of several boundary tets about as
/// near the one with the least weights. Ties go to the lower tet index. Deterministic. Issues:
/// mesh_element_invalid (no, flat or inverted tets, indices out of range), embedding_failed (a point
/// that is not finite, or so far outside that a weight exceeds most_embedding_weight).
Result<EmbeddedPoints> embed_points(std::span<const Point> points, const TetMesh& mesh);

}  // namespace souple
