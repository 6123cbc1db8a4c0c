// SPDX-License-Identifier: MIT
#include "tests/support/frictional_contact.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace souple::test {
namespace {

// W as it stands, its columns contiguous.
class DenseOperator {
 public:
  DenseOperator(const FrictionalContactProblem& problem, std::span<double> gap)
      : problem_(problem), height_(3 * problem.contact_count), gap_(gap) {}

  std::size_t size() const { return problem_.contact_count; }
  Mat3 diagonal_block(std::size_t i) const {
    return Eigen::Map<const Mat3, 0, Eigen::OuterStride<>>(columns(i) + 3 * i, {stride()});
  }
  void start(std::span<const double> force) {
    std::ranges::copy(problem_.free_gap.first(height_), gap_.begin());
    for (std::size_t i = 0; i < size(); ++i) {
      const Eigen::Map<const Vec3> f(&force[3 * i]);
      if (f != Vec3::Zero()) add_influence(i, f);
    }
  }
  Vec3 gap(std::size_t i) const { return Eigen::Map<const Vec3>(&gap_[3 * i]); }
  void add_influence(std::size_t i, const Vec3& change) {
    const double *w0 = columns(i), *w1 = w0 + height_, *w2 = w1 + height_;
    for (std::size_t k = 0; k < height_; ++k)
      gap_[k] += change[0] * w0[k] + change[1] * w1[k] + change[2] * w2[k];
  }

 private:
  const double* columns(std::size_t i) const { return problem_.delassus.data() + 3 * i * height_; }
  Eigen::OuterStride<> stride() const { return Eigen::OuterStride<>(Eigen::Index(height_)); }

  const FrictionalContactProblem& problem_;
  std::size_t height_;
  std::span<double> gap_;
};

}  // namespace

ContactSolveReport solve_frictional_contact(const FrictionalContactProblem& problem,
                                            const ContactSolverSettings& settings,
                                            std::span<double> force, std::span<double> gap) {
  std::vector<ConstraintLaw> laws;
  for (const double friction : problem.friction.first(problem.contact_count))
    laws.push_back({ConstraintLaw::Kind::frictional, friction});
  DenseOperator op(problem, gap);
  GaussSeidelWork work;
  return solve_by_gauss_seidel(op, laws, settings, force, work);
}

double natural_map_residual(const FrictionalContactProblem& problem, std::span<const double> force) {
  std::vector<double> gap(3 * problem.contact_count);
  DenseOperator op(problem, gap);
  op.start(force);
  double residual2 = 0, force2 = 0;
  for (std::size_t i = 0; i < problem.contact_count; ++i) {
    Vec3 u = op.gap(i);
    const double friction = problem.friction[i], rho = 3 / op.diagonal_block(i).trace();
    u[0] += friction * u.tail<2>().norm();
    const Eigen::Map<const Vec3> f(&force[3 * i]);
    residual2 += (f - project_onto_cone(f - rho * u, friction)).squaredNorm();
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

}  // namespace souple::test
