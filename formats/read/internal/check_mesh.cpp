// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <utility>

#include "formats/core/limits.hpp"
#include "formats/read/internal/check_rows.hpp"
#include "formats/read/internal/checks.hpp"

namespace souple::checks {
namespace {

bool within_limits(const MeshLevel& level, const std::string& where, IssueList& issues) {
  if (level.mesh.nodes.empty() || level.mesh.tets.empty())
    issues.add(IssueCode::asset_mesh_inconsistent, where, [] { return "no nodes or no tets"; });
  else if (level.mesh.nodes.size() > limits::nodes || level.mesh.tets.size() > limits::tets)
    issues.add(IssueCode::asset_limit_exceeded, where, [] { return "too many nodes or tets"; });
  else
    return true;
  return false;
}

void check_used(const MeshLevel& level, const std::string& where, IssueList& issues) {
  std::vector<char> used(level.mesh.nodes.size(), 0);
  for (const Tet& tet : level.mesh.tets)
    for (const Index node : tet) used[static_cast<std::size_t>(node)] = 1;
  for (std::size_t i = 0; i < used.size(); ++i)
    if (used[i] == 0)
      issues.add(IssueCode::asset_mesh_inconsistent, where,
                 [&] { return "node " + std::to_string(i) + " belongs to no tet"; });
}

using Edge = std::array<Index, 2>;

Edge sorted(Edge edge) {
  if (edge[0] > edge[1]) std::swap(edge[0], edge[1]);
  return edge;
}

std::vector<Edge> unique_edges(const std::vector<Tet>& tets) {
  std::vector<Edge> edges;
  edges.reserve(6 * tets.size());
  for (const Tet& tet : tets)
    for (std::size_t a = 0; a < 4; ++a)
      for (std::size_t b = a + 1; b < 4; ++b) edges.push_back(sorted({tet[a], tet[b]}));
  std::ranges::sort(edges);
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  return edges;
}

void check_rigid_motion_error(const MeshLevel& level, bool is_coarsest, const std::string& where,
                              IssueList& issues) {
  const auto& [parents, embedding] = level.rigid_motion_error;
  const auto sound = [](double error) { return error == -1 || (std::isfinite(error) && error >= 0); };
  if (!sound(parents) || !sound(embedding) || (is_coarsest && (parents >= 0 || embedding >= 0)) ||
      (level.parents.empty() && parents >= 0))
    issues.add(IssueCode::asset_hierarchy_invalid, where, [&] {
      return "the errors of rigid motions, " + std::to_string(parents) + " and " +
             std::to_string(embedding) + ", do not fit the level";
    });
}

/// One row of parents per node, or none.
void check_parent_count(const MeshLevel& level, bool is_coarsest, const std::string& where,
                        IssueList& issues) {
  const std::size_t rows = level.parents.size();
  const std::size_t expected = is_coarsest ? 0 : level.mesh.nodes.size();
  if (rows == 0 || rows == expected) return;
  issues.add(IssueCode::asset_hierarchy_invalid, where, [&] {
    return std::to_string(rows) + " rows of parents, not " + std::to_string(expected);
  });
}

}  // namespace

void check_level_mesh(const MeshLevel& level, const std::string& where, IssueList& issues) {
  if (!within_limits(level, where, issues)) return;
  const std::size_t node_count = level.mesh.nodes.size();
  check_coordinates(level.mesh.nodes, where, "node", issues);
  check_range(level.mesh.tets, node_count, where, "tet", "node", issues);
  check_range(level.boundary, node_count, where, "boundary triangle", "node", issues);
}

void check_level_ties(const MeshLevel& level, const MeshCounts& coarse, const std::string& where,
                      IssueList& issues) {
  const bool is_coarsest = coarse.nodes == 0;
  check_rigid_motion_error(level, is_coarsest, where, issues);
  if (!is_coarsest && level.parents.empty() && level.embedding.empty())
    issues.add(IssueCode::asset_hierarchy_invalid, where,
               [] { return "neither parents nor an embedding in the coarser level"; });
  check_parent_count(level, is_coarsest, where, issues);
  if (!is_coarsest) check_range(level.parents, coarse.nodes, where, "parents of node", "node", issues);
  if (!level.embedding.empty())
    check_embedding(level.embedding, is_coarsest ? 0 : level.mesh.nodes.size(), coarse.tets, where,
                    issues);
}

void check_level_shape(const MeshLevel& level, const std::string& where, IssueList& issues) {
  const auto& x = level.mesh.nodes;
  for (std::size_t t = 0; t < level.mesh.tets.size(); ++t) {
    const auto node = [&](std::size_t k) { return x[static_cast<std::size_t>(level.mesh.tets[t][k])]; };
    const double volume6 = signed_volume6(node(0), node(1), node(2), node(3));
    if (!(volume6 > 0))
      issues.add(IssueCode::asset_tet_inverted, where, [&] {
        return "tet " + std::to_string(t) + " has the volume " + std::to_string(volume6 / 6) + " m^3";
      });
  }
  check_used(level, where, issues);
  if (level.boundary != boundary_triangles(level.mesh.tets))
    issues.add(IssueCode::asset_mesh_inconsistent, where,
               [] { return "the stored boundary is not that of the tets"; });
}

void check_parents(const MeshLevel& coarse, const MeshLevel& fine, const std::string& where,
                   IssueList& issues) {
  if (fine.parents.empty()) return;
  const std::vector<Edge> edges = unique_edges(coarse.mesh.tets);
  std::vector<Edge> seen;
  std::size_t kept_count = 0;
  for (std::size_t i = 0; i < fine.parents.size(); ++i) {
    const Edge parents = sorted(fine.parents[i]);
    const bool kept = parents[0] == parents[1];
    kept_count += kept;
    seen.push_back(parents);
    if (!kept && !std::ranges::binary_search(edges, parents))
      issues.add(IssueCode::asset_hierarchy_invalid, where, [&] {
        return "the parents " + std::to_string(parents[0]) + " and " + std::to_string(parents[1]) +
               " of node " + std::to_string(i) + " are not an edge of the coarser level";
      });
  }
  std::ranges::sort(seen);
  if (std::ranges::adjacent_find(seen) != seen.end())
    issues.add(IssueCode::asset_hierarchy_invalid, where,
               [] { return "two nodes have the same parents"; });
  if (kept_count != coarse.mesh.nodes.size())
    issues.add(IssueCode::asset_hierarchy_invalid, where, [&] {
      return std::to_string(kept_count) + " coarse nodes are kept, not " +
             std::to_string(coarse.mesh.nodes.size());
    });
}

}  // namespace souple::checks
