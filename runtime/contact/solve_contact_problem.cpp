// SPDX-License-Identifier: MIT
#include "runtime/contact/solve_contact_problem.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "runtime/contact/accelerated_gauss_seidel.hpp"
#include "runtime/contact/block_sparse_operator.hpp"
#include "runtime/contact/faceted_contact.hpp"

namespace souple {
namespace {

bool all_finite(std::span<const double> values) {
  return std::ranges::all_of(values, [](double value) { return std::isfinite(value); });
}

// The judge of the sweeps, on the gap that they keep; judge_contacts is the independent one.
class PlainResidual {
 public:
  explicit PlainResidual(const ContactProblem& problem) : mu_(problem.mu) {
    const double free2 = std::inner_product(problem.q.begin(), problem.q.end(), problem.q.begin(), 0.0);
    scale_ = free2 > 0 ? 1 / std::sqrt(free2) : 1;
  }

  double operator()(const BlockSparseOperator& op, std::span<const double> force) const {
    double sum = 0;
    for (std::size_t i = 0; i < op.size(); ++i) {
      const Eigen::Map<const Vec3> r(&force[3 * i]);
      Vec3 step = op.gap(i);
      step[0] += mu_[i] * step.tail<2>().norm();
      sum += (r - project_onto_cone(r - step, mu_[i])).squaredNorm();
    }
    return scale_ * std::sqrt(sum);
  }

 private:
  std::span<const double> mu_;
  double scale_ = 1;
};

int capped(std::int64_t sweeps) {
  return static_cast<int>(std::min<std::int64_t>(sweeps, std::numeric_limits<int>::max()));
}

ContactProblemReport solve_exact_cone(const ContactProblem& problem,
                                      const ContactProblemSettings& settings, BlockSparseOperator& op,
                                      std::span<double> force) {
  std::vector<ConstraintLaw> laws;
  for (const double mu : problem.mu) laws.push_back({ConstraintLaw::Kind::frictional, mu});
  AcceleratedWork work;
  const auto report = solve_by_accelerated_gauss_seidel(
      op, laws, {settings.tolerance, capped(settings.max_sweeps)}, force, work, PlainResidual(problem),
      [&] { return settings.stop && settings.stop(); },
      settings.solver == ContactSolverKind::accelerated ? gauss_seidel::Mixing::anderson
                                                        : gauss_seidel::Mixing::none);
  return {report.sweeps, report.converged};
}

ContactProblemReport solve_faceted(const ContactProblem& problem,
                                   const ContactProblemSettings& settings, BlockSparseOperator& op,
                                   std::span<double> force) {
  constexpr std::int64_t between_questions = 64;
  ContactProblemReport report;
  std::vector<double> sound(force.begin(), force.end());
  while (!report.converged && report.sweeps < settings.max_sweeps &&
         !(settings.stop && settings.stop())) {
    const std::int64_t sweeps = std::min(between_questions, settings.max_sweeps - report.sweeps);
    const auto part = solve_faceted_contact(op, problem.mu, settings.facets,
                                            {settings.tolerance, static_cast<int>(sweeps)}, force);
    report.sweeps += part.sweeps;
    report.converged = part.converged;
    if (!std::isfinite(part.residual) || !all_finite(force)) {
      std::ranges::copy(sound, force.begin());
      break;
    }
    sound.assign(force.begin(), force.end());
  }
  return report;
}

}  // namespace

ContactProblemReport solve_contact_problem(const ContactProblem& problem,
                                           const ContactProblemSettings& settings,
                                           std::span<double> force) {
  BlockSparseOperator op(problem.w, problem.q);
  return settings.solver == ContactSolverKind::faceted ? solve_faceted(problem, settings, op, force)
                                                       : solve_exact_cone(problem, settings, op, force);
}

}  // namespace souple
