// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <span>

#include "formats/core/mesh.hpp"
#include "formats/core/result.hpp"

namespace souple {

/// Barycentric weights of p in a tet with a volume; they sum to 1, inside none is negative.
std::array<double, 4> barycentric_weights(const Point& p, const Tet& tet, std::span<const Point> nodes);

/// Finite and within 1e15 m of the origin, so that no square overflows.
bool is_within_reach(const Point& p);

/// Issue mesh_element_invalid: no tets, nodes that are not finite or beyond 1e15 m, indices out of
/// range, flat or inverted tets.
Status check_tet_mesh(const TetMesh& mesh);

}  // namespace souple
