// SPDX-License-Identifier: MIT
#include "runtime/collision/local_minima.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "runtime/collision/leaf_pairs.hpp"
#include "runtime/collision/vertex_minima.hpp"

namespace souple {
namespace {

// Ascending by features; a pair of vertices that both surfaces found is one.
void sort_minima(std::vector<LocalMinimum>& out, std::size_t first) {
  const auto begin = out.begin() + std::ptrdiff_t(first);
  std::sort(begin, out.end(), [](const LocalMinimum& p, const LocalMinimum& q) {
    return std::tuple(p.feature_a, p.feature_b, p.gap) < std::tuple(q.feature_a, q.feature_b, q.gap);
  });
  out.erase(std::unique(begin, out.end(),
                        [](const LocalMinimum& p, const LocalMinimum& q) {
                          return p.feature_a == q.feature_a && p.feature_b == q.feature_b;
                        }),
            out.end());
}

}  // namespace

void find_local_minima(const DeformedSurface& a, const DeformedSurface& b, double alarm_distance,
                       double inside_reach, ProximityWork& work, std::vector<LocalMinimum>& out) {
  const std::size_t first = out.size();
  const MinimaSearch search{&a, &b, alarm_distance, inside_reach, &work.arrays(), &out};
  find_leaf_pairs(a.tree(), a.boxes(), b.tree(), b.boxes(), alarm_distance, work.arrays());
  find_piercing_edges(search);
  find_vertex_minima(search, false);
  find_vertex_minima(search, true);
  find_edge_minima(search);
  sort_minima(out, first);
}

void find_self_minima(const DeformedSurface& surface, double alarm_distance, double inside_reach,
                      ProximityWork& work, std::vector<LocalMinimum>& out) {
  const std::size_t first = out.size();
  const MinimaSearch search{&surface, &surface, alarm_distance, inside_reach, &work.arrays(), &out};
  find_self_leaf_pairs(surface, alarm_distance, work.arrays());
  find_piercing_edges(search);
  find_vertex_minima(search, false);
  find_edge_minima(search);
  sort_minima(out, first);
}

}  // namespace souple
