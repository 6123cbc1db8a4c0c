// SPDX-License-Identifier: MIT
// An independent judge of solved contact problems: plain sums over W, no code of the solvers but the
// projection onto the cone.
#pragma once
#include <span>
#include <vector>

#include "formats/core/contact_problem.hpp"

namespace souple {

/// W r + q.
std::vector<double> gap_of(const ContactProblem& problem, std::span<const double> force);

struct ContactJudgement {
  /// Natural map ||r - P_K(r - (u + mu |u_t| n))|| / ||q||, rho = 1; not scaled if q = 0.
  double residual = 0;
  double penetration = 0;     ///< max(-u_n, 0), in the unit of u
  double cone_violation = 0;  ///< max(|r_t| - mu r_n, -r_n, 0), in the unit of r
  std::size_t stick = 0, slip = 0, open = 0;
};

/// Open: r_n is nothing beside the largest force. Slip: r_t is at the border of the cone.
ContactJudgement judge_contacts(const ContactProblem& problem, std::span<const double> force);

}  // namespace souple
