// SPDX-License-Identifier: MIT
#include "runtime/world/integrator.hpp"

namespace souple {
namespace {

SystemFactors euler_factors(double h, double alpha, double beta) {
  return {1 / (h * h) + alpha / h, 1 + beta / h};
}

}  // namespace

SystemFactors system_factors(Integrator integrator, double h, double alpha, double beta) {
  switch (integrator) {
    case Integrator::implicit_euler:
      return euler_factors(h, alpha, beta);
    case Integrator::bdf2:
      return euler_factors(euler_step_of_bdf2(h), alpha, beta);
    case Integrator::quasi_static:
      return {0, 1};
    case Integrator::explicit_euler:
      return {1 / (h * h), 0};
  }
  return {};
}

}  // namespace souple
