// SPDX-License-Identifier: MIT
// A sparse problem from elsewhere, solved to the residual that FCLIB's problems are compared by.
#pragma once
#include <cstdint>
#include <functional>
#include <span>

#include "formats/core/contact_problem.hpp"

namespace souple {

enum class ContactSolverKind : std::uint8_t {
  accelerated,   ///< Gauss-Seidel with Anderson's acceleration
  gauss_seidel,  ///< plain, for comparison
  faceted,       ///< the faceted cone, for comparison: its answers miss the exact laws by O(1/facets)
};

struct ContactProblemSettings {
  ContactSolverKind solver = ContactSolverKind::accelerated;
  double tolerance = 1e-8;  ///< natural map, rho = 1, over ||q||; faceted: of its own law
  std::int64_t max_sweeps = 1'000'000;
  int facets = 16;             ///< of the faceted cone, 3 to 4096
  std::function<bool()> stop;  ///< asked now and then; empty: never
};

struct ContactProblemReport {
  std::int64_t sweeps = 0;
  bool converged = false;
};

/// `force` (3m) holds the start and receives the best that was found, which is finite whatever W is.
/// The problem has passed check_contact_problem.
ContactProblemReport solve_contact_problem(const ContactProblem& problem,
                                           const ContactProblemSettings& settings,
                                           std::span<double> force);

}  // namespace souple
