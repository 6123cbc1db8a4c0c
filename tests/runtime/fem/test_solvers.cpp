// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <numeric>

#include "runtime/fem/conjugate_gradient.hpp"
#include "runtime/fem/corotational_model.hpp"
#include "runtime/fem/sparse_factor.hpp"
#include "tests/support/box_mesh.hpp"
#include "tests/support/dense_compliance.hpp"

namespace souple {
namespace {

struct System {
  CorotationalModel model;
  BlockMatrix a;
  Eigen::MatrixXd dense;
};

System make_system(double mass_factor) {
  const TetMesh mesh = test::irregular_box_mesh({4, 3, 3}, {0, 0, 0}, {0.2, 0.15, 0.15}, 1.0);
  const Material material = test::material_of(1e4, 0.4, 1000);
  System s{std::move(*CorotationalModel::create(mesh, material)), BlockMatrix(BlockPattern{}), {}};
  s.a = BlockMatrix(s.model.pattern());
  s.model.assemble_rest(mass_factor, 2, s.a);
  s.dense = 2 * test::dense_stiffness(mesh, 1e4, 0.4);
  const Eigen::VectorXd masses = test::lumped_masses(mesh, 1000);
  for (Eigen::Index i = 0; i < s.dense.rows(); ++i) s.dense(i, i) += mass_factor * masses[i / 3];
  return s;
}

TEST(ConjugateGradient, SolvesToTheToleranceThatItReports) {
  System s = make_system(1e4);
  s.a.pattern = &s.model.pattern();
  const Eigen::VectorXd b = Eigen::VectorXd::Random(s.dense.rows());
  ConjugateGradient solver(s.model.node_count());
  for (const double tolerance : {1e-2, 1e-6, 1e-10}) {
    Eigen::VectorXd x = Eigen::VectorXd::Zero(b.size());
    const auto report = solver.solve(s.a, b, tolerance, b.norm(), 1000, x);
    EXPECT_TRUE(report.converged);
    const double measured = (b - s.dense * x).norm() / b.norm();
    EXPECT_LE(measured, 1.01 * tolerance);
    EXPECT_NEAR(measured, report.relative_residual, 1e-12);
  }
}

TEST(ConjugateGradient, GaussSeidelPreconditioningBeatsNone) {
  System s = make_system(1e3);
  s.a.pattern = &s.model.pattern();
  const Eigen::VectorXd b = Eigen::VectorXd::Random(s.dense.rows());
  Eigen::VectorXd x = Eigen::VectorXd::Zero(b.size());
  ConjugateGradient solver(s.model.node_count());
  const auto report = solver.solve(s.a, b, 1e-8, b.norm(), 1000, x);
  // Plain conjugate gradients on the dense matrix, as the reference.
  Eigen::VectorXd y = Eigen::VectorXd::Zero(b.size()), r = b, p = b;
  int plain = 0;
  for (; r.norm() > 1e-8 * b.norm() && plain < 5000; ++plain) {
    const Eigen::VectorXd ap = s.dense * p;
    const double rr = r.squaredNorm(), step = rr / p.dot(ap);
    y += step * p;
    r -= step * ap;
    p = r + r.squaredNorm() / rr * p;
  }
  EXPECT_LT(2 * report.iterations, plain);
  EXPECT_LT((x - y).norm() / y.norm(), 1e-5);
}

TEST(ConjugateGradient, SaysSoWhenTheIterationsRunOut) {
  System s = make_system(1e2);
  s.a.pattern = &s.model.pattern();
  const Eigen::VectorXd b = Eigen::VectorXd::Random(s.dense.rows());
  Eigen::VectorXd x = Eigen::VectorXd::Zero(b.size());
  ConjugateGradient solver(s.model.node_count());
  const auto report = solver.solve(s.a, b, 1e-12, b.norm(), 3, x);
  EXPECT_FALSE(report.converged);
  EXPECT_EQ(report.iterations, 3);
  EXPECT_NEAR((b - s.dense * x).norm() / b.norm(), report.relative_residual, 1e-10);
}

TEST(SparseFactor, SolvesOnChosenNodes) {
  System s = make_system(1e3);
  s.a.pattern = &s.model.pattern();
  std::vector<Index> nodes;
  std::vector<Eigen::Index> unknowns;
  for (Index n = 0; n < s.model.node_count(); ++n)
    if (n % 3 != 1) {
      nodes.push_back(n);
      for (int c = 0; c < 3; ++c) unknowns.push_back(3 * n + c);
    }
  SparseFactor factor;
  factor.analyze(&s.model.pattern(), nodes);
  ASSERT_TRUE(factor.factorize(s.a));
  ASSERT_EQ(factor.size(), Eigen::Index(unknowns.size()));
  const Eigen::VectorXd b = Eigen::VectorXd::Random(factor.size());
  Eigen::VectorXd x = b, work(factor.size());
  factor.solve(x, work);
  EXPECT_LT((s.dense(unknowns, unknowns) * x - b).norm() / b.norm(), 1e-11);
}

TEST(SparseFactor, RefusesAnIndefiniteMatrix) {
  System s = make_system(-1e6);
  s.a.pattern = &s.model.pattern();
  std::vector<Index> nodes(std::size_t(s.model.node_count()));
  std::iota(nodes.begin(), nodes.end(), 0);
  SparseFactor factor;
  factor.analyze(&s.model.pattern(), nodes);
  EXPECT_FALSE(factor.factorize(s.a));
}

TEST(BlockMatrix, MultipliesLikeTheDenseMatrix) {
  System s = make_system(1e3);
  s.a.pattern = &s.model.pattern();
  const Eigen::VectorXd x = Eigen::VectorXd::Random(s.dense.rows());
  Eigen::VectorXd y(x.size());
  multiply(s.a, x, y);
  EXPECT_LT((y - s.dense * x).norm() / y.norm(), 1e-13);
}

}  // namespace
}  // namespace souple
