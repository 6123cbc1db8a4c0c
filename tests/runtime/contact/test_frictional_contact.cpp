// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <random>

#include "tests/support/frictional_contact.hpp"

namespace souple {
namespace {

using namespace test;

using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

struct Problem {
  Matrix w;
  Eigen::VectorXd q, mu, r, u;

  FrictionalContactProblem view() const {
    return {std::size_t(mu.size()),
            {w.data(), std::size_t(w.size())},
            {q.data(), std::size_t(q.size())},
            {mu.data(), std::size_t(mu.size())}};
  }
  ContactSolveReport solve(const ContactSolverSettings& settings = {1e-12, 100000}) {
    r.setZero(q.size());
    u.setZero(q.size());
    return resume(settings);
  }
  ContactSolveReport resume(const ContactSolverSettings& settings) {
    return solve_frictional_contact(view(), settings, {r.data(), std::size_t(r.size())},
                                    {u.data(), std::size_t(u.size())});
  }
  double residual() const { return natural_map_residual(view(), {r.data(), std::size_t(r.size())}); }
};

Problem single(double w, const Eigen::Vector3d& q, double mu) {
  Problem p;
  p.w = w * Matrix::Identity(3, 3);
  p.q = q;
  p.mu = Eigen::VectorXd::Constant(1, mu);
  return p;
}

Problem random_problem(std::mt19937& random, int contacts, int rank, double mu) {
  std::normal_distribution<double> normal;
  const int size = 3 * contacts;
  Eigen::MatrixXd g(size, rank);
  for (Eigen::Index k = 0; k < g.size(); ++k) g.data()[k] = normal(random);
  Problem p;
  p.w = g * g.transpose() / rank;
  // q = W c + interior direction of the dual cone: a solution exists (Klarbring-Pang).
  p.q.resize(size);
  for (int k = 0; k < size; ++k) p.q[k] = normal(random);
  if (rank < size) {
    Eigen::VectorXd c(rank);
    for (int k = 0; k < rank; ++k) c[k] = normal(random);
    p.q = g * c;
  }
  p.mu = Eigen::VectorXd::Constant(contacts, mu);
  return p;
}

void expect_laws(const Problem& p, double tolerance) {
  const Eigen::VectorXd u = p.w * p.r + p.q;
  EXPECT_LT((u - p.u).norm(), 1e-10 * (1 + p.q.norm())) << "the gap handed back is W r + q";
  const double force = p.r.norm(), gap = p.q.norm();
  for (Eigen::Index i = 0; i < p.mu.size(); ++i) {
    const double rn = p.r[3 * i], un = u[3 * i];
    const Eigen::Vector2d rt = p.r.segment<2>(3 * i + 1), ut = u.segment<2>(3 * i + 1);
    EXPECT_GE(rn, 0);
    EXPECT_GE(un, -tolerance * gap);
    EXPECT_LE(rn * un, tolerance * force * gap);
    EXPECT_LE(rt.norm(), p.mu[i] * rn * (1 + 1e-12));
    if (ut.norm() < 1e-4 * gap || rn < 1e-4 * force) continue;
    EXPECT_LE((rt + p.mu[i] * rn * ut.normalized()).norm(), 1e-2 * force) << "slip is opposed";
  }
}

TEST(FrictionalContact, SingleContactHasTheClosedForm) {  // 4.1
  Problem slide = single(2, {-4, 3, 0}, 0.5);
  EXPECT_TRUE(slide.solve().converged);
  EXPECT_LT((slide.r - Eigen::Vector3d(2, -1, 0)).norm(), 1e-12);
  EXPECT_LT((slide.u - Eigen::Vector3d(0, 1, 0)).norm(), 1e-12);
  Problem stick = single(2, {-4, 1.5, -1}, 0.5);
  stick.solve();
  EXPECT_LT((stick.r - Eigen::Vector3d(2, -0.75, 0.5)).norm(), 1e-12);
  EXPECT_LT(stick.u.norm(), 1e-12);
  Problem open = single(2, {0.5, 3, 1}, 0.5);
  open.solve();
  EXPECT_EQ(open.r.norm(), 0);
  EXPECT_LT((open.u - open.q).norm(), 1e-15);
  Problem grazing = single(2, {0, 3, 1}, 0.5);
  grazing.solve();
  EXPECT_EQ(grazing.r.norm(), 0);
}

TEST(FrictionalContact, SingleContactFollowsTheClosedFormForAnyScaleAndDirection) {  // 4.1
  std::mt19937 random(1);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (int k = 0; k < 500; ++k) {
    const double w = std::pow(10.0, 6 * uniform(random)), mu = 1 + uniform(random);
    const Eigen::Vector3d q(uniform(random), uniform(random), uniform(random));
    Problem p = single(w, q, mu);
    p.solve();
    Eigen::Vector3d expected = Eigen::Vector3d::Zero();
    if (q[0] < 0) {
      expected = -q / w;
      const double limit = -mu * q[0] / w, tangential = expected.tail<2>().norm();
      if (tangential > limit) expected.tail<2>() *= limit / tangential;
    }
    EXPECT_LT((p.r - expected).norm(), 1e-12 / w * 10);
  }
}

TEST(FrictionalContact, RandomProblemsMeetTheLaws) {
  std::mt19937 random(2);
  for (const double mu : {0.0, 0.2, 0.7, 1.5})
    for (const int contacts : {1, 2, 5, 20}) {
      Problem p = random_problem(random, contacts, 6 * contacts, mu);
      const auto report = p.solve();
      EXPECT_TRUE(report.converged) << contacts << " contacts, mu " << mu;
      EXPECT_LT(p.residual(), 1e-9);
      expect_laws(p, 1e-8);
    }
}

TEST(FrictionalContact, IllConditionedSingleBlocksDoNotDiverge) {
  // One in five of these diverges if the tangential gap is not brought up to date (METHOD 4).
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  for (int k = 0; k < 300; ++k) {
    Eigen::Matrix3d g;
    for (int i = 0; i < 9; ++i) g.data()[i] = normal(random);
    g.col(2) *= 1e-2;
    Problem p = single(1, {-1, normal(random), normal(random)}, 0.5);
    p.w = g * g.transpose();
    // A condition number of 1e4 and more makes the sweeps slow, so the last digits are not asked for.
    p.solve({1e-12, 20000});
    EXPECT_LT(p.residual(), 1e-4);
  }
}

TEST(FrictionalContact, HyperstaticProblemsMeetTheLawsThoughForcesAreNotUnique) {
  std::mt19937 random(4);
  for (int k = 0; k < 10; ++k) {
    Problem p = random_problem(random, 12, 18, 0.5);
    p.solve({1e-10, 100000});
    EXPECT_LT(p.residual(), 1e-6);
    expect_laws(p, 1e-6);
  }
}

TEST(FrictionalContact, WarmStartFromTheSolutionEndsAfterOneSweep) {
  std::mt19937 random(5);
  Problem p = random_problem(random, 20, 120, 0.4);
  p.solve();
  const Eigen::VectorXd solution = p.r;
  EXPECT_LE(p.resume({1e-9, 100}).sweeps, 1);
  EXPECT_LT((p.r - solution).norm(), 1e-8 * solution.norm());
}

TEST(FrictionalContact, ForcesScaleWithTheGapAndInverselyWithTheCompliance) {
  std::mt19937 random(6);
  Problem p = random_problem(random, 10, 60, 0.4);
  p.solve();
  Problem scaled = p;
  scaled.w *= 1e-5;
  scaled.q *= 1e-3;
  scaled.solve();
  EXPECT_LT((scaled.r - 1e2 * p.r).norm(), 1e-8 * scaled.r.norm());
}

TEST(FrictionalContact, SweepsAreCapped) {
  std::mt19937 random(7);
  Problem p = random_problem(random, 20, 61, 0.4);
  const auto report = p.solve({0, 7});
  EXPECT_EQ(report.sweeps, 7);
}

TEST(NaturalMapResidual, VanishesOnlyAtASolution) {
  Problem p = single(2, {-4, 3, 0}, 0.5);
  p.r = Eigen::Vector3d(2, -1, 0);
  EXPECT_LT(p.residual(), 1e-15);
  for (const Eigen::Vector3d& wrong :
       {Eigen::Vector3d(2, 1, 0), Eigen::Vector3d(2.1, -1, 0), Eigen::Vector3d(2, -0.9, 0),
        Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(2, -1, 0.1)}) {
    p.r = wrong;
    EXPECT_GT(p.residual(), 1e-2);
  }
}

TEST(ConeViolation, IsZeroOnTheConeAndRelativeOutside) {
  const std::vector<double> mu{0.5, 0.5};
  EXPECT_EQ(cone_violation(mu, std::vector<double>{2, 1, 0, 1, 0, 0}), 0);
  EXPECT_NEAR(cone_violation(mu, std::vector<double>{3, 4, 0, 1, 0, 0}), 2.5 / 5, 1e-15);
  EXPECT_NEAR(cone_violation(mu, std::vector<double>{2, 0, 0, -1, 0, 0}), 0.5, 1e-15);
  EXPECT_EQ(cone_violation(mu, std::vector<double>(6, 0.0)), 0);
}

}  // namespace
}  // namespace souple
