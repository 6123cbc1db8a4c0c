// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <numeric>

#include "runtime/fem/corotational_model.hpp"
#include "runtime/fem/sparse_factor.hpp"
#include "tests/support/allocation_count.hpp"
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
  factor.analyze(s.model.pattern(), s.model.rest_positions(), nodes);
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
  factor.analyze(s.model.pattern(), s.model.rest_positions(), nodes);
  EXPECT_FALSE(factor.factorize(s.a));
}

TEST(SparseFactor, FactorisesAgainWithoutAllocating) {
  System s = make_system(1e3);
  s.a.pattern = &s.model.pattern();
  std::vector<Index> nodes(std::size_t(s.model.node_count()));
  std::iota(nodes.begin(), nodes.end(), 0);
  SparseFactor factor;
  factor.analyze(s.model.pattern(), s.model.rest_positions(), nodes);
  ASSERT_TRUE(factor.factorize(s.a));
  Eigen::VectorXd x = Eigen::VectorXd::Ones(factor.size()), work(factor.size());
  for (double& value : s.a.values) value *= 2;
  const std::size_t before = test::allocation_count();
  ASSERT_TRUE(factor.factorize(s.a));
  factor.solve(x, work);
  EXPECT_EQ(test::allocation_count(), before);
  EXPECT_LT((2 * s.dense * x - Eigen::VectorXd::Ones(x.size())).norm(), 1e-11 * std::sqrt(x.size()));
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
