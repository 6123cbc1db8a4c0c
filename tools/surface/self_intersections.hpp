// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <cstddef>
#include <vector>

#include "formats/core/mesh.hpp"

namespace souple {

/// Triangles that cut each other, the smaller index first.
using TrianglePair = std::array<Index, 2>;

struct SelfIntersections {
  std::vector<TrianglePair> pairs;  ///< ascending
  bool capped = false;              ///< the search stopped at the cap
};

inline constexpr std::size_t self_intersection_cap = 50'000;

/// Pairs of triangles that share more than corners and sides they have in common, by exact predicates.
/// Vertices at the same position count as one; degenerate triangles and triangles with the same three
/// corners are left out. Indices must be in range, coordinates finite.
SelfIntersections find_self_intersections(const TriangleMesh& mesh,
                                          std::size_t cap = self_intersection_cap);

}  // namespace souple
