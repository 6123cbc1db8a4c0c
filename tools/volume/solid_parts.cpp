// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/volume/solid_parts.hpp"

#include <algorithm>
#include <array>
#include <map>
#include <numeric>
#include <span>
#include <vector>

namespace souple {
namespace {

/// Sets of items that were joined, by the lowest item of each.
class Unions {
 public:
  explicit Unions(std::size_t count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), 0); }
  std::size_t find(std::size_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void join(std::size_t a, std::size_t b) {
    a = find(a);
    b = find(b);
    parent_[std::max(a, b)] = std::min(a, b);
  }

 private:
  std::vector<std::size_t> parent_;
};

struct Face {
  Triangle nodes;  ///< sorted
  std::size_t tet;
};

std::vector<Face> sorted_faces(std::span<const Tet> tets) {
  std::vector<Face> faces;
  for (std::size_t t = 0; t < tets.size(); ++t)
    for (std::size_t k = 0; k < 4; ++k) {
      Triangle f{tets[t][(k + 1) % 4], tets[t][(k + 2) % 4], tets[t][(k + 3) % 4]};
      std::ranges::sort(f);
      faces.push_back({f, t});
    }
  std::ranges::sort(faces, [](const Face& a, const Face& b) {
    return a.nodes != b.nodes ? a.nodes < b.nodes : a.tet < b.tet;
  });
  return faces;
}

/// Part of every tet, by the lowest tet of the part; only faces with all of `around` join.
std::vector<std::size_t> parts_of(std::span<const Tet> tets, std::span<const Index> around) {
  Unions unions(tets.size());
  const std::vector<Face> faces = sorted_faces(tets);
  for (std::size_t i = 1; i < faces.size(); ++i) {
    const Triangle& f = faces[i].nodes;
    const bool counts =
        std::ranges::all_of(around, [&](Index n) { return std::ranges::count(f, n) > 0; });
    if (counts && faces[i - 1].nodes == f) unions.join(faces[i - 1].tet, faces[i].tet);
  }
  std::vector<std::size_t> parts(tets.size());
  for (std::size_t t = 0; t < tets.size(); ++t) parts[t] = unions.find(t);
  return parts;
}

std::vector<std::vector<std::size_t>> tets_at_nodes(const TetMesh& mesh) {
  std::vector<std::vector<std::size_t>> at(mesh.nodes.size());
  for (std::size_t t = 0; t < mesh.tets.size(); ++t)
    for (const Index i : mesh.tets[t]) at[static_cast<std::size_t>(i)].push_back(t);
  return at;
}

/// Marks all groups but the largest of the tets around a node or an edge.
void mark_minor_groups(const TetMesh& mesh, const std::vector<std::size_t>& candidates,
                       std::span<const Index> around, std::vector<bool>& doomed) {
  std::vector<Tet> tets;
  std::vector<std::size_t> ids;
  for (const std::size_t t : candidates) {
    const Tet& tet = mesh.tets[t];
    if (!std::ranges::all_of(around, [&](Index n) { return std::ranges::count(tet, n) > 0; })) continue;
    tets.push_back(tet);
    ids.push_back(t);
  }
  const std::vector<std::size_t> parts = parts_of(tets, around);
  std::map<std::size_t, std::size_t> sizes;
  for (const std::size_t p : parts) ++sizes[p];
  if (sizes.size() < 2) return;
  const auto largest =
      std::ranges::max_element(sizes, [](const auto& a, const auto& b) { return a.second < b.second; });
  for (std::size_t i = 0; i < ids.size(); ++i)
    if (parts[i] != largest->first) doomed[ids[i]] = true;
}

void remove(TetMesh& mesh, const std::vector<bool>& doomed) {
  std::size_t kept = 0;
  for (std::size_t t = 0; t < mesh.tets.size(); ++t)
    if (!doomed[t]) mesh.tets[kept++] = mesh.tets[t];
  mesh.tets.resize(kept);
}

/// Edges of more than two boundary triangles.
std::vector<std::array<Index, 2>> pinched_edges(const std::vector<Triangle>& boundary) {
  std::vector<std::array<Index, 2>> edges, pinched;
  for (const Triangle& t : boundary)
    for (std::size_t k = 0; k < 3; ++k)
      edges.push_back({std::min(t[k], t[(k + 1) % 3]), std::max(t[k], t[(k + 1) % 3])});
  std::ranges::sort(edges);
  for (std::size_t i = 2; i < edges.size(); ++i)
    if (edges[i] == edges[i - 2] && (pinched.empty() || pinched.back() != edges[i]))
      pinched.push_back(edges[i]);
  return pinched;
}

/// Nodes whose boundary triangles form several fans.
std::vector<Index> pinched_nodes(const std::vector<Triangle>& boundary, std::size_t node_count) {
  std::vector<std::vector<std::size_t>> at(node_count);
  for (std::size_t t = 0; t < boundary.size(); ++t)
    for (const Index i : boundary[t]) at[static_cast<std::size_t>(i)].push_back(t);
  std::vector<Index> pinched;
  for (std::size_t n = 0; n < node_count; ++n) {
    const auto& fan = at[n];
    Unions unions(fan.size());
    std::map<Index, std::size_t> first_with;
    for (std::size_t i = 0; i < fan.size(); ++i)
      for (const Index other : boundary[fan[i]]) {
        if (other == static_cast<Index>(n)) continue;
        const auto [found, is_new] = first_with.try_emplace(other, i);
        if (!is_new) unions.join(found->second, i);
      }
    for (std::size_t i = 0; i < fan.size(); ++i)
      if (unions.find(i) != 0) {
        pinched.push_back(static_cast<Index>(n));
        break;
      }
  }
  return pinched;
}

}  // namespace

void remove_pinches(TetMesh& mesh) {
  for (bool found = true; found && !mesh.tets.empty();) {
    const std::vector<Triangle> boundary = boundary_triangles(mesh.tets);
    const auto at = tets_at_nodes(mesh);
    std::vector<bool> doomed(mesh.tets.size(), false);
    for (const auto& edge : pinched_edges(boundary))
      mark_minor_groups(mesh, at[static_cast<std::size_t>(edge[0])], edge, doomed);
    if (std::ranges::find(doomed, true) == doomed.end())
      for (const Index n : pinched_nodes(boundary, mesh.nodes.size())) {
        const auto& around = at[static_cast<std::size_t>(n)];
        mark_minor_groups(mesh, around, {{n}}, doomed);
        // A node where two cavities meet has one group of tets: open it by taking them all.
        if (std::ranges::none_of(around, [&](std::size_t t) { return doomed[t]; }))
          for (const std::size_t t : around) doomed[t] = true;
      }
    found = std::ranges::find(doomed, true) != doomed.end();
    remove(mesh, doomed);
  }
}

std::size_t keep_largest_parts(TetMesh& mesh, std::size_t count) {
  const std::vector<std::size_t> parts = parts_of(mesh.tets, {});
  std::map<std::size_t, std::size_t> sizes;
  for (const std::size_t p : parts) ++sizes[p];
  std::vector<std::array<std::size_t, 2>> order;  // size, part
  for (const auto& [part, size] : sizes) order.push_back({size, part});
  std::ranges::sort(
      order, [](const auto& a, const auto& b) { return a[0] != b[0] ? a[0] > b[0] : a[1] < b[1]; });
  if (order.size() <= count) return order.size();
  std::vector<std::size_t> dropped;
  for (std::size_t i = count; i < order.size(); ++i) dropped.push_back(order[i][1]);
  std::ranges::sort(dropped);
  std::vector<bool> doomed(mesh.tets.size());
  for (std::size_t t = 0; t < mesh.tets.size(); ++t)
    doomed[t] = std::ranges::binary_search(dropped, parts[t]);
  remove(mesh, doomed);
  return order.size();
}

void drop_unused_nodes(TetMesh& mesh) {
  std::vector<Index> rank(mesh.nodes.size(), -1);
  std::vector<Point> nodes;
  for (Tet& tet : mesh.tets)
    for (Index& i : tet) {
      Index& r = rank[static_cast<std::size_t>(i)];
      if (r < 0) {
        r = static_cast<Index>(nodes.size());
        nodes.push_back(mesh.nodes[static_cast<std::size_t>(i)]);
      }
      i = r;
    }
  mesh.nodes = std::move(nodes);
}

}  // namespace souple
