// SPDX-License-Identifier: MIT
#include "runtime/solve/step_solver.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace souple {
namespace {

constexpr int good_iterations = 12;  // fewer are not worth a look at the spare
constexpr int patience = 50;         // systems after which the first choice is tried again

}  // namespace

StepSolver::StepSolver(Iteration iteration, std::unique_ptr<Preconditioner> preconditioner,
                       Index node_count)
    : iteration_(iteration) {
  choices_[0].preconditioner = std::move(preconditioner);
  for (auto* vector : {&residual_, &direction_, &product_, &preconditioned_, &best_})
    vector->setZero(3 * Eigen::Index{node_count});
}

std::size_t StepSolver::bytes() const {
  std::size_t sum = 5 * std::size_t(residual_.size()) * sizeof(double);
  for (const Choice& choice : choices_)
    if (choice.preconditioner) sum += choice.preconditioner->bytes();
  return sum;
}

void StepSolver::set_system(const StepSystem& system) {
  if (choices_[1].preconditioner) choose();
  system_ = system;
  is_current_ = false;
  work_ = 0;
}

const SparseFactor* StepSolver::current_factor() {
  if (factor() && !is_current_) is_current_ = active().preconditioner->update(system_);
  return is_current_ ? factor() : nullptr;
}

void StepSolver::add_spare(std::unique_ptr<Preconditioner> spare) {
  choices_[1] = {std::move(spare), -1};
}

// From one system to the next a body changes little: what a choice took last it will take again.
void StepSolver::choose() {
  if (work_ > 0) choices_[active_].work = work_;
  const Choice &first = choices_[0], &spare = choices_[1];
  if (active_ == 0) {
    const double enough = good_iterations * (first.preconditioner->work_units() + 1);
    if (first.work > enough && (spare.work < 0 || spare.work < first.work)) active_ = 1;
    systems_with_spare_ = 0;
  } else if (spare.work > first.work || ++systems_with_spare_ >= patience) {
    active_ = 0;
  }
}

StepSolver::Memory StepSolver::memory() const {
  return {{choices_[0].work, choices_[1].work}, work_, std::uint32_t(active_), systems_with_spare_};
}

bool StepSolver::may_recall(const Memory& memory) const {
  return memory.active < choices_.size() && choices_[memory.active].preconditioner &&
         std::isfinite(memory.work[0]) && std::isfinite(memory.work[1]) &&
         std::isfinite(memory.present_work);
}

void StepSolver::recall(const Memory& memory) {
  for (std::size_t k = 0; k < choices_.size(); ++k) choices_[k].work = memory.work[k];
  work_ = memory.present_work;
  active_ = memory.active;
  systems_with_spare_ = memory.systems_with_spare;
  is_current_ = false;
}

double StepSolver::measure(const Eigen::VectorXd& b, const Eigen::VectorXd& x) {
  multiply(*system_.tangent, x, product_);
  residual_ = b - product_;
  return residual_.norm();
}

SolveReport StepSolver::solve(const Eigen::VectorXd& b, const SolveLimits& limits, Eigen::VectorXd& x) {
  SolveReport report;
  const double target = limits.tolerance * limits.reference;
  double norm = measure(b, x);
  if (norm > target && !is_current_) is_current_ = active().preconditioner->update(system_);
  // What a recurrence believes is measured; where it was wrong, it begins anew while that still helps.
  double last = std::numeric_limits<double>::infinity();
  while (norm > target && norm < 0.5 * last && is_current_ &&
         report.iterations < limits.max_iterations) {
    last = best_norm_ = norm;
    best_is_kept_ = false;
    descend(target, limits.max_iterations, report.iterations, x);
    work_ = std::max(work_, report.iterations * work_units());
    if (best_is_kept_) x = best_;
    norm = measure(b, x);
  }
  report.relative_residual = limits.reference > 0 ? norm / limits.reference : norm;
  report.converged = norm <= target;
  return report;
}

void StepSolver::note(double norm, double step, const Eigen::VectorXd& direction,
                      const Eigen::VectorXd& x) {
  if (norm <= best_norm_) {
    best_norm_ = norm;
    best_is_kept_ = false;
  } else if (!best_is_kept_) {
    best_ = x - step * direction;
    best_is_kept_ = true;
  }
}

// From the residual that was measured to one that should meet the target. The change of direction takes
// the difference of residuals (Polak and Ribiere), which forgives a preconditioner that is rounded to
// single precision.
void StepSolver::descend(double target, int iteration_limit, int& iterations, Eigen::VectorXd& x) {
  double norm = best_norm_, previous = 0, step = 0;
  for (bool is_first = true; norm > target && iterations < iteration_limit; is_first = false) {
    active().preconditioner->apply(residual_, preconditioned_);
    const double rho = residual_.dot(preconditioned_);
    if (!(rho > 0)) break;  // the preconditioner is not positive definite to working precision
    if (is_first || iteration_ == Iteration::descent)
      direction_ = preconditioned_;
    else
      direction_ = preconditioned_ - (step * preconditioned_.dot(product_) / previous) * direction_;
    previous = rho;
    multiply(*system_.tangent, direction_, product_);
    const double curvature = direction_.dot(product_);
    if (!(curvature > 0)) break;  // round-off has been reached, or A is not positive definite
    step = rho / curvature;
    if (!std::isfinite(step)) break;
    x += step * direction_;
    residual_ -= step * product_;
    norm = residual_.norm();
    note(norm, step, direction_, x);
    ++iterations;
  }
}

}  // namespace souple
