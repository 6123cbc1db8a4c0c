// SPDX-License-Identifier: MIT
#include "runtime/contact/contact_judgement.hpp"

#include <algorithm>
#include <cmath>

#include "runtime/contact/local_law.hpp"

namespace souple {

std::vector<double> gap_of(const ContactProblem& problem, std::span<const double> force) {
  std::vector<double> gap = problem.q;
  const BlockColumns& w = problem.w;
  for (std::size_t j = 0; j < w.size(); ++j)
    for (std::size_t b = w.begin[j]; b < w.begin[j + 1]; ++b)
      for (std::size_t k = 0; k < 9; ++k)
        gap[3 * w.row[b] + k % 3] += w.value[9 * b + k] * force[3 * j + k / 3];
  return gap;
}

ContactJudgement judge_contacts(const ContactProblem& problem, std::span<const double> force) {
  constexpr double nothing = 1e-12, border = 1 - 1e-6;  // of the largest r_n, of mu r_n
  const std::vector<double> gap = gap_of(problem, force);
  ContactJudgement result;
  double largest = 0, residual2 = 0, free2 = 0;
  for (std::size_t i = 0; i < problem.mu.size(); ++i) largest = std::max(largest, force[3 * i]);
  for (const double value : problem.q) free2 += value * value;
  for (std::size_t i = 0; i < problem.mu.size(); ++i) {
    const double mu = problem.mu[i];
    const Eigen::Map<const Vec3> r(&force[3 * i]);
    const Eigen::Map<const Vec3> u(&gap[3 * i]);
    const double tangential = r.tail<2>().norm();
    Vec3 step = u;
    step[0] += mu * u.tail<2>().norm();
    residual2 += (r - project_onto_cone(r - step, mu)).squaredNorm();
    result.penetration = std::max(result.penetration, -u[0]);
    result.cone_violation = std::max({result.cone_violation, tangential - mu * r[0], -r[0]});
    const bool open = r[0] <= nothing * largest;
    ++(open ? result.open : tangential >= border * mu * r[0] ? result.slip : result.stick);
  }
  result.residual = free2 > 0 ? std::sqrt(residual2 / free2) : std::sqrt(residual2);
  return result;
}

}  // namespace souple
