// SPDX-License-Identifier: MIT
// Gauss-Seidel for tight tolerances on ill-conditioned problems: rounds of sweeps are a fixed-point
// map, and Anderson's acceleration mixes their results.
#pragma once
#include <limits>

#include "runtime/contact/anderson_mixer.hpp"
#include "runtime/contact/contact_gauss_seidel.hpp"

namespace souple {

/// Memory of the solver; nothing is allocated once it has grown.
struct AcceleratedWork {
  GaussSeidelWork sweeps;
  AndersonMixer mixer;
  std::vector<double> before, best;
};

namespace gauss_seidel {

/// A full sweep, then of active constraints only; fills the round up to `count`.
template <ContactOperator Operator>
void sweep_round(Operator& op, GaussSeidelWork& work, std::span<double> force, int count) {
  sweep_all(op, work, force);
  for (int k = 1; k < count; ++k) sweep_active(op, work, force);
}

enum class Mixing : std::uint8_t { none, anderson };

/// When rounds are mixed. Mixing can go round in circles where forces have to drift far along a null
/// direction of W until a contact changes its state; then plain rounds do that, longer each time.
class MixingPolicy {
 public:
  enum class Step : std::uint8_t { mix, forget, plain };

  explicit MixingPolicy(Mixing mixing) : mixing_(mixing) {}

  Step after_round(double residual) {
    if (mixing_ == Mixing::none) return Step::plain;
    constexpr double too_much = 2;    // growth of the residual after which the history misleads
    constexpr double progress = 0.9;  // of the best residual
    if (residual < progress * best_) {
      best_ = residual;
      idle_ = 0;
    } else if (++idle_ > patience_) {
      idle_ = 0;
      patience_ *= 2;
      plain_ = patience_;
    }
    if (plain_ > 0 && --plain_ > 0) return Step::plain;
    const bool forget = plain_ == 0 && residual > too_much * reference_;
    reference_ = forget ? residual : std::min(reference_, residual);
    return forget ? Step::forget : Step::mix;
  }

 private:
  Mixing mixing_;
  double best_ = std::numeric_limits<double>::infinity(), reference_ = best_;
  int idle_ = 0, patience_ = 64, plain_ = 0;
};

inline void project(std::span<const ConstraintLaw> laws, std::span<double> force) {
  for (std::size_t i = 0; i < laws.size(); ++i) {
    if (laws[i].kind == ConstraintLaw::Kind::bilateral) continue;
    Eigen::Map<Vec3> f(&force[3 * i]);
    f = project_onto_cone(f, laws[i].friction);
  }
}

}  // namespace gauss_seidel

/// As solve_by_gauss_seidel, but ends when judge(op, force), a residual of the caller's choice for
/// forces and a current gap, is within settings.tolerance, or stop() says so. `force` and the gap are
/// left with the best that was judged, and report.residual is the judge's.
template <ContactOperator Operator, class Judge, class Stop>
ContactSolveReport solve_by_accelerated_gauss_seidel(
    Operator& op, std::span<const ConstraintLaw> laws, const ContactSolverSettings& settings,
    std::span<double> force, AcceleratedWork& work, const Judge& judge, const Stop& stop,
    gauss_seidel::Mixing mixing = gauss_seidel::Mixing::anderson) {
  constexpr int round = 16;
  ContactSolveReport report;
  gauss_seidel::start(op, laws, force, work.sweeps);
  report.residual = judge(op, force);
  if (!std::isfinite(report.residual)) report.residual = std::numeric_limits<double>::infinity();
  work.best.assign(force.begin(), force.end());
  work.mixer.restart();
  gauss_seidel::MixingPolicy policy(mixing);
  while (!(report.residual <= settings.tolerance) && report.sweeps < settings.max_sweeps && !stop()) {
    const int sweeps = std::min(round, settings.max_sweeps - report.sweeps);
    work.before.assign(force.begin(), force.end());
    gauss_seidel::sweep_round(op, work.sweeps, force, sweeps);
    report.sweeps += sweeps;
    const double residual = judge(op, force);
    if (!std::isfinite(residual)) break;
    if (residual < report.residual) {
      report.residual = residual;
      work.best.assign(force.begin(), force.end());
    }
    const auto step = policy.after_round(residual);
    if (step != gauss_seidel::MixingPolicy::Step::mix) {
      work.mixer.restart();
      continue;
    }
    work.mixer.mix(work.before, force);
    gauss_seidel::project(laws, force);
    op.start(force);
  }
  report.converged = report.residual <= settings.tolerance;
  std::ranges::copy(work.best, force.begin());
  op.start(force);
  return report;
}

}  // namespace souple
