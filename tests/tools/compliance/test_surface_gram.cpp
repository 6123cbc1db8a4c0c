// SPDX-License-Identifier: GPL-3.0-or-later
// The Gram form of the compliance, against one solve per column with the same factor, and the factor
// against the matrix.
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <atomic>
#include <cmath>
#include <cstring>
#include <numeric>
#include <stdexcept>

#include "runtime/fem/corotational_model.hpp"
#include "tests/support/box_mesh.hpp"
#include "tools/compliance/surface_gram.hpp"
#include "tools/compliance/worker_pool.hpp"

namespace souple {
namespace {

using namespace test;

FactorOptions factor_options(std::size_t memory_limit_bytes, unsigned threads) {
  FactorOptions options;
  options.memory_limit_bytes = memory_limit_bytes;
  options.threads = threads;
  return options;
}

/// A body with its matrix: enough surface scalars for several tiles, and a tree with branches.
struct Body {
  TetMesh mesh;
  CorotationalModel model;
  BlockMatrix a0;
  std::vector<Index> free, surface, chosen;

  Body(const std::array<int, 3>& cells, double young_pa, double poisson, double mass_factor)
      : mesh(irregular_box_mesh(cells, {0, 0, 0}, {0.12, 0.1, 0.11}, 0.4)),
        model(std::move(*CorotationalModel::create(mesh, material_of(young_pa, poisson, 1000)))),
        a0(model.pattern()) {
    model.assemble_rest(mass_factor, 1.5, a0);
    for (Index n = 0; n < Index(mesh.nodes.size()); ++n)
      if (mass_factor > 0 || mesh.nodes[std::size_t(n)][0] > 1e-9) free.push_back(n);
    for (const Index n : used_nodes(boundary_triangles(mesh.tets))) {
      const auto place = std::ranges::lower_bound(free, n);
      if (place == free.end() || *place != n) continue;
      surface.push_back(n);
      chosen.push_back(Index(place - free.begin()));
    }
  }
  SupernodalFactor factor(unsigned threads = 2) const {
    auto made = SupernodalFactor::create(a0, free, factor_options(std::size_t{4} << 30, threads));
    EXPECT_TRUE(made.ok());
    return std::move(*made);
  }
};

const Body& dynamic_body() {
  static const Body body({10, 9, 8}, 1e4, 0.4, 1e4);
  return body;
}

Eigen::MatrixXd column_by_column(const SupernodalFactor& factor, const std::vector<Index>& chosen) {
  const auto size = 3 * Eigen::Index(chosen.size());
  Eigen::MatrixXd c(size, size);
  SupernodalFactor::Workspace workspace(factor, 1);
  for (Eigen::Index column = 0; column < size; ++column) {
    std::ranges::fill(workspace.right_sides(), 0.0);
    workspace.right_sides()[std::size_t(3 * chosen[std::size_t(column / 3)] + column % 3)] = 1;
    const auto u = factor.solve(workspace, 1);
    for (Eigen::Index row = 0; row < size; ++row)
      c(row, column) = u[std::size_t(3 * chosen[std::size_t(row / 3)] + row % 3)];
  }
  return c;
}

std::vector<Index> all_rows(const SymmetricSource& source) {
  std::vector<Index> rows(std::size_t(source.node_count()));
  std::iota(rows.begin(), rows.end(), 0);
  return rows;
}

template <class Matrix>
Matrix whole(const SymmetricSource& source) {
  Matrix c(3 * source.node_count(), 3 * source.node_count());
  const auto rows = all_rows(source);
  source.read(rows, rows, c);
  return c;
}

template <class Scalar>
std::unique_ptr<SurfaceGram<Scalar>> gram_of(const SupernodalFactor& factor,
                                             std::span<const Index> chosen, unsigned threads = 2) {
  GramOptions options;
  options.threads = threads;
  auto made = SurfaceGram<Scalar>::create(factor, chosen, options);
  EXPECT_TRUE(made.ok());
  return std::move(*made);
}

template <class Matrix>
bool same_bits(const Matrix& a, const Matrix& b) {
  return a.size() == b.size() &&
         std::memcmp(a.data(), b.data(), std::size_t(a.size()) * sizeof(*a.data())) == 0;
}

TEST(SupernodalFactor, SolvesTheSystem) {
  const Body& body = dynamic_body();
  const SupernodalFactor factor = body.factor();
  SupernodalFactor::Workspace workspace(factor, 1);
  const auto size = Eigen::Index(factor.size());
  Eigen::VectorXd f(size), product(size);
  for (Eigen::Index k = 0; k < size; ++k) f[k] = std::sin(double(k));
  std::ranges::copy(f, workspace.right_sides().begin());
  const auto u = factor.solve(workspace, 1);
  multiply(body.a0, Eigen::Map<const Eigen::VectorXd>(u.data(), size), product);
  EXPECT_LT((product - f).norm() / f.norm(), 1e-12);
}

TEST(SupernodalFactor, KeepsTheThreeScalarsOfANodeTogetherInPostorder) {
  const SupernodalFactor factor = dynamic_body().factor();
  const SupernodeView view = factor.view();
  std::vector<std::int64_t> places(view.position_of_node.begin(), view.position_of_node.end());
  std::ranges::sort(places);
  for (std::size_t k = 0; k < places.size(); ++k) EXPECT_EQ(places[k], 3 * std::int64_t(k));
  std::size_t branches = 0;
  for (std::size_t s = 0; s + 1 < view.count(); ++s) {
    ASSERT_FALSE(view.below(s).empty()) << "one body is one tree";
    branches += view.below(s)[0] >= view.first_column[s + 2];
    EXPECT_TRUE(std::ranges::is_sorted(view.below(s)));
  }
  EXPECT_GT(branches, 0U);
}

TEST(SupernodalFactor, RefusesIndefiniteMatricesTooLittleMemoryAndStops) {
  const Body& body = dynamic_body();
  BlockMatrix negative(body.model.pattern());
  body.model.assemble_rest(-1e4, 1.5, negative);
  const auto indefinite = SupernodalFactor::create(negative, body.free);
  ASSERT_FALSE(indefinite.ok());
  EXPECT_EQ(indefinite.issue().code, IssueCode::compliance_factorisation_failed);
  const auto small = SupernodalFactor::create(body.a0, body.free, factor_options(1000000, 2));
  ASSERT_FALSE(small.ok());
  EXPECT_EQ(small.issue().code, IssueCode::compliance_out_of_memory);
  int asked = 0;
  FactorOptions options;
  options.cancelled = [&] { return ++asked > 3; };
  const auto stopped = SupernodalFactor::create(body.a0, body.free, options);
  ASSERT_FALSE(stopped.ok());
  EXPECT_EQ(stopped.issue().code, IssueCode::interrupted);
  EXPECT_EQ(asked, 4) << "nothing more is asked, so nothing more is done";
}

TEST(SurfaceGram, EqualsOneSolvePerColumn) {
  const Body still({9, 9, 8}, 1e4, 0.4, 0);
  for (const Body* body : {&dynamic_body(), &still}) {
    const SupernodalFactor factor = body->factor();
    const Eigen::MatrixXd expected = column_by_column(factor, body->chosen);
    EXPECT_GT(expected.rows(), 768) << "several tiles";
    const auto twice = whole<Eigen::MatrixXd>(*gram_of<double>(factor, body->chosen));
    const auto once = whole<Eigen::MatrixXd>(*gram_of<float>(factor, body->chosen));
    EXPECT_LT((twice - expected).norm() / expected.norm(), 1e-12);
    EXPECT_LT((once - expected).norm() / expected.norm(), 1e-5);
    const auto worst = [&](const Eigen::MatrixXd& c) {
      return ((c - expected).colwise().norm().array() / expected.colwise().norm().array()).maxCoeff();
    };
    EXPECT_LT(worst(twice), 1e-12);
    EXPECT_LT(worst(once), 1e-5);
  }
}

TEST(SurfaceGram, BitsDoNotDependOnTheThreads) {
  const Body& body = dynamic_body();
  const SupernodalFactor factor = body.factor(1);
  const auto single = whole<Eigen::MatrixXf>(*gram_of<float>(factor, body.chosen, 1));
  const auto twice = whole<Eigen::MatrixXd>(*gram_of<double>(factor, body.chosen, 1));
  for (const unsigned threads : {2U, 3U}) {
    const SupernodalFactor other = body.factor(threads);
    const SupernodeView a = factor.view(), b = other.view();
    for (std::size_t s = 0; s < a.count(); ++s)
      for (std::int64_t j = 0; j < a.columns(s); ++j) {
        const auto begin = std::size_t(a.value_begin[s] + j * a.rows(s) + j);
        ASSERT_EQ(std::memcmp(&a.value[begin], &b.value[begin], std::size_t(a.rows(s) - j) * 8), 0);
      }
    EXPECT_TRUE(
        same_bits(whole<Eigen::MatrixXf>(*gram_of<float>(other, body.chosen, threads)), single));
    EXPECT_TRUE(
        same_bits(whole<Eigen::MatrixXd>(*gram_of<double>(other, body.chosen, threads)), twice));
  }
}

TEST(SurfaceGram, IsSymmetricToTheBitAndMultipliesAsItReads) {
  const Body& body = dynamic_body();
  const SupernodalFactor factor = body.factor();
  const auto gram = gram_of<float>(factor, body.chosen);
  const auto c = whole<Eigen::MatrixXd>(*gram);
  EXPECT_EQ((c - c.transpose()).norm(), 0);
  EXPECT_GT(c.selfadjointView<Eigen::Lower>().eigenvalues().minCoeff(), 0);
  Eigen::MatrixXd x(c.rows(), 2), y(c.rows(), 2), exact(c.rows(), 2);
  for (Eigen::Index k = 0; k < x.size(); ++k) x.data()[k] = std::cos(double(k));
  gram->multiply(x, y, 2);
  EXPECT_LT((y - c * x).norm() / y.norm(), 1e-14);
  FactorOperator(factor, body.chosen).apply(x, exact);
  EXPECT_LT((y - exact).norm() / exact.norm(), 1e-5);
  const std::vector<Index> rows{7, 200, 3}, columns{200, 7};
  Eigen::MatrixXf part(9, 6);
  gram->read(rows, columns, part);
  for (Eigen::Index i = 0; i < 9; ++i)
    for (Eigen::Index j = 0; j < 6; ++j)
      EXPECT_EQ(part(i, j), float(c(3 * rows[std::size_t(i / 3)] + i % 3,
                                    3 * columns[std::size_t(j / 3)] + j % 3)));
}

TEST(SurfaceGram, OfSomeNodesIsTheirPartOfTheWhole) {
  const Body& body = dynamic_body();
  const SupernodalFactor factor = body.factor();
  const auto all = whole<Eigen::MatrixXd>(*gram_of<double>(factor, body.chosen));
  std::vector<Index> some;
  std::vector<Eigen::Index> rows;
  for (std::size_t k = 0; k < body.chosen.size(); k += 7) {
    some.push_back(body.chosen[k]);
    for (Eigen::Index c = 0; c < 3; ++c) rows.push_back(3 * Eigen::Index(k) + c);
  }
  const auto part = whole<Eigen::MatrixXd>(*gram_of<double>(factor, some));
  EXPECT_LT((part - all(rows, rows)).norm() / part.norm(), 1e-13);
  const Index one[] = {body.chosen[5]};
  const Mat3 of_one = whole<Eigen::MatrixXd>(*gram_of<double>(factor, one)),
             in_all = all.block(15, 15, 3, 3);
  EXPECT_LT((of_one - in_all).norm(), 1e-13 * in_all.norm());
}

TEST(SurfaceGram, SinglePrecisionStandsTinyHugeSoftAndHardBodies) {
  for (const double young_pa : {1e-3, 1e11})
    for (const double mass_factor : {1e-2, 1e14}) {
      const Body body({8, 7, 7}, young_pa, 0.3, mass_factor);
      const SupernodalFactor factor = body.factor();
      const auto exact = whole<Eigen::MatrixXd>(*gram_of<double>(factor, body.chosen));
      const auto once = whole<Eigen::MatrixXd>(*gram_of<float>(factor, body.chosen));
      EXPECT_LT((once - exact).norm() / exact.norm(), 1e-5) << young_pa << " " << mass_factor;
    }
}

TEST(SurfaceGram, SaysItsMemoryBeforeAndStopsWhenAsked) {
  const Body& body = dynamic_body();
  const SupernodalFactor factor = body.factor();
  const auto report = gram_of<double>(factor, body.chosen)->report();
  GramOptions options;
  options.memory_limit_bytes = report.planned_bytes - 1;
  const auto small = SurfaceGram<double>::create(factor, body.chosen, options);
  ASSERT_FALSE(small.ok());
  EXPECT_EQ(small.issue().code, IssueCode::compliance_out_of_memory);
  options.memory_limit_bytes = report.planned_bytes;
  EXPECT_TRUE(SurfaceGram<double>::create(factor, body.chosen, options).ok());
  double last = 0;
  options.progress = [&](double fraction) {
    EXPECT_GE(fraction, last);
    EXPECT_LE(fraction, 1);
    last = fraction;
  };
  EXPECT_TRUE(SurfaceGram<double>::create(factor, body.chosen, options).ok());
  EXPECT_NEAR(last, 1, 1e-9);
  options.cancelled = [&] { return true; };
  const auto stopped = SurfaceGram<double>::create(factor, body.chosen, options);
  ASSERT_FALSE(stopped.ok());
  EXPECT_EQ(stopped.issue().code, IssueCode::interrupted);
}

TEST(WorkerPool, DoesEveryItemOnceAndPassesOnWhatIsThrown) {
  for (const unsigned threads : {0U, 1U, 2U, 5U}) {
    WorkerPool pool(threads);
    for (const std::size_t count : {0U, 1U, 2U, 1000U}) {
      std::vector<std::atomic<int>> done(count);
      pool.run(count, [&](std::size_t item, unsigned worker) {
        EXPECT_LT(worker, pool.threads());
        ++done[item];
      });
      for (const auto& times : done) EXPECT_EQ(times, 1);
    }
    const auto fails = [](std::size_t item, unsigned) {
      if (item == 7) throw std::runtime_error("seven");
    };
    EXPECT_THROW(pool.run(50, fails), std::runtime_error);
    std::atomic<int> after{0};
    pool.run(10, [&](std::size_t, unsigned) { ++after; });
    EXPECT_EQ(after, 10);
  }
}

}  // namespace
}  // namespace souple
