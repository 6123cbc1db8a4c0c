// SPDX-License-Identifier: MIT
// A reference for small problems: the nonlinear complementarity problem of Signorini's and Coulomb's
// laws on the exact cone.
#pragma once
#include <cstddef>
#include <span>

#include "runtime/contact/contact_gauss_seidel.hpp"

namespace souple::test {

/// Find r and u = W r + q with, for every contact, 0 <= u_n, 0 <= r_n, u_n r_n = 0; |r_t| <= mu r_n;
/// and r_t = -mu r_n u_t / |u_t| where u_t != 0. Rows per contact: normal, two tangential. u is a gap
/// and a slip (m), r a force (N).
struct FrictionalContactProblem {
  std::size_t contact_count = 0;
  std::span<const double> delassus;  ///< W: column-major, 3m x 3m; mostly symmetric, semi-definite
  std::span<const double> free_gap;  ///< q: 3m
  std::span<const double> friction;  ///< mu >= 0: m
};

/// solve_by_gauss_seidel on a dense W in double precision: a reference for small problems; allocates.
/// `force` holds the start and receives the result; `gap` receives u. Both 3m.
ContactSolveReport solve_frictional_contact(const FrictionalContactProblem& problem,
                                            const ContactSolverSettings& settings,
                                            std::span<double> force, std::span<double> gap);

/// Residual of the laws: ||r - P_K(r - rho (u + mu |u_t| n))|| / ||r||, P_K the projection onto the
/// Coulomb cone, rho_i = 1 / (mean eigenvalue of W_ii). `u` is recomputed as W r + q. 0 if r is zero
/// and solves the problem; the unscaled norm if r is zero otherwise.
double natural_map_residual(const FrictionalContactProblem& problem, std::span<const double> force);

/// max over contacts of max(|r_t| - mu r_n, -r_n), relative to the largest |r|; 0 without forces.
double cone_violation(std::span<const double> friction, std::span<const double> force);

}  // namespace souple::test
