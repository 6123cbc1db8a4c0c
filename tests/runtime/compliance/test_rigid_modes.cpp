// SPDX-License-Identifier: MIT
#include "runtime/compliance/rigid_modes.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "tests/support/box_mesh.hpp"
#include "tests/support/dense_compliance.hpp"

namespace souple {
namespace {

constexpr double density = 900;

struct Fixture {
  explicit Fixture(const Point& origin = {0.3, -0.2, 0.1})
      : mesh(test::irregular_box_mesh({4, 2, 3}, origin, {0.2, 0.1, 0.15}, 0.8)),
        masses(test::lumped_masses(mesh, density)),
        modes(mesh.nodes, std::span(masses.data(), std::size_t(masses.size()))) {}

  Vec3 node(Eigen::Index i) const { return as_vec3(mesh.nodes[std::size_t(i)]); }

  /// Columns: translations along and rotations about the axes of the world, 3n by 6.
  Eigen::MatrixXd rigid_motions() const {
    Eigen::MatrixXd motions(3 * masses.size(), 6);
    for (Eigen::Index i = 0; i < masses.size(); ++i)
      for (int axis = 0; axis < 3; ++axis) {
        motions.block<3, 1>(3 * i, axis) = Vec3::Unit(axis);
        motions.block<3, 1>(3 * i, 3 + axis) = Vec3::Unit(axis).cross(node(i));
      }
    return motions;
  }
  Eigen::VectorXd mass_diagonal() const {
    Eigen::VectorXd diagonal(3 * masses.size());
    for (Eigen::Index i = 0; i < diagonal.size(); ++i) diagonal[i] = masses[i / 3];
    return diagonal;
  }
  /// All blocks between nodes, 3n by 3n.
  Eigen::MatrixXd between_nodes() const {
    Eigen::MatrixXd all(3 * masses.size(), 3 * masses.size());
    for (Eigen::Index i = 0; i < masses.size(); ++i)
      for (Eigen::Index j = 0; j < masses.size(); ++j)
        all.block<3, 3>(3 * i, 3 * j) = modes.block(node(i), node(j));
    return all;
  }

  TetMesh mesh;
  Eigen::VectorXd masses;
  RigidModes modes;
};

TEST(RigidModes, AreTheInverseMassOnRigidMotions) {
  const Fixture f;
  const Eigen::MatrixXd b = f.rigid_motions();
  const Eigen::MatrixXd inner = b.transpose() * f.mass_diagonal().asDiagonal() * b;
  const Eigen::MatrixXd expected = b * inner.fullPivLu().solve(b.transpose());
  EXPECT_LT((f.between_nodes() - expected).norm() / expected.norm(), 1e-11);
}

TEST(RigidModes, HoldTheWholeRigidPartOfAFreeRestCompliance) {
  const Fixture f;
  const double mass_factor = 1e4, stiffness_factor = 2;
  const Eigen::MatrixXd c = test::dense_compliance(f.mesh, test::material_of(1e4, 0.4, density),
                                                   mass_factor, stiffness_factor, {});
  const Eigen::MatrixXd left = c - f.between_nodes() / mass_factor;
  const Eigen::MatrixXd momenta = f.mass_diagonal().asDiagonal() * f.rigid_motions();
  EXPECT_LT((left * momenta).norm() / (c * momenta).norm(), 1e-10);
  const Eigen::VectorXd eigenvalues = left.selfadjointView<Eigen::Lower>().eigenvalues();
  EXPECT_GT(eigenvalues.minCoeff(), -1e-12 * eigenvalues.maxCoeff());
}

TEST(RigidModes, TranslateUnderAForceAtTheCentre) {
  const Fixture f;
  EXPECT_NEAR(f.modes.inverse_mass() * density * 0.2 * 0.1 * 0.15, 1, 1e-12);
  for (const Vec3& point : {Vec3(0, 0, 0), Vec3(1, 2, -3)})
    EXPECT_LT(
        (f.modes.block(point, f.modes.centre()) - f.modes.inverse_mass() * Mat3::Identity()).norm(),
        1e-12 * f.modes.inverse_mass());
}

TEST(RigidModes, AreSymmetricAndDoNotDependOnTheOrigin) {
  const Fixture here({0, 0, 0}), there({1, 2, 3});
  const Vec3 a(0.1, 0, 0.05), b(0, 0.1, 0.02), shift(1, 2, 3);
  const Mat3 block = here.modes.block(a, b);
  EXPECT_LT((block - here.modes.block(b, a).transpose()).norm(), 1e-14 * block.norm());
  EXPECT_LT((block - there.modes.block(a + shift, b + shift)).norm(), 1e-10 * block.norm());
}

}  // namespace
}  // namespace souple
