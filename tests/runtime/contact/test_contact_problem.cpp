// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <numbers>

#include "runtime/contact/anderson_mixer.hpp"
#include "runtime/contact/contact_judgement.hpp"
#include "runtime/contact/faceted_contact.hpp"
#include "runtime/contact/solve_contact_problem.hpp"
#include "tests/runtime/contact/contact_samples.hpp"

namespace souple {
namespace {

using test::DenseProblem;
using test::random_dense;
using test::worst_breach;

struct Solution {
  Eigen::VectorXd r;
  ContactProblemReport report;
};

Solution solve(const DenseProblem& p, const ContactProblemSettings& settings) {
  const ContactProblem sparse = p.sparse();
  Solution s{Eigen::VectorXd::Zero(p.q.size()), {}};
  s.report = solve_contact_problem(sparse, settings, {s.r.data(), std::size_t(s.r.size())});
  return s;
}

ContactProblemSettings with(ContactSolverKind solver, double tolerance, int facets = 16) {
  return {solver, tolerance, 2'000'000, facets, {}};
}

constexpr auto accelerated = ContactSolverKind::accelerated;
constexpr auto plain = ContactSolverKind::gauss_seidel;
constexpr auto faceted = ContactSolverKind::faceted;

TEST(ContactProblem, AccelerationAndPlainSweepsGiveTheSameGaps) {
  std::mt19937 random(31);
  for (const double mu : {0.0, 0.3, 0.9})
    for (const int rank : {120, 30}) {  // 30: forces are not unique
      const DenseProblem p = random_dense(random, 20, rank, mu);
      const Solution a = solve(p, with(accelerated, 1e-11)), b = solve(p, with(plain, 1e-11));
      EXPECT_TRUE(a.report.converged);
      EXPECT_TRUE(b.report.converged);
      EXPECT_LT(worst_breach(p, a.r), 1e-9);
      EXPECT_LT(worst_breach(p, b.r), 1e-9);
      // Coulomb's law determines the gaps where W is regular; without friction they always are.
      if (mu == 0 || rank == 120) {
        EXPECT_LT((p.w * (a.r - b.r)).norm(), 1e-7 * p.q.norm());
      }
    }
}

// A rigid box of mass 1 and side 1 on four corners: W from its inertia, q from one step of gravity.
DenseProblem box_on_corners(double tangential_pull) {
  Eigen::Matrix<double, 12, 6> h;
  int row = 0;
  for (const double x : {-0.5, 0.5})
    for (const double y : {-0.5, 0.5}) {
      const Eigen::Vector3d arm(x, y, -0.5), axes[3] = {{0, 0, 1}, {1, 0, 0}, {0, 1, 0}};
      for (const Eigen::Vector3d& axis : axes) {
        h.row(row).head<3>() = axis.transpose();
        h.row(row++).tail<3>() = arm.cross(axis).transpose();
      }
    }
  Eigen::VectorXd inverse_mass(6), motion(6);
  inverse_mass << 1, 1, 1, 6, 6, 6;
  motion << tangential_pull, 0, -1, 0, 0, 0;
  DenseProblem p;
  p.w = h * inverse_mass.asDiagonal() * h.transpose();
  p.q = h * motion;
  p.mu = Eigen::VectorXd::Constant(4, 0.5);
  return p;
}

TEST(ContactProblem, ABoxOnFourCornersIsCarriedThoughForcesAreNotUnique) {  // 5.1, 5.5
  const DenseProblem p = box_on_corners(0.2);
  for (const auto solver : {accelerated, plain}) {
    const Solution s = solve(p, with(solver, 1e-12));
    EXPECT_TRUE(s.report.converged);
    double normal = 0, pull = 0;
    for (int i = 0; i < 4; ++i) {
      normal += s.r[3 * i];
      pull += s.r[3 * i + 1];
    }
    EXPECT_NEAR(normal, 1, 1e-9);
    EXPECT_NEAR(pull, -0.2, 1e-9);
    EXPECT_LT((p.w * s.r + p.q).norm(), 1e-9) << "it stands";
    EXPECT_LT(worst_breach(p, s.r), 1e-10);
  }
}

TEST(ContactProblem, ABoxPulledBeyondFrictionSlides) {
  const DenseProblem p = box_on_corners(0.7);
  const Solution s = solve(p, with(accelerated, 1e-12));
  EXPECT_TRUE(s.report.converged);
  EXPECT_LT(worst_breach(p, s.r), 1e-9);
  for (int i = 0; i < 4; ++i) EXPECT_NEAR((p.w * s.r + p.q)[3 * i + 1], 0.2, 1e-9);
}

TEST(ContactProblem, AMissedToleranceIsSaidAndTheBestIsKept) {
  std::mt19937 random(32);
  const DenseProblem p = random_dense(random, 30, 50, 0.5);
  ContactProblemSettings settings = with(accelerated, 1e-12);
  settings.max_sweeps = 40;
  const Solution s = solve(p, settings);
  EXPECT_FALSE(s.report.converged);
  EXPECT_LE(s.report.sweeps, 40);
  const ContactProblem sparse = p.sparse();
  const std::vector<double> zero(p.q.size());
  EXPECT_LE(judge_contacts(sparse, {s.r.data(), std::size_t(s.r.size())}).residual,
            judge_contacts(sparse, zero).residual);
  settings.stop = [] { return true; };
  EXPECT_EQ(solve(p, settings).report.sweeps, 0);
}

TEST(ContactProblem, MatricesWithoutASolutionLeaveFiniteForces) {
  // Each contact draws the other in, more the more it is pressed: forces grow without end.
  DenseProblem p;
  p.w = Eigen::MatrixXd::Identity(6, 6);
  p.w(0, 3) = p.w(3, 0) = -1e30;
  p.q = Eigen::VectorXd::Constant(6, -1e100);
  p.mu = Eigen::VectorXd::Constant(2, 0.5);
  for (const auto solver : {accelerated, plain, faceted}) {
    const Solution s = solve(p, with(solver, 1e-8));
    EXPECT_FALSE(s.report.converged);
    EXPECT_TRUE(s.r.allFinite());
  }
}

TEST(ContactJudgement, CountsStatesAndBreachesInPlainUnits) {
  DenseProblem p;
  p.w = 2 * Eigen::MatrixXd::Identity(9, 9);
  p.q = Eigen::VectorXd::Zero(9);
  p.q.head<3>() << -4, 3, 0;      // slides, 4.1
  p.q.segment<3>(3) << -4, 1, 0;  // sticks
  p.q.tail<3>() << 1, 1, 0;       // open
  p.mu = Eigen::VectorXd::Constant(3, 0.5);
  const ContactProblem sparse = p.sparse();
  std::vector<double> r{2, -1, 0, 2, -0.5, 0, 0, 0, 0};
  const ContactJudgement good = judge_contacts(sparse, r);
  EXPECT_LT(good.residual, 1e-15);
  EXPECT_EQ(good.slip, 1U);
  EXPECT_EQ(good.stick, 1U);
  EXPECT_EQ(good.open, 1U);
  EXPECT_EQ(good.penetration, 0);
  EXPECT_LE(good.cone_violation, 1e-15);
  EXPECT_EQ(gap_of(sparse, r)[1], 1);
  r[0] = 1.5;  // too little
  const ContactJudgement bad = judge_contacts(sparse, r);
  EXPECT_NEAR(bad.penetration, 1, 1e-15);
  EXPECT_NEAR(bad.cone_violation, 0.25, 1e-15);
  EXPECT_GT(bad.residual, 1e-2);
}

TEST(FacetedContact, ThePolygonsNearestPointIsNotFartherThanAnyOther) {
  std::mt19937 random(33);
  std::uniform_real_distribution<double> uniform(-3, 3);
  for (const int facets : {3, 4, 5, 16})
    for (int k = 0; k < 200; ++k) {
      const Eigen::Vector2d point(uniform(random), uniform(random));
      const Eigen::Vector2d nearest = project_onto_polygon(point, 1.5, facets);
      const auto corner = [&](int c) {
        const double angle = 2 * std::numbers::pi * c / facets;
        return Eigen::Vector2d(1.5 * std::cos(angle), 1.5 * std::sin(angle));
      };
      // Variational inequality at the corners: necessary and sufficient for a convex polygon.
      for (int c = 0; c < facets; ++c) EXPECT_LE((point - nearest).dot(corner(c) - nearest), 1e-12);
      EXPECT_LE(nearest.norm(), 1.5 + 1e-12);
    }
}

TEST(FacetedContact, WithoutFrictionItIsTheExactLaw) {
  std::mt19937 random(34);
  const DenseProblem p = random_dense(random, 12, 100, 0);
  const Solution a = solve(p, with(faceted, 1e-12, 4)), b = solve(p, with(accelerated, 1e-12));
  EXPECT_TRUE(a.report.converged);
  EXPECT_LT((a.r - b.r).norm(), 1e-9 * b.r.norm());
}

TEST(FacetedContact, ManyFacetsConvergeToTheCone) {
  std::mt19937 random(35);
  const DenseProblem p = random_dense(random, 10, 200, 0.5);
  const Solution exact = solve(p, with(accelerated, 1e-13));
  double last = 0;
  for (const int facets : {8, 32, 128, 512}) {
    const Solution s = solve(p, with(faceted, 1e-12, facets));
    EXPECT_TRUE(s.report.converged);
    const double error = (s.r - exact.r).norm() / exact.r.norm();
    // A slip draws the force into a corner: first order.
    if (last > 0) {
      EXPECT_LT(error, 0.5 * last) << facets;
    }
    last = error;
  }
  EXPECT_LT(last, 0.02);
}

TEST(FacetedContact, ItsSolutionObeysTheComplementarityConditions) {  // METHOD eq. 4.20
  constexpr int facets = 6;
  std::mt19937 random(36);
  const DenseProblem p = random_dense(random, 8, 100, 0.6);
  const Solution s = solve(p, with(faceted, 1e-13, facets));
  const Eigen::VectorXd u = p.w * s.r + p.q;
  const double gap = p.q.norm(), force = s.r.norm();
  for (int i = 0; i < 8; ++i) {
    EXPECT_GE(u[3 * i], -1e-9 * gap);
    EXPECT_LE(std::abs(u[3 * i] * s.r[3 * i]), 1e-9 * gap * force);
    // The least d_k . u_t is -lambda; the force dissipates mu r_n lambda.
    double least = 0;
    for (int k = 0; k < facets; ++k) {
      const double angle = 2 * std::numbers::pi * k / facets;
      least = std::min(least, std::cos(angle) * u[3 * i + 1] + std::sin(angle) * u[3 * i + 2]);
    }
    const double power = s.r.segment<2>(3 * i + 1).dot(u.segment<2>(3 * i + 1));
    EXPECT_NEAR(power, 0.6 * s.r[3 * i] * least, 1e-9 * gap * force);
  }
}

TEST(AndersonMixer, SolvesALinearFixedPointInAsManyStepsAsItHasDimensions) {
  // x <- A x + b contracts slowly: 0.999.
  const Eigen::Vector4d a(0.999, 0.9, 0.5, -0.7), b(1, 2, 3, 4);
  AndersonMixer mixer;
  Eigen::Vector4d x = Eigen::Vector4d::Zero();
  for (int k = 0; k < 8; ++k) {
    Eigen::Vector4d g = a.cwiseProduct(x) + b;
    mixer.mix({x.data(), 4}, {g.data(), 4});
    x = g;
  }
  const Eigen::Vector4d expected = b.cwiseQuotient(Eigen::Vector4d::Ones() - a);
  EXPECT_LT((x - expected).norm(), 1e-6 * expected.norm());
}

}  // namespace
}  // namespace souple
