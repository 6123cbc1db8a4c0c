// SPDX-License-Identifier: MIT
#pragma once
#include <random>

#include "runtime/collision/surface_tree.hpp"
#include "tests/support/box_mesh.hpp"

namespace souple::test {

inline Vec3 random_direction(std::mt19937& random) {
  std::normal_distribution<double> normal;
  return Vec3(normal(random), normal(random), normal(random)).normalized();
}

inline Mat3 random_turn(std::mt19937& random) {
  std::uniform_real_distribution<double> uniform(-1, 1);
  return Eigen::AngleAxisd(3.2 * uniform(random), random_direction(random)).toRotationMatrix();
}

/// A box of tets with a collision surface, to be moved and bent.
struct CollisionBody {
  CollisionBody(const std::array<int, 3>& cells, const Point& size)
      : CollisionBody(
            test::level_of(test::box_mesh(cells, {-size[0] / 2, -size[1] / 2, -size[2] / 2}, size))) {}
  explicit CollisionBody(MeshLevel mesh)
      : level(std::move(mesh)),
        tree(level.mesh.nodes, level.boundary),
        x(3 * Eigen::Index(level.mesh.nodes.size())),
        surface(tree) {
    place(Mat3::Identity(), Vec3::Zero());
  }
  void place(const Mat3& map, const Vec3& shift) {
    for (std::size_t n = 0; n < level.mesh.nodes.size(); ++n)
      x.segment<3>(3 * Eigen::Index(n)) = map * as_vec3(level.mesh.nodes[n]) + shift;
    surface.refit(x);
  }
  // A rotation, a stretch and every node on its own.
  void deform(std::mt19937& random, double shake, const Vec3& shift) {
    std::uniform_real_distribution<double> uniform(-1, 1);
    const Mat3 turn = random_turn(random);
    const Vec3 stretch(1 + 0.3 * uniform(random), 1 + 0.3 * uniform(random), 1 + 0.3 * uniform(random));
    place(turn * stretch.asDiagonal(), shift);
    for (Eigen::Index k = 0; k < x.size(); ++k) x[k] += shake * uniform(random);
    surface.refit(x);
  }
  CollisionBody(const CollisionBody&) = delete;

  MeshLevel level;
  SurfaceTree tree;
  Eigen::VectorXd x;
  DeformedSurface surface;
};

}  // namespace souple::test
