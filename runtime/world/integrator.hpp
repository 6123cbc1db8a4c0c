// SPDX-License-Identifier: MIT
// What an integrator makes of mass, damping and stiffness (METHOD 2 and 4.2).
#pragma once
#include "runtime/world/settings.hpp"

namespace souple {

/// A = mass M + stiffness K.
struct SystemFactors {
  double mass = 0;       ///< 1/s^2
  double stiffness = 1;  ///< dimensionless
};
SystemFactors system_factors(Integrator integrator, double time_step_s, double rayleigh_mass_per_s,
                             double rayleigh_stiffness_s);

/// The implicit Euler step that has the same system matrix as a BDF2 step of this length:
/// 9/(4 h^2) = 1/k^2 and 3/(2 h) = 1/k with k = 2 h / 3. So one compliance serves both.
constexpr double euler_step_of_bdf2(double time_step_s) { return 2 * time_step_s / 3; }

}  // namespace souple
