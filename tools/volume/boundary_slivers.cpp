// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/volume/boundary_slivers.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <set>
#include <vector>

#include "tools/geometry/vector.hpp"
#include "tools/volume/tet_shape.hpp"

namespace souple {
namespace {

constexpr int most_rounds = 5;
/// The two faces on the boundary turn by no more than 20 degrees.
const double flat_cosine = std::cos(20 * std::numbers::pi / 180);

using Edge = std::array<Index, 2>;

Triangle sorted(Triangle t) {
  std::ranges::sort(t);
  return t;
}

Edge edge_of(Index a, Index b) { return {std::min(a, b), std::max(a, b)}; }

struct Rim {
  std::set<Triangle> faces;
  std::set<Edge> edges;
  explicit Rim(const std::vector<Tet>& tets) {
    for (const Triangle& t : boundary_triangles(tets)) {
      faces.insert(sorted(t));
      for (std::size_t k = 0; k < 3; ++k) edges.insert(edge_of(t[k], t[(k + 1) % 3]));
    }
  }
};

/// Corners opposite the two boundary faces of the tet; false if it has another number of them.
bool two_boundary_faces(const Tet& tet, const Rim& rim, std::array<std::size_t, 2>& opposite) {
  std::size_t count = 0;
  for (std::size_t k = 0; k < 4; ++k) {
    if (!rim.faces.contains(sorted({tet[(k + 1) % 4], tet[(k + 2) % 4], tet[(k + 3) % 4]}))) continue;
    if (count < 2) opposite[count] = k;
    ++count;
  }
  return count == 2;
}

/// Area vector of the face opposite corner k, inward or outward alike for all k.
Point face_area(const TetCorners& x, std::size_t k) {
  constexpr std::size_t faces[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};
  const Point &a = x[faces[k][0]], &b = x[faces[k][1]], &c = x[faces[k][2]];
  return cross(subtract(b, a), subtract(c, a));
}

bool lies_flat(const TetCorners& x, const std::array<std::size_t, 2>& opposite) {
  const Point a = face_area(x, opposite[0]), b = face_area(x, opposite[1]);
  return dot(a, b) > flat_cosine * norm(a) * norm(b);
}

}  // namespace

void peel_boundary_slivers(TetMesh& mesh, double least_dihedral_deg) {
  for (int round = 0; round < most_rounds; ++round) {
    Rim rim(mesh.tets);
    std::vector<bool> touched(mesh.nodes.size(), false);
    std::vector<Tet> kept;
    for (const Tet& tet : mesh.tets) {
      const TetCorners x = corners_of(mesh, tet);
      std::array<std::size_t, 2> opposite{};
      // Neighbours of what was taken away in this round wait for the next, with a new rim.
      const bool peel =
          smallest_dihedral_deg(x) < least_dihedral_deg &&
          std::ranges::none_of(tet, [&](Index i) { return touched[static_cast<std::size_t>(i)]; }) &&
          two_boundary_faces(tet, rim, opposite) && lies_flat(x, opposite) &&
          // The new boundary edge joins the corners opposite the two old faces; were it one already,
          // the boundary would touch itself there.
          rim.edges.insert(edge_of(tet[opposite[0]], tet[opposite[1]])).second;
      if (!peel) {
        kept.push_back(tet);
        continue;
      }
      for (const Index i : tet) touched[static_cast<std::size_t>(i)] = true;
    }
    if (kept.size() == mesh.tets.size()) return;
    mesh.tets = std::move(kept);
  }
}

}  // namespace souple
