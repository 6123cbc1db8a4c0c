// SPDX-License-Identifier: MIT
#include "runtime/fem/half_factor.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>
#include <set>

#include "runtime/fem/corotational_model.hpp"
#include "runtime/fem/half_products.hpp"
#include "runtime/fem/nested_dissection.hpp"
#include "runtime/fem/sparse_factor.hpp"
#include "tests/support/allocation_count.hpp"
#include "tests/support/box_mesh.hpp"

namespace souple {
namespace {

struct Fixture {
  TetMesh mesh = test::irregular_box_mesh({9, 8, 7}, {0, 0, 0}, {0.2, 0.18, 0.15}, 1);
  CorotationalModel model =
      std::move(CorotationalModel::create(mesh, test::material_of(1e4, 0.4, 1000))).value();
  BlockMatrix a{model.pattern()};
  std::vector<Index> inner;

  explicit Fixture(double mass_factor) {
    model.assemble_rest(mass_factor, 1, a);
    const double box[] = {0.2, 0.18, 0.15};
    for (Index n = 0; n < model.node_count(); ++n) {
      bool inside = true;
      for (std::size_t k = 0; k < 3; ++k)
        inside &= mesh.nodes[std::size_t(n)][k] > 1e-9 && mesh.nodes[std::size_t(n)][k] < box[k] - 1e-9;
      if (inside) inner.push_back(n);
    }
  }
};

TEST(NestedDissection, HoldsEveryNodeOnceAndCouplesPiecesToAncestorsOnly) {
  const Fixture f(0);
  for (const Index leaf : {1, 8, 1000}) {
    const auto tree = nested_dissection(f.model.pattern(), f.mesh.nodes, f.inner, leaf);
    std::vector<Index> sorted = tree.order;
    std::ranges::sort(sorted);
    ASSERT_EQ(sorted, f.inner);
    std::vector<Index> piece_of(std::size_t(f.model.node_count()), -1);
    for (Index p = 0; p < tree.piece_count(); ++p) {
      ASSERT_TRUE(tree.parent[std::size_t(p)] == -1 || tree.parent[std::size_t(p)] > p);
      for (Index k = tree.begin[std::size_t(p)]; k < tree.begin[std::size_t(p) + 1]; ++k)
        piece_of[std::size_t(tree.order[std::size_t(k)])] = p;
    }
    const auto& pattern = f.model.pattern();
    for (const Index node : f.inner)
      for (Index b = pattern.row_begin[std::size_t(node)]; b < pattern.row_begin[std::size_t(node) + 1];
           ++b) {
        const Index q = piece_of[std::size_t(pattern.column[std::size_t(b)])];
        Index p = piece_of[std::size_t(node)];
        if (q < p) continue;
        while (p >= 0 && p != q) p = tree.parent[std::size_t(p)];
        ASSERT_EQ(p, q) << "a piece couples to one that is no ancestor";
      }
  }
}

TEST(NestedDissection, TakesPartsThatDoNotCoupleAndNodesOnOnePoint) {
  BlockPattern pattern = build_block_pattern(8, {{0, 1, 2, 3}, {4, 5, 6, 7}});
  const std::vector<Point> positions(8, Point{1, 1, 1});
  const std::vector<Index> nodes{0, 1, 2, 3, 4, 5, 6, 7};
  const auto tree = nested_dissection(pattern, positions, nodes, 2);
  EXPECT_EQ(std::set<Index>(tree.order.begin(), tree.order.end()).size(), 8u);
  EXPECT_EQ(nested_dissection(pattern, positions, {}, 2).piece_count(), 0);
}

TEST(HalfFactor, SolvesToAThousandthOfTheLargestEntry) {
  // Without mass only the inner nodes; with mass all of them, whose blocks are not symmetric.
  for (const double mass_factor : {0.0, 1e4, 1e8}) {
    Fixture f(mass_factor);
    if (mass_factor > 0) {
      f.inner.resize(std::size_t(f.model.node_count()));
      std::iota(f.inner.begin(), f.inner.end(), Index{0});
    }
    HalfFactor half;
    ASSERT_TRUE(half.create(f.a, f.mesh.nodes, f.inner));
    SparseFactor exact;
    exact.analyze(f.model.pattern(), f.model.rest_positions(), half.order());
    ASSERT_TRUE(exact.factorize(f.a));
    ASSERT_EQ(half.size(), std::size_t(exact.size()));
    std::mt19937 random(4);
    std::normal_distribution<double> normal;
    Eigen::VectorXd x =
        Eigen::VectorXd::NullaryExpr(exact.size(), [&](Eigen::Index) { return normal(random); });
    Eigen::VectorXf y = x.cast<float>();
    Eigen::VectorXd work(x.size());
    std::vector<float> half_work(half.work_size());
    exact.solve(x, work);
    half.solve(y.data(), half_work.data());
    EXPECT_LT((x - y.cast<double>()).cwiseAbs().maxCoeff(), 1e-3 * x.cwiseAbs().maxCoeff())
        << "mass factor " << mass_factor;
  }
}

// Half of the body a million times as stiff, its border nodes moved: the loads of stiff nodes must not
// drown those of the soft ones beside them.
TEST(HalfFactor, ExtendsAMotionIntoSoftNodesBesideStiffOnes) {
  Fixture f(0);
  Material material = test::material_of(1e4, 0.4, 1000);
  material.regions.push_back(material.regions[0]);
  material.regions[1].name = "stiff";
  material.regions[1].young_pa *= 1e6;
  for (const Tet& tet : f.mesh.tets) {
    double middle = 0;
    for (const Index node : tet) middle += f.mesh.nodes[std::size_t(node)][0] / 4;
    material.tet_region.push_back(middle < 0.1 ? 0 : 1);
  }
  const auto model = std::move(CorotationalModel::create(f.mesh, material)).value();
  BlockMatrix a(model.pattern());
  model.assemble_rest(0, 1, a);
  Eigen::VectorXd u(3 * Eigen::Index{model.node_count()}), load = u;
  for (Index node = 0; node < model.node_count(); ++node) {
    const Point& p = f.mesh.nodes[std::size_t(node)];
    node_entry(u, node) = Vec3(std::sin(20 * p[1]), std::cos(15 * p[2]), std::sin(25 * p[0]));
  }
  for (const Index node : f.inner) node_entry(u, node).setZero();
  multiply(a, u, load);
  HalfFactor half;
  ASSERT_TRUE(half.create(a, f.mesh.nodes, f.inner));
  SparseFactor exact;
  exact.analyze(model.pattern(), model.rest_positions(), half.order());
  ASSERT_TRUE(exact.factorize(a));
  Eigen::VectorXd x(exact.size()), work(x.size());
  for (std::size_t k = 0; k < half.order().size(); ++k)
    x.segment<3>(3 * Eigen::Index(k)) = -node_entry(load, half.order()[k]);
  Eigen::VectorXf y = x.cast<float>();
  std::vector<float> half_work(half.work_size());
  exact.solve(x, work);
  half.solve(y.data(), half_work.data());
  EXPECT_LT((x - y.cast<double>()).cwiseAbs().maxCoeff(), 5e-3 * x.cwiseAbs().maxCoeff());
}

TEST(HalfFactor, IsTheSameOnEveryRunAndAllocatesNothingToSolve) {
  const Fixture f(1e4);
  HalfFactor first, second;
  ASSERT_TRUE(first.create(f.a, f.mesh.nodes, f.inner) && second.create(f.a, f.mesh.nodes, f.inner));
  std::vector<float> x(first.size(), 1), y(second.size(), 1), work(first.work_size());
  const std::size_t before = test::allocation_count();
  first.solve(x.data(), work.data());
  EXPECT_EQ(test::allocation_count(), before);
  second.solve(y.data(), work.data());
  EXPECT_EQ(x, y);
}

TEST(HalfFactor, RefusesAMatrixThatIsNotPositiveDefinite) {
  Fixture f(0);
  f.a.block(f.model.pattern().diagonal[std::size_t(f.inner[100])]).setZero();
  HalfFactor half;
  EXPECT_FALSE(half.create(f.a, f.mesh.nodes, f.inner));
}

TEST(HalfFactor, HoldsAnEmptyPart) {
  const Fixture f(0);
  HalfFactor half;
  ASSERT_TRUE(half.create(f.a, f.mesh.nodes, {}));
  EXPECT_EQ(half.size(), 0u);
  half.solve(nullptr, nullptr);
}

TEST(HalfProducts, AgreeWithPlainLoopsAndClampWhatIsTooLarge) {
  std::vector<float> values(16 * 6);
  for (std::size_t k = 0; k < values.size(); ++k) values[k] = std::sin(float(k)) / 3;
  PackedValues halves;
  append_halves(values, halves);
  const std::vector<float> x{1, -2, 3, 0.5F, 0.25F, -1};
  std::vector<float> y(16, 1), expected(16, 1), v(16), z(6, 2), expected_z(6, 2);
  for (std::size_t k = 0; k < 16; ++k) v[k] = float(k) - 7;
  for (std::size_t j = 0; j < 6; ++j)
    for (std::size_t i = 0; i < 16; ++i) {
      expected[i] += values[16 * j + i] * x[j];
      expected_z[j] -= values[16 * j + i] * v[i];
    }
  add_product(halves.data(), 16, 6, x.data(), y.data());
  subtract_transposed_product(halves.data(), 16, 6, v.data(), z.data());
  for (std::size_t i = 0; i < 16; ++i) EXPECT_NEAR(y[i], expected[i], 2e-3);
  for (std::size_t j = 0; j < 6; ++j) EXPECT_NEAR(z[j], expected_z[j], 1e-2);
  PackedValues large;
  append_halves(std::vector<float>{1e30F, -1e30F}, large);
  EXPECT_EQ(large, (PackedValues{0x7bff, 0xfbff})) << "the largest halves, not infinity";
}

}  // namespace
}  // namespace souple
