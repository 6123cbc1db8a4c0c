// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/hierarchy/level_embedding.hpp"

#include <algorithm>
#include <cmath>

#include "tools/geometry/vector.hpp"
#include "tools/hierarchy/tet_shape.hpp"
#include "tools/hierarchy/tet_weights.hpp"

namespace souple {
namespace {

std::size_t at(Index i) { return static_cast<std::size_t>(i); }

/// Weights of two tets that differ by less than this are equally good: the lower index wins.
constexpr double as_good = 1e-12;

/// |P r - r| over |r| for rotations r about the three axes through the centroid; the worst. A row of P
/// sums to 1, so that P (axis x (x - c)) - axis x (x - c) = axis x (P x_coarse - x).
double rotation_error(const std::vector<Point>& fine, const std::vector<Point>& carried) {
  Point centre{};
  for (const Point& x : fine) centre = add(centre, scaled(x, 1 / static_cast<double>(fine.size())));
  double worst = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    Point e{};
    e[axis] = 1;
    double error2 = 0, motion2 = 0;
    for (std::size_t i = 0; i < fine.size(); ++i) {
      error2 += squared_norm(cross(e, subtract(carried[i], fine[i])));
      motion2 += squared_norm(cross(e, subtract(fine[i], centre)));
    }
    if (motion2 > 0) worst = std::max(worst, std::sqrt(error2 / motion2));
  }
  return worst;
}

}  // namespace

std::vector<Embedding> embed_children(const std::vector<Point>& nodes,
                                      const std::vector<std::array<Index, 2>>& parents,
                                      const TetMesh& coarse) {
  const NodeTets node_tets(coarse);
  std::vector<Embedding> rows;
  rows.reserve(nodes.size());
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    Embedding best;
    double most = -std::numeric_limits<double>::infinity();
    for (const Index parent : parents[i])
      for (const auto& [tet, corner] : node_tets.of(at(parent))) {
        const auto weights = barycentric_weights(nodes[i], coarse.tets[at(tet)], coarse.nodes);
        const double least = std::ranges::min(weights);
        if (least > most + as_good || (least > most - as_good && tet < best.tet)) {
          best = {tet, weights};
          most = least;
        }
      }
    rows.push_back(best);
  }
  return rows;
}

RigidMotionError measure_rigid_motion(const MeshLevel& level, const TetMesh& coarse) {
  RigidMotionError error;
  std::vector<Point> carried(level.mesh.nodes.size());
  if (!level.parents.empty()) {
    for (std::size_t i = 0; i < carried.size(); ++i) {
      const auto [a, b] = level.parents[i];
      carried[i] = scaled(add(coarse.nodes[at(a)], coarse.nodes[at(b)]), 0.5);
    }
    error.parents = rotation_error(level.mesh.nodes, carried);
  }
  if (!level.embedding.empty()) {
    for (std::size_t i = 0; i < carried.size(); ++i) {
      const auto& [tet, weights] = level.embedding[i];
      carried[i] = {};
      for (std::size_t k = 0; k < 4; ++k)
        carried[i] = add_scaled(carried[i], weights[k], coarse.nodes[at(coarse.tets[at(tet)][k])]);
    }
    error.embedding = rotation_error(level.mesh.nodes, carried);
  }
  return error;
}

}  // namespace souple
