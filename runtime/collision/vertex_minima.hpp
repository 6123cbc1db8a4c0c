// SPDX-License-Identifier: MIT
#pragma once
#include "runtime/collision/proximity_arrays.hpp"

namespace souple {

/// What a search for minima between `x` and `y` knows. For a surface and itself both are the same.
struct MinimaSearch {
  const DeformedSurface* a;
  const DeformedSurface* b;
  double alarm_distance = 0, inside_reach = 0;
  ProximityWork::Arrays* work;
  std::vector<LocalMinimum>* out;
  bool is_self() const { return a == b; }
};

/// Finds the edges of each surface that pass through the other, in pairs of leaves that overlap.
void find_piercing_edges(const MinimaSearch& search);

/// Pairs of vertices of one surface (of A, or if `flipped` of B) and features of the other.
void find_vertex_minima(const MinimaSearch& search, bool flipped);

/// Pairs of edges.
void find_edge_minima(const MinimaSearch& search);

/// Two points of a surface as they were in the rest shape: their distance.
double rest_distance(const DeformedSurface& surface, const SurfacePoint& p, const SurfacePoint& q);

}  // namespace souple
