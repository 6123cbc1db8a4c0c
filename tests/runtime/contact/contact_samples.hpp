// SPDX-License-Identifier: MIT
// Dense contact problems for tests, and ways to solve them that share no code with the solvers.
#pragma once
#include <Eigen/Dense>
#include <cmath>
#include <random>
#include <vector>

#include "formats/core/contact_problem.hpp"
#include "runtime/contact/local_law.hpp"

namespace souple::test {

struct DenseProblem {
  Eigen::MatrixXd w;
  Eigen::VectorXd q, mu;

  std::size_t count() const { return std::size_t(mu.size()); }
  std::vector<ConstraintLaw> laws() const {
    std::vector<ConstraintLaw> laws;
    for (const double m : mu) laws.push_back({ConstraintLaw::Kind::frictional, m});
    return laws;
  }
  ContactProblem sparse() const {
    ContactProblem p;
    p.w = block_columns_of_dense({w.data(), std::size_t(w.size())}, count());
    p.q.assign(q.begin(), q.end());
    p.mu.assign(mu.begin(), mu.end());
    return p;
  }
};

/// W = G G^T / rank; a solution exists, as q is reached by forces or W is regular.
inline DenseProblem random_dense(std::mt19937& random, int contacts, int rank, double mu) {
  std::normal_distribution<double> normal;
  const Eigen::MatrixXd g =
      Eigen::MatrixXd::NullaryExpr(3 * contacts, rank, [&] { return normal(random); });
  DenseProblem p;
  p.w = g * g.transpose() / rank;
  p.q = rank < 3 * contacts
            ? Eigen::VectorXd(g * Eigen::VectorXd::NullaryExpr(rank, [&] { return normal(random); }))
            : Eigen::VectorXd::NullaryExpr(3 * contacts, [&] { return normal(random); });
  p.mu = Eigen::VectorXd::Constant(contacts, mu);
  return p;
}

/// Worst breach of the laws, stated one by one: gaps relative to ||q||, forces to ||r||.
inline double worst_breach(const DenseProblem& p, const Eigen::VectorXd& r) {
  const Eigen::VectorXd u = p.w * r + p.q;
  const double gap = p.q.norm(), force = std::max(r.norm(), 1e-300);
  double worst = 0;
  for (Eigen::Index i = 0; i < p.mu.size(); ++i) {
    const double un = u[3 * i] / gap, rn = r[3 * i] / force;
    const Eigen::Vector2d ut = u.segment<2>(3 * i + 1) / gap, rt = r.segment<2>(3 * i + 1) / force;
    worst = std::max({worst, -un, -rn, rn * un, rt.norm() - p.mu[i] * rn});
    // Maximal dissipation: mu r_n |u_t| + r_t . u_t = 0.
    worst = std::max(worst, std::abs(p.mu[i] * rn * ut.norm() + rt.dot(ut)));
  }
  return worst;
}

/// De Saxce's fixed point with a step so small that it cannot fail, many times. Slow.
inline Eigen::VectorXd slow_solution(const DenseProblem& p, int steps) {
  const double rho = 0.5 / p.w.operatorNorm();
  Eigen::VectorXd r = Eigen::VectorXd::Zero(p.q.size());
  for (int k = 0; k < steps; ++k) {
    Eigen::VectorXd y = r - rho * (p.w * r + p.q);
    for (Eigen::Index i = 0; i < p.mu.size(); ++i) {
      const Eigen::Vector2d ut = p.w.middleRows<2>(3 * i + 1) * r + p.q.segment<2>(3 * i + 1);
      const double mu = p.mu[i], n = y[3 * i] - rho * mu * ut.norm();
      const Eigen::Vector2d t = y.segment<2>(3 * i + 1);
      const double length = t.norm();
      double rn = n;
      Eigen::Vector2d rt = t;
      if (mu * length <= -n) {
        rn = 0;
        rt.setZero();
      } else if (length > mu * n) {
        rn = (n + mu * length) / (1 + mu * mu);
        rt = t * (mu * rn / length);
      }
      y[3 * i] = rn;
      y.segment<2>(3 * i + 1) = rt;
    }
    r = y;
  }
  return r;
}

}  // namespace souple::test
