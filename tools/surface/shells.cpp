// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/surface/shells.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <optional>
#include <set>
#include <utility>

#include "tools/geometry/winding_number.hpp"

namespace souple {
namespace {

std::size_t at(Index i) { return static_cast<std::size_t>(i); }

bool is_inside(const Box& inner, const Box& outer) {
  for (std::size_t k = 0; k < 3; ++k)
    if (inner.low[k] < outer.low[k] || inner.high[k] > outer.high[k]) return false;
  return true;
}

std::vector<TriangleMesh> meshes_of_shells(const TriangleMesh& mesh, const std::vector<Index>& shell,
                                           std::size_t count) {
  std::vector<TriangleMesh> parts(count);
  std::vector<Index> number(mesh.vertices.size(), -1);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    TriangleMesh& part = parts[at(shell[t])];
    Triangle& triangle = part.triangles.emplace_back();
    for (std::size_t k = 0; k < 3; ++k) {
      Index& i = number[at(mesh.triangles[t][k])];
      if (i < 0) {
        i = static_cast<Index>(part.vertices.size());
        part.vertices.push_back(mesh.vertices[at(mesh.triangles[t][k])]);
      }
      triangle[k] = i;
    }
  }
  return parts;
}

/// The sides opposite to a vertex, sorted: tells vertices at the same position apart.
using Fan = std::vector<std::array<Point, 2>>;

std::vector<Fan> fans_of(const TriangleMesh& mesh) {
  std::vector<Fan> fans(mesh.vertices.size());
  for (const Triangle& t : mesh.triangles)
    for (std::size_t k = 0; k < 3; ++k)
      fans[at(t[k])].push_back({mesh.vertices[at(t[(k + 1) % 3])], mesh.vertices[at(t[(k + 2) % 3])]});
  for (Fan& fan : fans) std::ranges::sort(fan);
  return fans;
}

void find_depths(std::vector<Shell>& shells, const std::set<std::pair<Index, Index>>& crossing) {
  for (std::size_t outer = 0; outer < shells.size(); ++outer) {
    if (!shells[outer].oriented) continue;
    std::optional<WindingNumber> winding;  // built for the first candidate
    for (std::size_t inner = 0; inner < shells.size(); ++inner) {
      if (inner == outer || !is_inside(shells[inner].box, shells[outer].box) ||
          crossing.contains({static_cast<Index>(inner), static_cast<Index>(outer)}))
        continue;
      if (!winding) winding.emplace(shells[outer].mesh);
      if (std::abs(winding->at(shells[inner].mesh.vertices.front())) > 0.5) ++shells[inner].depth;
    }
  }
}

std::size_t shell_count(const std::vector<Index>& shell) {
  return shell.empty() ? 0 : at(std::ranges::max(shell)) + 1;
}

}  // namespace

std::vector<Shell> split_into_shells(const TriangleMesh& mesh, const std::vector<TrianglePair>& cuts) {
  const std::vector<Index> number = shell_of_triangles(mesh.triangles, mesh.vertices.size());
  std::vector<Shell> shells;
  for (TriangleMesh& part : meshes_of_shells(mesh, number, shell_count(number))) {
    Shell& shell = shells.emplace_back();
    const SurfaceTopology topology = measure_topology(part.triangles, part.vertices.size());
    shell.box = bounding_box(part.vertices);
    shell.closed = topology.closed();
    shell.oriented = shell.closed && topology.opposed_edge_count == 0;
    shell.volume_m3 = signed_volume(part);
    shell.mesh = std::move(part);
  }
  std::set<std::pair<Index, Index>> crossing;
  for (const auto& [s, t] : cuts) {
    const Index a = number[at(s)], b = number[at(t)];
    if (a == b) continue;
    crossing.insert({a, b});
    crossing.insert({b, a});
    shells[at(a)].is_cut = shells[at(b)].is_cut = true;
  }
  find_depths(shells, crossing);
  return shells;
}

TriangleMesh join_meshes(const std::vector<TriangleMesh>& meshes) {
  TriangleMesh all;
  for (const TriangleMesh& mesh : meshes) {
    const auto offset = static_cast<Index>(all.vertices.size());
    all.vertices.insert(all.vertices.end(), mesh.vertices.begin(), mesh.vertices.end());
    for (const Triangle& t : mesh.triangles)
      all.triangles.push_back({t[0] + offset, t[1] + offset, t[2] + offset});
  }
  return all;
}

TriangleMesh in_canonical_order(const TriangleMesh& mesh) {
  std::vector<Index> used = used_nodes(mesh.triangles);
  const std::vector<Fan> fans = fans_of(mesh);
  std::ranges::sort(used, [&](Index a, Index b) {
    const Point &p = mesh.vertices[at(a)], &q = mesh.vertices[at(b)];
    return p != q ? p < q : fans[at(a)] < fans[at(b)];
  });
  std::vector<Index> number(mesh.vertices.size(), -1);
  TriangleMesh ordered;
  for (const Index i : used) {
    number[at(i)] = static_cast<Index>(ordered.vertices.size());
    ordered.vertices.push_back(mesh.vertices[at(i)]);
  }
  for (const Triangle& t : mesh.triangles) {
    Triangle& own =
        ordered.triangles.emplace_back(Triangle{number[at(t[0])], number[at(t[1])], number[at(t[2])]});
    std::ranges::rotate(own, std::ranges::min_element(own));
  }
  std::ranges::sort(ordered.triangles);
  return ordered;
}

std::vector<std::vector<std::size_t>> groups_of_crossing_shells(const TriangleMesh& mesh,
                                                                const std::vector<TrianglePair>& cuts) {
  const std::vector<Index> shell = shell_of_triangles(mesh.triangles, mesh.vertices.size());
  std::vector<std::size_t> group(shell_count(shell));
  std::iota(group.begin(), group.end(), std::size_t{0});
  const auto root = [&](std::size_t i) {
    while (group[i] != i) i = group[i] = group[group[i]];
    return i;
  };
  for (const auto& [s, t] : cuts) {
    const std::size_t a = root(at(shell[at(s)])), b = root(at(shell[at(t)]));
    group[std::max(a, b)] = std::min(a, b);
  }
  std::vector<std::vector<std::size_t>> members(group.size()), groups;
  for (std::size_t i = 0; i < group.size(); ++i) members[root(i)].push_back(i);
  for (auto& list : members)
    if (!list.empty()) groups.push_back(std::move(list));
  return groups;
}

}  // namespace souple
