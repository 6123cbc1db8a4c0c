// SPDX-License-Identifier: MIT
#include "runtime/contact/contact_gauss_seidel.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "runtime/contact/accelerated_gauss_seidel.hpp"
#include "runtime/contact/block_sparse_operator.hpp"
#include "runtime/contact/dense_contact_operator.hpp"
#include "tests/runtime/contact/contact_samples.hpp"
#include "tests/support/allocation_count.hpp"
#include "tests/support/frictional_contact.hpp"

namespace souple {
namespace {

using namespace test;

using test::allocation_count;
using test::DenseProblem;
using test::random_dense;
using test::slow_solution;
using test::worst_breach;

static_assert(ContactOperator<BlockSparseOperator> && !RefreshableOperator<BlockSparseOperator>);
static_assert(RefreshableOperator<DenseContactOperator>);

struct Solution {
  Eigen::VectorXd r;
  ContactSolveReport report;
};

Solution solve(const DenseProblem& p, const ContactSolverSettings& settings = {1e-11, 200000}) {
  const ContactProblem sparse = p.sparse();
  BlockSparseOperator op(sparse.w, sparse.q);
  Solution s{Eigen::VectorXd::Zero(p.q.size()), {}};
  GaussSeidelWork work;
  s.report = solve_by_gauss_seidel(op, p.laws(), settings, {s.r.data(), std::size_t(s.r.size())}, work);
  return s;
}

Solution solve_in_single(const DenseProblem& p, const ContactSolverSettings& settings) {
  DenseContactOperator op;
  op.assign({p.w.data(), std::size_t(p.w.size())}, {p.q.data(), std::size_t(p.q.size())});
  Solution s{Eigen::VectorXd::Zero(p.q.size()), {}};
  GaussSeidelWork work;
  s.report = solve_by_gauss_seidel(op, p.laws(), settings, {s.r.data(), std::size_t(s.r.size())}, work);
  return s;
}

// The same contacts in another order.
DenseProblem reordered(const DenseProblem& p, const std::vector<int>& order) {
  DenseProblem other = p;
  for (std::size_t i = 0; i < order.size(); ++i) {
    other.q.segment<3>(3 * Eigen::Index(i)) = p.q.segment<3>(3 * order[i]);
    other.mu[Eigen::Index(i)] = p.mu[order[i]];
    for (std::size_t j = 0; j < order.size(); ++j)
      other.w.block<3, 3>(3 * Eigen::Index(i), 3 * Eigen::Index(j)) =
          p.w.block<3, 3>(3 * order[i], 3 * order[j]);
  }
  return other;
}

TEST(ContactGaussSeidel, AgreesWithASlowProjectionMethod) {
  std::mt19937 random(11);
  for (const double mu : {0.0, 0.3, 1.0}) {
    const DenseProblem p = random_dense(random, 3, 30, mu);
    const Solution s = solve(p);
    EXPECT_TRUE(s.report.converged);
    const Eigen::VectorXd slow = slow_solution(p, 200000);
    EXPECT_LT((p.w * (s.r - slow)).norm(), 1e-7 * p.q.norm()) << "mu " << mu;
  }
}

// Contacts at rest in one problem with an impact that shares nothing with them but the norm of the
// forces.
DenseProblem beside_an_impact(const DenseProblem& rest, double blow) {
  const Eigen::Index size = rest.q.size();
  DenseProblem p = rest;
  p.w = Eigen::MatrixXd::Identity(size + 3, size + 3);
  p.w.topLeftCorner(size, size) = rest.w;
  p.q.conservativeResize(size + 3);
  p.q.tail<3>() = Vec3(-blow, 0, 0);
  p.mu.conservativeResize(p.mu.size() + 1);
  p.mu.tail<1>().setZero();
  return p;
}

double deepest(const DenseProblem& p, const Eigen::VectorXd& r) {
  const Eigen::VectorXd u = p.w * r + p.q;
  double depth = 0;
  for (Eigen::Index i = 0; i < u.size(); i += 3) depth = std::max(depth, -u[i]);
  return depth;
}

TEST(ContactGaussSeidel, GoesOnUntilNoContactIsDeeperThanAsked) {
  std::mt19937 random(17);
  const DenseProblem rest = random_dense(random, 20, 62, 0.3);
  const DenseProblem p = beside_an_impact(rest, 1e6 * rest.q.norm());
  const double asked = 1e-6 * rest.q.norm();
  const Solution rough = solve(p, {1e-4, 200000});
  EXPECT_TRUE(rough.report.converged);
  EXPECT_GT(deepest(p, rough.r), 100 * asked) << "or there is nothing to ask for";
  const Solution asked_for = solve(p, {1e-4, 200000, asked});
  EXPECT_TRUE(asked_for.report.converged);
  EXPECT_LT(deepest(p, asked_for.r), 2 * asked);
  EXPECT_GT(asked_for.report.sweeps, rough.report.sweeps);
}

TEST(ContactGaussSeidel, MeetsTheLawsForFrictionFromNoneToTwo) {
  std::mt19937 random(12);
  for (const double mu : {0.0, 0.1, 0.5, 1.0, 1.5, 2.0}) {
    const DenseProblem p = random_dense(random, 30, 200, mu);
    const Solution s = solve(p);
    EXPECT_TRUE(s.report.converged) << mu;
    EXPECT_LT(worst_breach(p, s.r), 1e-9) << mu;
  }
}

TEST(ContactGaussSeidel, GapsDoNotDependOnTheOrderOfContacts) {
  std::mt19937 random(13);
  for (const int rank : {300, 45}) {  // regular, and singular: forces are not unique, gaps are
    const DenseProblem p = random_dense(random, 30, rank, 0.0);
    std::vector<int> order(30);
    std::iota(order.begin(), order.end(), 0);
    std::ranges::shuffle(order, random);
    const DenseProblem other = reordered(p, order);
    const Solution s = solve(p), t = solve(other);
    const Eigen::VectorXd u = p.w * s.r + p.q, v = other.w * t.r + other.q;
    for (std::size_t i = 0; i < order.size(); ++i)
      EXPECT_LT((v.segment<3>(3 * Eigen::Index(i)) - u.segment<3>(3 * order[i])).norm(),
                1e-7 * p.q.norm());
  }
}

TEST(ContactGaussSeidel, ForcesDoNotDependOnTheOrderWhereFrictionDeterminesThem) {
  std::mt19937 random(14);
  const DenseProblem p = random_dense(random, 12, 400, 0.4);
  std::vector<int> order(12);
  std::iota(order.rbegin(), order.rend(), 0);
  const Solution s = solve(p), t = solve(reordered(p, order));
  for (std::size_t i = 0; i < order.size(); ++i)
    EXPECT_LT((t.r.segment<3>(3 * Eigen::Index(i)) - s.r.segment<3>(3 * order[i])).norm(),
              1e-8 * s.r.norm());
}

TEST(ContactGaussSeidel, FrictionlessObjectiveIsThatOfTheQuadraticProgram) {  // 5.6
  std::mt19937 random(15);
  for (const int rank : {60, 20}) {
    const DenseProblem p = random_dense(random, 10, rank, 0.0);
    const auto objective = [&](const Eigen::VectorXd& r) { return 0.5 * r.dot(p.w * r) + p.q.dot(r); };
    const Solution s = solve(p, {1e-13, 1000000});
    const double expected = objective(slow_solution(p, 300000));
    EXPECT_NEAR(objective(s.r), expected, 1e-8 * std::abs(expected));
  }
}

TEST(ContactGaussSeidel, UnsymmetricMatricesAreReadByColumns) {
  std::mt19937 random(16);
  std::normal_distribution<double> normal;
  DenseProblem p = random_dense(random, 8, 60, 0.3);
  p.w += 0.05 * Eigen::MatrixXd::NullaryExpr(24, 24, [&] { return normal(random); });
  const Solution s = solve(p);
  EXPECT_TRUE(s.report.converged);
  EXPECT_LT(worst_breach(p, s.r), 1e-9);
  EXPECT_LT((p.w * (s.r - slow_solution(p, 200000))).norm(), 1e-7 * p.q.norm());
  // The dense solver as well.
  std::vector<double> force(24), gap(24);
  const FrictionalContactProblem dense{
      8, {p.w.data(), 576}, {p.q.data(), 24}, {p.mu.data(), std::size_t(p.mu.size())}};
  EXPECT_TRUE(solve_frictional_contact(dense, {1e-11, 100000}, force, gap).converged);
  EXPECT_LT(natural_map_residual(dense, force), 1e-10);
  EXPECT_LT((Eigen::Map<Eigen::VectorXd>(force.data(), 24) - s.r).norm(), 1e-8 * s.r.norm());
}

TEST(ContactGaussSeidel, FiveHundredCopiesOfAContactShareTheForceOfOne) {
  constexpr int copies = 500;
  DenseProblem p;
  Eigen::Matrix3d block;
  block << 2, 0.3, -0.1, 0.3, 1.5, 0.2, -0.1, 0.2, 1;
  p.w = block.replicate<copies, copies>();
  p.q = Eigen::Vector3d(-1, 0.6, 0.2).replicate<copies, 1>();
  p.mu = Eigen::VectorXd::Constant(copies, 0.4);
  DenseProblem one;
  one.w = block;
  one.q = p.q.head<3>();
  one.mu = p.mu.head<1>();
  const Solution all = solve(p), single = solve(one);
  EXPECT_TRUE(all.report.converged);
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (int i = 0; i < copies; ++i) sum += all.r.segment<3>(3 * i);
  EXPECT_LT((sum - single.r).norm(), 1e-8 * single.r.norm());
  EXPECT_LT(worst_breach(p, all.r), 1e-9);
}

// A pile of boxes that touch in one point each: contact i is between bodies i and i + 1, body 0 fixed.
DenseProblem pile(const std::vector<double>& masses, double mu) {
  const auto count = Eigen::Index(masses.size());
  DenseProblem p;
  p.w.setZero(3 * count, 3 * count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const double below = i > 0 ? 1 / masses[std::size_t(i - 1)] : 0, above = 1 / masses[std::size_t(i)];
    p.w.block<3, 3>(3 * i, 3 * i) = (below + above) * Eigen::Matrix3d::Identity();
    if (i > 0)
      p.w.block<3, 3>(3 * i, 3 * (i - 1)) = p.w.block<3, 3>(3 * (i - 1), 3 * i) =
          -below * Eigen::Matrix3d::Identity();
  }
  p.q.setZero(3 * count);
  p.q[0] = -1;  // all fall as one: only the lowest contact closes
  p.mu = Eigen::VectorXd::Constant(count, mu);
  return p;
}

TEST(ContactGaussSeidel, AHeavyBodyOnALightOneIsCarried) {  // mass ratio 1e4; 4.6
  const std::vector<double> masses{1, 10, 100, 1e4};
  const DenseProblem p = pile(masses, 0.5);
  const Solution s = solve(p, {1e-12, 1000000});
  EXPECT_TRUE(s.report.converged);
  double weight = 0;
  for (std::size_t i = masses.size(); i-- > 0;) {
    weight += masses[i];
    EXPECT_NEAR(s.r[3 * Eigen::Index(i)], weight, 1e-5 * weight) << i;
  }
}

TEST(ContactGaussSeidel, ContactsOfImmovableThingsBearNothing) {
  std::mt19937 random(17);
  DenseProblem p = random_dense(random, 4, 30, 0.4);
  p.w.middleRows<3>(6).setZero();
  p.w.middleCols<3>(6).setZero();
  p.q.segment<3>(6) = Eigen::Vector3d(-1, 0.5, 0.5);
  DenseProblem rest = reordered(p, {0, 1, 3, 2});
  rest.w = rest.w.topLeftCorner<9, 9>().eval();
  rest.q = rest.q.head<9>().eval();
  rest.mu = rest.mu.head<3>().eval();
  const Solution s = solve(p), without = solve(rest);
  EXPECT_TRUE(s.report.converged);
  EXPECT_EQ(s.r.segment<3>(6).norm(), 0);
  EXPECT_LT((s.r.head<6>() - without.r.head<6>()).norm(), 1e-9 * s.r.norm());
  for (const double bad : {-1.0, std::nan(""), std::numeric_limits<double>::infinity()}) {
    p.w.block<3, 3>(6, 6) = bad * Eigen::Matrix3d::Identity();
    const Solution t = solve(p);
    EXPECT_TRUE(t.r.allFinite());
    EXPECT_EQ(t.r.segment<3>(6).norm(), 0);
  }
}

TEST(ContactGaussSeidel, PinsOfAChainAreTheSolutionOfTheDenseSystem) {
  // Bodies of different masses pinned to one another, the first to the world: u = 0 in all rows.
  DenseProblem p = pile({1, 3, 0.5, 10, 2}, 0);
  std::mt19937 random(18);
  std::normal_distribution<double> normal;
  p.q = Eigen::VectorXd::NullaryExpr(15, [&] { return normal(random); });
  const ContactProblem sparse = p.sparse();
  const std::vector<ConstraintLaw> pins(5, {ConstraintLaw::Kind::bilateral, 0});
  BlockSparseOperator op(sparse.w, sparse.q);
  Eigen::VectorXd r = Eigen::VectorXd::Zero(15);
  GaussSeidelWork work;
  const auto report = solve_by_gauss_seidel(op, pins, {1e-12, 100000}, {r.data(), 15}, work);
  EXPECT_TRUE(report.converged);
  const Eigen::VectorXd expected = p.w.llt().solve(-p.q);
  EXPECT_LT((r - expected).norm(), 1e-9 * expected.norm());
}

// A chain of 60 pinned bodies, a contact at its end: plain sweeps take tens of thousands, and the
// answer of the accelerated ones has to be theirs.
TEST(ContactGaussSeidel, AccelerationSolvesLongChainsOfPinsToTheSameForces) {
  const int links = 60;
  DenseProblem p = pile(std::vector<double>(links, 1.0), 0.3);
  std::mt19937 random(23);
  std::normal_distribution<double> normal;
  p.q = Eigen::VectorXd::NullaryExpr(3 * links, [&] { return normal(random); });
  std::vector<ConstraintLaw> laws = p.laws();
  for (int i = 0; i + 1 < links; ++i) laws[std::size_t(i)].kind = ConstraintLaw::Kind::bilateral;
  const ContactProblem sparse = p.sparse();
  BlockSparseOperator op(sparse.w, sparse.q);
  Eigen::VectorXd plain = Eigen::VectorXd::Zero(3 * links), fast = plain;
  GaussSeidelWork work;
  const auto slow = solve_by_gauss_seidel(op, laws, {1e-11, 1000000}, {plain.data(), 3 * links}, work);
  ASSERT_TRUE(slow.converged);
  AcceleratedWork accelerated;
  const auto judge = [&](const BlockSparseOperator& rows, std::span<const double> force) {
    double residual2 = 0, force2 = 0;
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const Vec3 f = Eigen::Map<const Vec3>(&force[3 * i]);
      residual2 += accelerated.sweeps.laws[i].natural_map(rows.gap(i), f).squaredNorm();
      force2 += f.squaredNorm();
    }
    return std::sqrt(residual2 / std::max(force2, 1e-300));
  };
  const auto quick = solve_by_accelerated_gauss_seidel(
      op, laws, {1e-11, 100000}, {fast.data(), 3 * links}, accelerated, judge, [] { return false; });
  EXPECT_TRUE(quick.converged);
  EXPECT_LT(5 * quick.sweeps, slow.sweeps);
  EXPECT_LT((fast - plain).norm(), 1e-7 * plain.norm());
}

TEST(ContactGaussSeidel, ASingularPinHoldsWhatItCan) {
  // A pin that can be moved in two directions only.
  DenseProblem p;
  p.w = Eigen::Vector3d(2, 1, 0).asDiagonal();
  p.q = Eigen::Vector3d(1, -1, 0);
  p.mu = Eigen::VectorXd::Zero(1);
  const ContactProblem sparse = p.sparse();
  const std::vector<ConstraintLaw> pins(1, {ConstraintLaw::Kind::bilateral, 0});
  BlockSparseOperator op(sparse.w, sparse.q);
  std::vector<double> r(3);
  GaussSeidelWork work;
  EXPECT_TRUE(solve_by_gauss_seidel(op, pins, {1e-12, 100}, r, work).converged);
  EXPECT_NEAR(r[0], -0.5, 1e-12);
  EXPECT_NEAR(r[1], 1, 1e-12);
  EXPECT_EQ(r[2], 0);
}

TEST(ContactGaussSeidel, ContactsAndPinsMeetTheirLawsTogether) {
  std::mt19937 random(19);
  const DenseProblem p = random_dense(random, 6, 60, 0.5);
  std::vector<ConstraintLaw> laws = p.laws();
  laws[1].kind = laws[4].kind = ConstraintLaw::Kind::bilateral;
  const ContactProblem sparse = p.sparse();
  BlockSparseOperator op(sparse.w, sparse.q);
  Eigen::VectorXd r = Eigen::VectorXd::Zero(18);
  GaussSeidelWork work;
  EXPECT_TRUE(solve_by_gauss_seidel(op, laws, {1e-12, 100000}, {r.data(), 18}, work).converged);
  const Eigen::VectorXd u = p.w * r + p.q;
  EXPECT_LT(u.segment<3>(3).norm() + u.segment<3>(12).norm(), 1e-9 * p.q.norm());
  // What is left, with the pins eliminated, is a problem of contacts alone.
  const std::vector<int> contacts{0, 1, 2, 6, 7, 8, 9, 10, 11, 15, 16, 17}, pins{3, 4, 5, 12, 13, 14};
  const Eigen::MatrixXd inverse = p.w(pins, pins).inverse();
  DenseProblem left;
  left.w = p.w(contacts, contacts) - p.w(contacts, pins) * inverse * p.w(pins, contacts);
  left.q = p.q(contacts) - p.w(contacts, pins) * inverse * p.q(pins);
  left.mu = Eigen::VectorXd::Constant(4, 0.5);
  const Eigen::VectorXd forces = r(contacts);
  EXPECT_LT(worst_breach(left, forces), 1e-8);
}

TEST(ContactGaussSeidel, ActiveSetsMissNoContactThatClosesLate) {
  // Contact 1 is open until the force of contact 0 presses it down.
  DenseProblem p;
  p.w = Eigen::MatrixXd::Identity(6, 6);
  p.w(0, 3) = p.w(3, 0) = -0.9;
  p.q.setZero(6);
  p.q[0] = -1;
  p.q[3] = 0.5;
  p.mu = Eigen::VectorXd::Zero(2);
  const Solution s = solve(p);
  EXPECT_TRUE(s.report.converged);
  EXPECT_LT(worst_breach(p, s.r), 1e-10);
  EXPECT_GT(s.r[3], 0);
}

TEST(DenseContactOperator, ProductsAreThoseOfTheMatrix) {
  std::mt19937 random(20);
  for (const int contacts : {1, 5, 6, 33}) {
    const DenseProblem p = random_dense(random, contacts, 3 * contacts, 0.4);
    const Eigen::MatrixXd w = p.w.cast<float>().cast<double>();
    DenseContactOperator op;
    op.assign({p.w.data(), std::size_t(p.w.size())}, {p.q.data(), std::size_t(p.q.size())});
    Eigen::VectorXd f = Eigen::VectorXd::Random(3 * contacts);
    op.start({f.data(), std::size_t(f.size())});
    const Eigen::VectorXd u = w * f + p.q;
    Eigen::VectorXd g = f;
    for (int i = 0; i < contacts; ++i) {
      EXPECT_LT((op.gap(std::size_t(i)) - u.segment<3>(3 * i)).norm(), 1e-13 * u.norm());
      EXPECT_EQ(op.diagonal_block(std::size_t(i)), Mat3(w.block<3, 3>(3 * i, 3 * i)));
    }
    for (int i = 0; i < contacts; ++i) {
      const Vec3 change(0.5, -0.25, i);
      g.segment<3>(3 * i) += change;
      op.add_influence(std::size_t(i), change);
    }
    const Eigen::VectorXd v = w * g + p.q;
    for (int i = 0; i < contacts; ++i)
      EXPECT_LT((op.gap(std::size_t(i)) - v.segment<3>(3 * i)).norm(), 1e-5 * v.norm());
  }
}

TEST(DenseContactOperator, SinglePrecisionReachesTightTolerances) {
  std::mt19937 random(21);
  for (const double mu : {0.0, 0.4}) {
    DenseProblem p = random_dense(random, 60, 400, mu);
    p.w = p.w.cast<float>().cast<double>().eval();
    const Solution s = solve_in_single(p, {1e-11, 10000});
    EXPECT_TRUE(s.report.converged);
    EXPECT_LT(worst_breach(p, s.r), 1e-9);
    EXPECT_LT((s.r - solve(p).r).norm(), 1e-8 * s.r.norm());
  }
}

TEST(ContactGaussSeidel, AllocatesNothingAfterTheFirstSolve) {
  std::mt19937 random(22);
  const DenseProblem p = random_dense(random, 20, 200, 0.4);
  const std::vector<ConstraintLaw> laws = p.laws();
  const std::span<const double> w(p.w.data(), std::size_t(p.w.size())), q(p.q.data(), 60);
  DenseContactOperator op;
  GaussSeidelWork work;
  std::vector<double> force(60);
  const auto run = [&] {
    std::ranges::fill(force, 0.0);
    op.assign(w, q);
    (void)solve_by_gauss_seidel(op, laws, {1e-9, 1000}, force, work);
  };
  run();
  const auto before = allocation_count();
  run();
  EXPECT_EQ(allocation_count(), before);
}

}  // namespace
}  // namespace souple
