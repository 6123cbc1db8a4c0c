// SPDX-License-Identifier: MIT
#include "runtime/contact/frictional_contact.hpp"

#include <algorithm>
#include <cmath>

#include "runtime/fem/linear_algebra.hpp"

namespace souple {
namespace {

// The law of one contact against the present gap: Alg. 13 with the tangential gap brought up to date
// before the tangential force is.
Vec3 local_force(const double* delassus_block, std::size_t stride, const Vec3& gap, const Vec3& force,
                 double friction) {
  const double w_nn = delassus_block[0];
  Vec3 next = force;
  next[0] -= gap[0] / w_nn;
  if (!(next[0] > 0)) return Vec3::Zero();
  if (friction == 0) return {next[0], 0, 0};
  const double change = next[0] - force[0];
  const double mean_eigenvalue = 0.5 * (delassus_block[stride + 1] + delassus_block[2 * stride + 2]);
  for (int t = 1; t < 3; ++t)
    next[t] -= (gap[t] + delassus_block[std::size_t(t) * stride] * change) / mean_eigenvalue;
  const double tangential = std::hypot(next[1], next[2]), limit = friction * next[0];
  if (tangential > limit) next.tail<2>() *= limit / tangential;
  return next;
}

// gap += change of contact i's force times its three rows of W (= columns, W being symmetric).
void add_influence(const double* rows, std::size_t size, const Vec3& change, double* gap) {
  const double *w0 = rows, *w1 = rows + size, *w2 = rows + 2 * size;
  for (std::size_t k = 0; k < size; ++k)
    gap[k] += change[0] * w0[k] + change[1] * w1[k] + change[2] * w2[k];
}

void evaluate_gap(const FrictionalContactProblem& problem, std::span<const double> force,
                  std::span<double> gap) {
  const std::size_t size = 3 * problem.contact_count;
  std::ranges::copy(problem.free_gap.first(size), gap.begin());
  for (std::size_t i = 0; i < problem.contact_count; ++i) {
    const Vec3 f(force[3 * i], force[3 * i + 1], force[3 * i + 2]);
    if (f != Vec3::Zero()) add_influence(problem.delassus.data() + 3 * i * size, size, f, gap.data());
  }
}

// Projection onto K = {|r_t| <= mu r_n}; with mu = 0 the half line r_n >= 0.
Vec3 project_onto_cone(const Vec3& r, double friction) {
  const double tangential = r.tail<2>().norm();
  if (tangential <= friction * r[0]) return r;
  if (friction * tangential <= -r[0]) return Vec3::Zero();
  const double normal = (r[0] + friction * tangential) / (1 + friction * friction);
  Vec3 projected(normal, 0, 0);
  if (tangential > 0) projected.tail<2>() = r.tail<2>() * (friction * normal / tangential);
  return projected;
}

}  // namespace

ContactSolveReport solve_frictional_contact(const FrictionalContactProblem& problem,
                                            const ContactSolverSettings& settings,
                                            std::span<double> force, std::span<double> gap) {
  ContactSolveReport report;
  const std::size_t size = 3 * problem.contact_count;
  evaluate_gap(problem, force, gap);
  while (report.sweeps < settings.max_sweeps && !report.converged) {
    double largest_change = 0, largest_force = 0;
    for (std::size_t i = 0; i < problem.contact_count; ++i) {
      const double* rows = problem.delassus.data() + 3 * i * size;
      Eigen::Map<Vec3> f(force.data() + 3 * i);
      const Vec3 next = local_force(rows + 3 * i, size, Eigen::Map<const Vec3>(gap.data() + 3 * i), f,
                                    problem.friction[i]);
      const Vec3 change = next - f;
      const double magnitude = change.norm();
      if (magnitude > 0) add_influence(rows, size, change, gap.data());
      f = next;
      largest_change = std::max(largest_change, magnitude);
      largest_force = std::max(largest_force, next.norm());
    }
    ++report.sweeps;
    report.converged = largest_change <= settings.tolerance * largest_force;
  }
  return report;
}

double natural_map_residual(const FrictionalContactProblem& problem, std::span<const double> force) {
  const std::size_t size = 3 * problem.contact_count;
  double residual2 = 0, force2 = 0;
  for (std::size_t i = 0; i < problem.contact_count; ++i) {
    const double* rows = problem.delassus.data() + 3 * i * size;
    Vec3 u(problem.free_gap[3 * i], problem.free_gap[3 * i + 1], problem.free_gap[3 * i + 2]);
    for (std::size_t k = 0; k < size; ++k)
      for (std::size_t c = 0; c < 3; ++c) u[Eigen::Index(c)] += rows[c * size + k] * force[k];
    const double trace = rows[3 * i] + rows[size + 3 * i + 1] + rows[2 * size + 3 * i + 2];
    const double rho = 3 / trace;
    u[0] += problem.friction[i] * u.tail<2>().norm();
    const Vec3 f(force[3 * i], force[3 * i + 1], force[3 * i + 2]);
    residual2 += (f - project_onto_cone(f - rho * u, problem.friction[i])).squaredNorm();
    force2 += f.squaredNorm();
  }
  return force2 > 0 ? std::sqrt(residual2 / force2) : std::sqrt(residual2);
}

double cone_violation(std::span<const double> friction, std::span<const double> force) {
  double largest = 0, violation = 0;
  for (std::size_t i = 0; i < friction.size(); ++i) {
    const double normal = force[3 * i], tangential = std::hypot(force[3 * i + 1], force[3 * i + 2]);
    largest = std::max(largest, std::hypot(normal, tangential));
    violation = std::max({violation, tangential - friction[i] * normal, -normal});
  }
  return largest > 0 ? violation / largest : 0;
}

}  // namespace souple
