// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/exchange/tets/sort_out_tets.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>

#include "tools/exchange/tets/tet_pieces.hpp"
#include "tools/geometry/surface_measure.hpp"
#include "tools/geometry/vector.hpp"

namespace souple {
namespace {

constexpr double flat_volume6 = 1e-12;  // of the longest edge cubed; slabs have 1e-6

const Point& node(const std::vector<Point>& nodes, Index i) {
  return nodes[static_cast<std::size_t>(i)];
}

double volume6(const std::vector<Point>& nodes, const Tet& t) {
  return signed_volume6(node(nodes, t[0]), node(nodes, t[1]), node(nodes, t[2]), node(nodes, t[3]));
}

/// Also of tets with a node twice.
bool is_flat(const std::vector<Point>& nodes, const Tet& tet) {
  double longest = 0;
  for (std::size_t a = 0; a < 4; ++a)
    for (std::size_t b = a + 1; b < 4; ++b)
      longest = std::max(longest, norm(subtract(node(nodes, tet[a]), node(nodes, tet[b]))));
  return !(std::abs(volume6(nodes, tet)) > flat_volume6 * longest * longest * longest);
}

/// For every tet whether an earlier one has the same nodes.
std::vector<char> repeated_tets(const std::vector<Tet>& tets) {
  std::vector<std::pair<Tet, std::size_t>> keys;
  keys.reserve(tets.size());
  for (std::size_t t = 0; t < tets.size(); ++t) {
    keys.emplace_back(tets[t], t);
    std::ranges::sort(keys.back().first);
  }
  std::ranges::sort(keys);
  std::vector<char> repeated(tets.size(), 0);
  for (std::size_t i = 1; i < keys.size(); ++i)
    if (keys[i].first == keys[i - 1].first) repeated[keys[i].second] = 1;
  return repeated;
}

void drop(SortedTets& sorted, const std::vector<char>& unwanted) {
  std::size_t kept = 0;
  for (std::size_t t = 0; t < sorted.tets.size(); ++t) {
    if (unwanted[t] != 0) continue;
    sorted.tets[kept] = sorted.tets[t];
    if (!sorted.labels.empty()) sorted.labels[kept] = sorted.labels[t];
    ++kept;
  }
  sorted.dropped_count += sorted.tets.size() - kept;
  sorted.tets.resize(kept);
  if (!sorted.labels.empty()) sorted.labels.resize(kept);
}

Status drop_degenerate(SortedTets& sorted, bool mend) {
  const std::vector<Point>& nodes = sorted.nodes;
  std::vector<char> unwanted = repeated_tets(sorted.tets);
  const auto repeated_count = std::ranges::count(unwanted, 1);
  std::size_t flat_count = 0;
  for (std::size_t t = 0; t < sorted.tets.size(); ++t) {
    if (unwanted[t] != 0 || !is_flat(nodes, sorted.tets[t])) continue;
    unwanted[t] = 1;
    ++flat_count;
  }
  const std::string what = std::to_string(flat_count) + " flat and " + std::to_string(repeated_count) +
                           " repeated tets of " + std::to_string(sorted.tets.size());
  if (flat_count + static_cast<std::size_t>(repeated_count) == 0) return {};
  if (!mend) return make_issue(IssueCode::tet_degenerate, what);
  drop(sorted, unwanted);
  if (sorted.tets.empty())
    return make_issue(IssueCode::tet_degenerate, what, {}, "Nothing would be left of this mesh.");
  return {};
}

Status orient(SortedTets& sorted, bool mend) {
  const auto is_negative = [&](const Tet& tet) { return volume6(sorted.nodes, tet) < 0; };
  const auto negative_count = static_cast<std::size_t>(std::ranges::count_if(sorted.tets, is_negative));
  const std::size_t other = std::min(negative_count, sorted.tets.size() - negative_count);
  if (other > 0 && !mend)
    return make_issue(IssueCode::tet_inverted,
                      std::to_string(other) + " of " + std::to_string(sorted.tets.size()) + " tets");
  for (Tet& tet : sorted.tets)
    if (is_negative(tet)) std::swap(tet[2], tet[3]);
  sorted.turned_count = negative_count;
  return {};
}

/// Edges and nodes where the boundary is no surface.
struct Hinges {
  std::size_t edge_count = 0, node_count = 0;
  bool any() const { return edge_count + node_count > 0; }
};

Hinges find_hinges(const std::vector<Tet>& tets, std::size_t node_count) {
  const SurfaceTopology found = measure_topology(boundary_triangles(tets), node_count);
  return {found.nonmanifold_edge_count, found.nonmanifold_vertex_count};
}

Status part_at_hinges(SortedTets& sorted, bool mend) {
  const TetPieces pieces = find_tet_pieces(sorted.tets);
  if (pieces.crowded_face_count > 0)
    return make_issue(IssueCode::tet_not_manifold,
                      std::to_string(pieces.crowded_face_count) + " faces of more than two tets", {},
                      "Separate the tets in the program that made the mesh.");
  Hinges hinges = find_hinges(sorted.tets, sorted.nodes.size());
  if (hinges.any() && mend) {
    drop(sorted, tets_of_smaller_touching_pieces(sorted.nodes, sorted.tets, pieces));
    sorted.split_node_count = split_pinched_nodes(sorted.nodes, sorted.tets);
    hinges = find_hinges(sorted.tets, sorted.nodes.size());
  }
  if (!hinges.any()) return {};
  return make_issue(IssueCode::tet_not_manifold, std::to_string(hinges.edge_count) + " edges and " +
                                                     std::to_string(hinges.node_count) +
                                                     " nodes where the boundary touches itself");
}

}  // namespace

Result<SortedTets> sort_out_tets(std::vector<Point> nodes, std::vector<Tet> tets,
                                 std::vector<std::int64_t> labels, bool mend) {
  SortedTets sorted;
  sorted.nodes = std::move(nodes);
  sorted.tets = std::move(tets);
  sorted.labels = std::move(labels);
  if (const Status done = drop_degenerate(sorted, mend); !done) return done.issue();
  if (const Status done = orient(sorted, mend); !done) return done.issue();
  if (const Status done = part_at_hinges(sorted, mend); !done) return done.issue();
  return sorted;
}

}  // namespace souple
