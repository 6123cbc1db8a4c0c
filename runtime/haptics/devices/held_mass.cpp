// SPDX-License-Identifier: MIT
#include "runtime/haptics/devices/held_mass.hpp"

#include <cmath>
#include <string>

namespace souple {
namespace {

// Taylor series of the exponential on a 2^-n part of the matrix, squared n times: the part's norm is
// below 1/2, and 18 terms are below rounding.
Mat3 exponential(const Mat3& matrix) {
  const double norm = matrix.cwiseAbs().rowwise().sum().maxCoeff();
  const int halvings = norm > 0.5 ? int(std::ceil(std::log2(norm / 0.5))) : 0;
  const Mat3 part = matrix * std::ldexp(1.0, -halvings);
  Mat3 term = Mat3::Identity(), sum = Mat3::Identity();
  for (int k = 1; k <= 18; ++k) {
    term = term * part / k;
    sum += term;
  }
  for (int k = 0; k < halvings; ++k) sum = (sum * sum).eval();
  return sum;
}

}  // namespace

Result<HeldMassStep> HeldMassStep::create(const HeldMass& p, double tick_s) {
  constexpr double largest = 1e9;
  const auto in = [&](double value, double least) { return value >= least && value <= largest; };
  if (!in(p.mass, 1e-9) || !in(p.own_damping, 0) || !in(p.hand_damping, 0) || !in(p.hand_stiffness, 0))
    return make_issue(IssueCode::world_parameter_invalid,
                      "mass " + std::to_string(p.mass) + ", damping " + std::to_string(p.own_damping) +
                          " and " + std::to_string(p.hand_damping) + ", stiffness " +
                          std::to_string(p.hand_stiffness) + ": not within [0, 1e9], mass from 1e-9");
  if (!(tick_s >= 1e-6 && tick_s <= 1))
    return make_issue(IssueCode::world_parameter_invalid, "a tick of a hand is not within [1e-6, 1] s");
  const double damping = p.own_damping + p.hand_damping;
  const double fastest = tick_s * std::max(damping / p.mass, std::sqrt(p.hand_stiffness / p.mass));
  if (!(fastest <= 1e6))
    return make_issue(IssueCode::world_parameter_invalid,
                      "the mass of a hand is too small for its stiffness or damping");
  // In units in which the tick is 1, so that rates and places are of one size.
  Mat3 system = Mat3::Zero();
  system(0, 1) = 1;
  system(1, 0) = -p.hand_stiffness * tick_s * tick_s / p.mass;
  system(1, 1) = -damping * tick_s / p.mass;
  system(1, 2) = tick_s * tick_s / p.mass;
  const Mat3 e = exponential(system);
  HeldMassStep step;
  step.own_damping_ = p.own_damping;
  step.step_ << e(0, 0), e(0, 1) * tick_s, e(0, 2), e(1, 0) / tick_s, e(1, 1), e(1, 2) / tick_s;
  if (!step.step_.allFinite())
    return make_issue(IssueCode::world_parameter_invalid, "a tick of the hand cannot be computed");
  return step;
}

void HeldMassStep::advance(Vec3& offset, Vec3& rate, const Vec3& place_rate, const Vec3& force) const {
  const Vec3 load = force - own_damping_ * place_rate;
  const Vec3 before = offset;
  offset = step_(0, 0) * before + step_(0, 1) * rate + step_(0, 2) * load;
  rate = step_(1, 0) * before + step_(1, 1) * rate + step_(1, 2) * load;
}

}  // namespace souple
