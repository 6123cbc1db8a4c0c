// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/hierarchy/tet_weights.hpp"

#include <algorithm>
#include <cmath>
#include <string>

namespace souple {
namespace {

constexpr double farthest_m = 1e15;

std::size_t at(Index i) { return static_cast<std::size_t>(i); }

Issue invalid(const std::string& what) { return make_issue(IssueCode::mesh_element_invalid, what); }

}  // namespace

std::array<double, 4> barycentric_weights(const Point& p, const Tet& tet,
                                          std::span<const Point> nodes) {
  const Point &a = nodes[at(tet[0])], &b = nodes[at(tet[1])], &c = nodes[at(tet[2])],
              &d = nodes[at(tet[3])];
  const double volume = signed_volume6(a, b, c, d);
  const double wb = signed_volume6(a, p, c, d) / volume;
  const double wc = signed_volume6(a, b, p, d) / volume;
  const double wd = signed_volume6(a, b, c, p) / volume;
  return {1 - wb - wc - wd, wb, wc, wd};
}

bool is_within_reach(const Point& p) {
  return std::ranges::all_of(p, [](double x) { return std::abs(x) <= farthest_m; });
}

Status check_tet_mesh(const TetMesh& mesh) {
  if (mesh.tets.empty()) return invalid("the mesh has no tets");
  for (std::size_t i = 0; i < mesh.nodes.size(); ++i)
    if (!is_within_reach(mesh.nodes[i]))
      return invalid("node " + std::to_string(i) + " is not finite or too far out");
  for (std::size_t t = 0; t < mesh.tets.size(); ++t) {
    const Tet& tet = mesh.tets[t];
    for (const Index i : tet)
      if (i < 0 || at(i) >= mesh.nodes.size())
        return invalid("tet " + std::to_string(t) + " names a node outside the mesh");
    if (!(signed_volume6(mesh.nodes[at(tet[0])], mesh.nodes[at(tet[1])], mesh.nodes[at(tet[2])],
                         mesh.nodes[at(tet[3])]) > 0))
      return invalid("tet " + std::to_string(t) + " is flat or inverted");
  }
  return {};
}

}  // namespace souple
