// SPDX-License-Identifier: MIT
// Coulomb's law on a faceted cone, for comparison with the exact one.
#pragma once
#include <span>

#include "runtime/contact/block_sparse_operator.hpp"
#include "runtime/contact/contact_gauss_seidel.hpp"

namespace souple {

/// The point of the regular polygon nearest to (t, s). Its `facets` corners lie on the circle of
/// `radius` about the origin, the first at (radius, 0).
Eigen::Vector2d project_onto_polygon(const Eigen::Vector2d& point, double radius, int facets);

/// The complementarity problem of METHOD eq. 4.20 (Anitescu and Potra 1997): the disc |r_t| <= mu r_n
/// is replaced by the polygon whose corners mu r_n d_k lie on it. With r_t = sum beta_k d_k,
/// 0 <= lambda + d_k . u_t  _|_  beta_k >= 0 and 0 <= mu r_n - sum beta_k  _|_  lambda >= 0 say that
/// r_t is the projection of r_t - rho u_t onto the polygon, and so it is solved: by projected
/// Gauss-Seidel, without the multipliers. Ends when force changes and map are within the tolerance;
/// the report's residual is that of the faceted law, of natural_map_residual's scale.
/// `facets` >= 3. Both 3m: `force` holds the start and receives the result.
ContactSolveReport solve_faceted_contact(BlockSparseOperator& op, std::span<const double> friction,
                                         int facets, const ContactSolverSettings& settings,
                                         std::span<double> force);

}  // namespace souple
